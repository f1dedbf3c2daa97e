//! Where a vertex ends up after infinitely many steps, and how the surface lies there.
//!
//! Masks: Halstead, Kass and DeRose, "Efficient, fair interpolation using Catmull-Clark
//! surfaces", 1993; tangents beside creases: Biermann, Levin and Zorin, "Piecewise smooth
//! subdivision surfaces with normal control", 2000.

use crate::geom::sin_cos;
use glam::DVec3;
use smallvec::SmallVec;
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// Steps after which a fan is a point for all that `f32` can tell; it halves in each.
const DART_STEPS: usize = 40;

/// Most vertices have no more quads around them than this.
const FEW: usize = 16;

static TURNS: LazyLock<Vec<Turns>> = LazyLock::new(|| (0..FEW).map(Turns::of).collect());

/// Sines and cosines of the shares of a turn.
#[derive(Debug)]
struct Turns {
    /// Of `i` of `n` parts, and the whole turn.
    around: Vec<(f64, f64)>,
    /// Cosine of half a part.
    half: f64,
}

impl Turns {
    fn of(n: usize) -> Self {
        let part = |i: usize| sin_cos(TAU * i as f64 / n as f64);
        Self {
            around: (0..=n).map(part).collect(),
            half: sin_cos(PI / n as f64).1,
        }
    }
}

/// Quads around a vertex, or a part of them: `spokes[i]` and `spokes[i + 1]` are the
/// vertices beside it of the `i`-th quad, `diagonals[i]` is the one across.
#[derive(Debug, Clone, Default)]
pub(super) struct Fan {
    pub center: DVec3,
    pub spokes: SmallVec<[DVec3; 9]>,
    pub diagonals: SmallVec<[DVec3; 8]>,
}

impl Fan {
    /// The limit of the centre where nothing is sharp.
    pub fn smooth_limit(&self) -> DVec3 {
        let n = self.diagonals.len() as f64;
        let spokes: DVec3 = self.spokes[..self.diagonals.len()].iter().sum();
        let diagonals: DVec3 = self.diagonals.iter().sum();
        (self.center * (n * n) + spokes * 4.0 + diagonals) / (n * (n + 5.0))
    }

    /// The limit of the centre on a curve that goes on to `a` and `b`.
    pub fn crease_limit(&self, a: DVec3, b: DVec3) -> DVec3 {
        (self.center * 4.0 + a + b) / 6.0
    }

    /// Normal where nothing is sharp, of length 1; of any where there is none.
    pub fn smooth_normal(&self) -> DVec3 {
        let n = self.diagonals.len();
        let mut others = None;
        let turns = match TURNS.get(n) {
            Some(turns) => turns,
            None => others.insert(Turns::of(n)),
        };
        let (_, c) = turns.around[1];
        let spoke = 1.0 + c + turns.half * (2.0 * (9.0 + c)).sqrt();
        let (mut u, mut v) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..n {
            let [(s0, c0), (s1, c1)] = [i, i + 1].map(|i| turns.around[i]);
            u += self.spokes[i] * (spoke * c0) + self.diagonals[i] * (c0 + c1);
            v += self.spokes[i] * (spoke * s0) + self.diagonals[i] * (s0 + s1);
        }
        self.oriented(u.cross(v))
    }

    /// Normal on the side that this fan is of the curve from its first to its last spoke.
    pub fn crease_normal(&self) -> DVec3 {
        let k = self.diagonals.len();
        let (first, last) = (self.spokes[0], self.spokes[k]);
        if k == 1 {
            return self.oriented(DVec3::ZERO);
        }
        let angle = PI / k as f64;
        let (s, c) = sin_cos(angle);
        let r = (c + 1.0) / s;
        let mut across = self.center * (4.0 * r * (c - 1.0));
        across -= (first + last) * (r * (1.0 + 2.0 * c));
        let sine = |i: usize| sin_cos(angle * i as f64).0;
        for i in 0..k {
            across += self.diagonals[i] * (sine(i) + sine(i + 1));
            across += if i > 0 {
                self.spokes[i] * (4.0 * sine(i))
            } else {
                DVec3::ZERO
            };
        }
        self.oriented((first - last).cross(across))
    }

    /// Limit of the centre and normal where spoke `sharp` alone stays sharp: no mask is known
    /// in closed form, but the fan of one step is made of that before it alone.
    pub fn dart(&self, sharp: usize) -> (DVec3, DVec3) {
        let steps = |count| (0..count).fold(self.clone(), |fan, _| fan.refined(sharp));
        (
            steps(DART_STEPS).center,
            steps(DART_STEPS / 2).smooth_normal(),
        )
    }

    /// The fan one step later, all around, with one sharp spoke.
    fn refined(&self, sharp: usize) -> Self {
        let n = self.diagonals.len();
        let face = |i: usize| {
            let i = i % n;
            (self.center + self.spokes[i] + self.spokes[i + 1] + self.diagonals[i]) / 4.0
        };
        let spoke = |i: usize| {
            let ends = self.center + self.spokes[i];
            if i == sharp {
                ends / 2.0
            } else {
                (ends + face(i + n - 1) + face(i)) / 4.0
            }
        };
        let sum: DVec3 = (0..n).map(|i| face(i) + self.spokes[i]).sum();
        let count = n as f64;
        Self {
            center: sum / (count * count) + self.center * ((count - 2.0) / count),
            spokes: (0..=n).map(|i| spoke(i % n)).collect(),
            diagonals: (0..n).map(face).collect(),
        }
    }

    /// Normal at a tip that lies fast, between the first and the last spoke.
    pub fn corner_normal(&self) -> DVec3 {
        let ends = [self.spokes[0], self.spokes[self.diagonals.len()]];
        let [a, b] = ends.map(|p| p - self.center);
        self.oriented(a.cross(b))
    }

    /// The direction of the areas between neighbouring spokes.
    pub fn mean_normal(&self) -> DVec3 {
        let edges = self.spokes.windows(2);
        let area = |w: &[DVec3]| (w[0] - self.center).cross(w[1] - self.center);
        edges.map(area).sum::<DVec3>().normalize_or_zero()
    }

    /// `normal` turned to the side of the mean one, which is what is left where there is
    /// none.
    fn oriented(&self, normal: DVec3) -> DVec3 {
        let mean = self.mean_normal();
        match normal.try_normalize() {
            Some(normal) if normal.dot(mean) < 0.0 => -normal,
            Some(normal) => normal,
            None => mean,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane: what every mask has to reproduce.
    fn height(x: f64, y: f64) -> DVec3 {
        DVec3::new(x, y, 0.3 * x - 0.2 * y)
    }

    #[test]
    fn planes_stay_planes() {
        let plane = DVec3::new(-0.3, 0.2, 1.0).normalize();
        let mut fan = Fan {
            center: height(0.0, 0.0),
            ..Fan::default()
        };
        for i in 0..6 {
            let (s, c) = sin_cos(TAU * f64::from(i) / 5.0);
            fan.spokes.push(height(c, s));
        }
        for w in 0..5 {
            // As far out as makes its quad a parallelogram.
            fan.diagonals.push(fan.spokes[w] + fan.spokes[w + 1]);
        }
        assert!(fan.smooth_limit().length() < 1e-12);
        assert!(fan.smooth_normal().distance(plane) < 1e-12);
        let (limit, normal) = fan.dart(0);
        // A crease that ends pulls its end along.
        assert!(
            limit.dot(plane).abs() < 1e-9 && limit.length() > 1e-3,
            "{limit}"
        );
        assert!(normal.distance(plane) < 1e-6, "{normal}");
        let half = Fan {
            spokes: fan.spokes[..4].into(),
            diagonals: fan.diagonals[..3].into(),
            ..fan
        };
        assert!(half.crease_normal().distance(plane) < 1e-12);
        assert!(half.corner_normal().distance(plane) < 1e-12);
    }
}
