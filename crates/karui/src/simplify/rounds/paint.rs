//! Attributes of a block: what every corner shows, and how much of it a
//! collapse would lose.
//!
//! H. Hoppe: New Quadric Metric for Simplifying Meshes with Appearance
//! Attributes, IEEE Visualization 1999, made memoryless. Over every triangle
//! the attributes are linear functions of space. Around a point, the new
//! vertex loses what these functions differ by at its place: the area-weighted
//! variance of their gradients, a matrix that adds to the planes'.

use super::sym3::Sym3;
use crate::simplify::blend::Mix;
use glam::{Vec2, Vec3};
use smallvec::SmallVec;

/// Attributes of the wedges of a whole surface, scaled to model lengths.
#[derive(Debug, Clone, Default)]
pub(crate) struct Values {
    /// Numbers a wedge.
    pub width: usize,
    /// `width` numbers a wedge.
    pub value: Vec<f32>,
    /// Where in them the UV sets are that must not turn over.
    pub uvs: Vec<usize>,
}

/// A wedge that became a mixture of wedges.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blend {
    /// The wedge.
    pub wedge: u32,
    /// What it became.
    pub mix: Mix,
}

/// Wedges that become one: at the point that stays and at the one that goes.
pub(super) type Pair = (u32, u32);
/// The pairs of one edge.
pub(super) type Pairs = SmallVec<[Pair; 2]>;

/// The wedges of a block, numbered from 0 within it.
#[derive(Debug, Default)]
pub(super) struct Paint {
    pub width: usize,
    pub uvs: Vec<usize>,
    /// Wedges of every triangle.
    pub wedge: Vec<[u32; 3]>,
    /// Material range of every triangle.
    pub range: Vec<u32>,
    /// Ids of the wedges in the level.
    pub global: Vec<u32>,
    pub value: Vec<f32>,
    /// Of every wedge: area, sum of area times `gT g`, sum of area times `g`,
    /// over its triangles and with `g` the gradients, a row for every number.
    sums: Vec<f32>,
    /// What of a point's star comes from here.
    pub varies: Vec<Sym3>,
    pub log: Vec<Blend>,
}

impl Paint {
    /// Wedges `wedge` (by triangle) of these values, for `points` points.
    pub fn new(values: &Values, wedge: Vec<[u32; 3]>, range: Vec<u32>, points: usize) -> Self {
        let mut global: Vec<u32> = wedge.iter().flatten().copied().collect();
        global.sort_unstable();
        global.dedup();
        let local = |w: u32| global.partition_point(|&known| known < w) as u32;
        let wedge = wedge.iter().map(|t| t.map(local)).collect();
        let width = values.width;
        let value = global
            .iter()
            .flat_map(|&w| &values.value[w as usize * width..][..width])
            .copied()
            .collect();
        Self {
            width,
            uvs: values.uvs.clone(),
            wedge,
            range,
            value,
            sums: vec![0.0; global.len() * (7 + 3 * width)],
            varies: vec![Sym3::default(); points],
            log: Vec::new(),
            global,
        }
    }

    /// Values of a wedge.
    pub fn of(&self, wedge: u32) -> &[f32] {
        &self.value[wedge as usize * self.width..][..self.width]
    }

    /// Adds a triangle with these wedges, at these places, to the sums of
    /// those of its corners that `which` names, or takes it out.
    pub fn add(&mut self, wedges: [u32; 3], places: [Vec3; 3], which: [bool; 3], sign: f32) {
        let width = self.width;
        let Some((area, across)) = dual(places) else {
            return;
        };
        let area = sign * area;
        let mut squares = Sym3::default();
        let mut gradients = SmallVec::<[Vec3; 12]>::new();
        for i in 0..width {
            let [a, b, c] = wedges.map(|w| self.value[w as usize * width + i]);
            let gradient = across[0] * (b - a) + across[1] * (c - a);
            squares += Sym3::outer(gradient);
            gradients.push(gradient * area);
        }
        for (wedge, _) in wedges.iter().zip(which).filter(|w| w.1) {
            let sums = &mut self.sums[*wedge as usize * (7 + 3 * width)..][..7 + 3 * width];
            sums[0] += area;
            for (sum, square) in sums[1..7].iter_mut().zip(squares.0) {
                *sum += area * square;
            }
            for (sum, gradient) in sums[7..].chunks_exact_mut(3).zip(&gradients) {
                sum[0] += gradient.x;
                sum[1] += gradient.y;
                sum[2] += gradient.z;
            }
        }
    }

    /// Forgets the triangles of a wedge.
    pub fn clear(&mut self, wedge: u32) {
        let stride = 7 + 3 * self.width;
        self.sums[wedge as usize * stride..][..stride].fill(0.0);
    }

    /// Variance of the gradients around a wedge, times its area.
    pub fn variance(&self, wedge: u32) -> Sym3 {
        let stride = 7 + 3 * self.width;
        let sums = &self.sums[wedge as usize * stride..][..stride];
        let mut left = Sym3([sums[1], sums[2], sums[3], sums[4], sums[5], sums[6]]);
        if sums[0] <= 0.0 {
            return Sym3::default();
        }
        let share = 1.0 / sums[0];
        for g in sums[7..].chunks_exact(3) {
            let outer = Sym3::outer(Vec3::new(g[0], g[1], g[2]));
            left -= Sym3(outer.0.map(|v| v * share));
        }
        left
    }

    /// Sets a wedge to a mixture of wedges.
    pub fn blend(&mut self, wedge: u32, mix: &Mix) {
        for i in 0..self.width {
            let part = |k: usize| {
                self.value[mix.sources[k] as usize * self.width + i] * mix.shares[k] as f32
            };
            let mixed = part(0) + part(1) + part(2);
            self.value[wedge as usize * self.width + i] = mixed;
        }
        self.log.push(Blend {
            wedge: self.global[wedge as usize],
            mix: Mix {
                sources: mix.sources.map(|w| self.global[w as usize]),
                ..*mix
            },
        });
    }

    /// A UV of a mixture.
    pub fn mixed_uv(&self, set: usize, mix: &Mix) -> Vec2 {
        let part = |k: usize| self.uv(set, mix.sources[k]) * mix.shares[k] as f32;
        part(0) + part(1) + part(2)
    }

    /// Twice the signed area of a triangle with these wedges in texture space.
    pub fn uv_area(&self, set: usize, wedges: [u32; 3]) -> f32 {
        let [a, b, c] = wedges.map(|w| self.uv(set, w));
        (b - a).perp_dot(c - a)
    }

    /// A UV of a wedge.
    pub fn uv(&self, set: usize, wedge: u32) -> Vec2 {
        let at = wedge as usize * self.width + set;
        Vec2::new(self.value[at], self.value[at + 1])
    }
}

/// Area of a triangle and the gradients of its second and third barycentric
/// coordinate; none for one without area. Those of slivers are held back.
fn dual([a, b, c]: [Vec3; 3]) -> Option<(f32, [Vec3; 2])> {
    let (e, f) = (b - a, c - a);
    let (ee, ef, ff) = (e.length_squared(), e.dot(f), f.length_squared());
    let det = (ee * ff - ef * ef).max(0.0);
    let area = 0.5 * det.sqrt();
    let det = det + 1e-4 * ee.max(ff) * ee.max(ff);
    if !(area > 0.0 && det > 0.0 && det.is_finite()) {
        return None;
    }
    Some((area, [(e * ff - f * ef) / det, (f * ee - e * ef) / det]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paint(values: &[f32]) -> Paint {
        let values = Values {
            width: 1,
            value: values.to_vec(),
            uvs: Vec::new(),
        };
        Paint::new(&values, vec![[0, 1, 2], [0, 2, 3]], vec![0; 2], 4)
    }

    const SQUARE: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];

    fn filled(values: &[f32]) -> Paint {
        let mut paint = paint(values);
        for t in [[0, 1, 2], [0, 2, 3]] {
            let places = t.map(|p: u32| SQUARE[p as usize]);
            paint.add(t, places, [true; 3], 1.0);
        }
        paint
    }

    #[test]
    fn linear_attributes_do_not_vary() {
        let paint = filled(&[1.0, 3.0, 8.0, 6.0]);
        for w in 0..4 {
            assert!(paint.variance(w).trace().abs() < 0.02, "{w}");
        }
    }

    #[test]
    fn a_kink_is_what_the_gradients_differ_by() {
        // Gradients (0, 2) and (2, 0): each is off the mean by (1, 1).
        let paint = filled(&[0.0, 0.0, 2.0, 0.0]);
        let kink = paint.variance(0).square(Vec3::new(1.0, -1.0, 0.0));
        assert!((kink - 4.0).abs() < 0.02, "{kink}");
        assert!(paint.variance(0).square(Vec3::new(1.0, 1.0, 0.0)).abs() < 0.02);
        assert!(paint.variance(1).trace().abs() < 0.02);
    }

    #[test]
    fn what_was_added_can_be_taken_out() {
        let mut paint = filled(&[0.0, 0.0, 2.0, 0.0]);
        let places = [0, 2, 3].map(|p: usize| SQUARE[p]);
        paint.add([0, 2, 3], places, [true, false, true], -1.0);
        assert!(paint.variance(0).trace().abs() < 0.02);
    }
}
