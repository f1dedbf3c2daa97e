//! Points on a surface: all its vertices, evenly along its edges, evenly over
//! its area.
//!
//! Edge and face samples are stratified: the total length or area is cut into
//! as many equal pieces as there are samples and every piece gets one, at a
//! place hashed from its number. That says how many samples an edge or a face
//! gets; on an edge they are spaced evenly, the ends left to the vertex samples
//! (as MeshLab does it), within a face they follow the R2 sequence (Roberts
//! 2018). A sample is a function of the surface, the count, the seed
//! and its number alone, so any thread may compute any part.

use super::surface::Surface;
use crate::geom::interpolate;
use glam::DVec3;
use std::ops::Range;

/// Where samples lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Vertices,
    Edges,
    Faces,
}

/// A point of the surface as a mixture of three of its positions.
pub(super) struct Sample {
    pub point: DVec3,
    pub positions: [u32; 3],
    pub barycentric: [f64; 3],
}

/// The samples of one kind.
#[derive(Clone, Copy)]
pub(super) struct Sampler<'a> {
    surface: &'a Surface,
    kind: Kind,
    count: u64,
    seed: u64,
}

impl<'a> Sampler<'a> {
    /// `wanted` samples; for vertices there are always as many as positions,
    /// and none on edges without length or faces without area.
    pub(super) fn new(surface: &'a Surface, kind: Kind, wanted: u64, seed: u64) -> Self {
        let count = match kind {
            Kind::Vertices => surface.positions.len() as u64,
            Kind::Edges if surface.edge_length() > 0.0 => wanted,
            Kind::Faces if surface.area() > 0.0 => wanted,
            Kind::Edges | Kind::Faces => 0,
        };
        Self {
            surface,
            kind,
            count,
            seed,
        }
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Calls `visit` for the samples of the given numbers, in order.
    pub(super) fn visit(&self, numbers: Range<u64>, mut visit: impl FnMut(Sample)) {
        let surface = self.surface;
        match self.kind {
            Kind::Vertices => numbers.for_each(|k| visit(self.vertex(k as u32))),
            Kind::Edges => self.strata(&surface.lengths, numbers, |k, edge| {
                let [p, q] = surface.edges[edge];
                let along = self.spaced(&surface.lengths, k, edge);
                visit(self.mixture([p, q, q], [1.0 - along, along, 0.0]));
            }),
            Kind::Faces => self.strata(&surface.areas, numbers, |k, face| {
                visit(self.mixture(surface.triangles[face], barycentric(k, self.seed)));
            }),
        }
    }

    fn vertex(&self, p: u32) -> Sample {
        Sample {
            point: self.surface.position(p),
            positions: [p; 3],
            barycentric: [1.0, 0.0, 0.0],
        }
    }

    fn mixture(&self, positions: [u32; 3], barycentric: [f64; 3]) -> Sample {
        let corners = positions.map(|p| self.surface.position(p));
        Sample {
            point: interpolate(corners, barycentric),
            positions,
            barycentric,
        }
    }

    /// Calls `visit` with the number of every sample and the element it falls
    /// in. `sums` are the measures of all elements before each, and of all; the
    /// last is positive.
    fn strata(&self, sums: &[f64], numbers: Range<u64>, mut visit: impl FnMut(u64, usize)) {
        let Some((&total, starts)) = sums.split_last() else {
            return;
        };
        let first = self.place(numbers.start, total);
        let mut element = starts.partition_point(|&s| s <= first).saturating_sub(1);
        for k in numbers {
            let place = self.place(k, total);
            while element + 1 < starts.len() && sums[element + 1] <= place {
                element += 1;
            }
            visit(k, element);
        }
    }

    /// Where sample `k` falls in `0..total`; grows with `k`.
    fn place(&self, k: u64, total: f64) -> f64 {
        (k as f64 + unit(hash(k, self.seed))) / self.count as f64 * total
    }

    /// How far along its element (0 to 1) sample `k` lies if those of an
    /// element are spaced evenly between its ends.
    fn spaced(&self, sums: &[f64], k: u64, element: usize) -> f64 {
        let total = sums.last().copied().unwrap_or(0.0);
        let first = self.first_from(sums[element], total).min(k);
        let end = self.first_from(sums[element + 1], total).max(k + 1);
        (k - first + 1) as f64 / (end - first + 1) as f64
    }

    /// The first sample not before `place`.
    fn first_from(&self, place: f64, total: f64) -> u64 {
        let mut k = ((place / total * self.count as f64) as u64).min(self.count);
        while k > 0 && self.place(k - 1, total) >= place {
            k -= 1;
        }
        while k < self.count && self.place(k, total) < place {
            k += 1;
        }
        k
    }
}

/// Point number `k` of the R2 sequence, shifted by the seed, on the triangle.
fn barycentric(k: u64, seed: u64) -> [f64; 3] {
    // 2^64 over the plastic number and its square.
    const STEP: [u64; 2] = [0xC13F_A9A9_02A6_328F, 0x91E1_0DA5_C79E_7B1C];
    let shift = |axis: u64| hash(axis, !seed);
    let x = unit(k.wrapping_mul(STEP[0]).wrapping_add(shift(0))).sqrt();
    let y = unit(k.wrapping_mul(STEP[1]).wrapping_add(shift(1)));
    [1.0 - x, x * (1.0 - y), x * y]
}

/// The upper bits as a number in `0..1`.
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Number `k` of the SplitMix64 sequence of `seed` (Steele 2014).
fn hash(k: u64, seed: u64) -> u64 {
    let mut x = seed.wrapping_add(k.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    x = (x ^ x >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ x >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriMesh;
    use glam::Vec3;

    /// Triangles of areas 1/2, 0 and 9/2.
    fn uneven() -> Surface {
        let p = |x, y| Vec3::new(x, y, 0.0);
        let mesh = TriMesh::new(
            vec![
                p(0., 0.),
                p(1., 0.),
                p(0., 1.),
                p(9., 0.),
                p(9., 3.),
                p(6., 0.),
            ],
            vec![[0, 1, 2], [0, 1, 1], [3, 4, 5]],
        );
        Surface::new(&mesh).unwrap()
    }

    fn points(surface: &Surface, kind: Kind, count: u64) -> Vec<DVec3> {
        let sampler = Sampler::new(surface, kind, count, 7);
        let mut points = Vec::new();
        for start in (0..count).step_by(37) {
            let end = count.min(start + 37);
            sampler.visit(start..end, |s| points.push(s.point));
        }
        points
    }

    #[test]
    fn faces_get_samples_by_area() {
        let surface = uneven();
        let points = points(&surface, Kind::Faces, 1000);
        let small: Vec<_> = points.iter().filter(|p| p.x + p.y <= 1.0).collect();
        assert_eq!((points.len(), small.len()), (1000, 100));
        let large: Vec<_> = points.iter().filter(|p| p.x >= 6.0).collect();
        assert_eq!(large.len(), 900);
        // The mean of a triangle is its centroid, here (8, 1).
        let mean = large.iter().copied().sum::<DVec3>() / 900.0;
        assert!((mean - DVec3::new(8.0, 1.0, 0.0)).length() < 0.01, "{mean}");
    }

    #[test]
    fn edges_get_samples_by_length() {
        let surface = uneven();
        let points = points(&surface, Kind::Edges, 10_000);
        let total = surface.edge_length();
        let on_axis = points.iter().filter(|p| p.y == 0.0 && p.x <= 1.0).count();
        let wanted = 10_000.0 / total;
        assert!((on_axis as f64 - wanted).abs() <= 2.0, "{on_axis} {wanted}");
    }

    #[test]
    fn samples_of_an_edge_are_evenly_inside() {
        let mesh = TriMesh::new(vec![Vec3::ZERO, Vec3::X], vec![[0, 1, 1]]);
        let points = points(&Surface::new(&mesh).unwrap(), Kind::Edges, 99);
        let expected = (1..100).map(|i| f64::from(i) / 100.0);
        for (p, x) in points.iter().zip(expected) {
            assert!((p.x - x).abs() < 1e-15, "{p} is not {x}");
        }
    }

    #[test]
    fn nothing_to_sample_is_no_sample() {
        let point = Surface::new(&TriMesh::new(vec![Vec3::ONE], vec![[0; 3]])).unwrap();
        let count = |kind| Sampler::new(&point, kind, 10, 0).count();
        let counts = [Kind::Vertices, Kind::Edges, Kind::Faces].map(count);
        assert_eq!(counts, [1, 0, 0]);
    }
}
