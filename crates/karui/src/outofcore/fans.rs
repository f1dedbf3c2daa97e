//! Which places have all their triangles at hand, told without a list of edges.

use super::checksum::mixed;
use crate::mesh::PositionIds;

/// For every place a sum that is 0 where the triangles counted close around it.
///
/// Around a vertex every edge ends one triangle and begins another. Adding a hash of the far
/// end for each beginning and taking it away for each end leaves 0 just where they pair up,
/// but for one case in 2^64. Sums wrap, so that their order does not matter.
pub(super) struct Fans {
    sum: Vec<u64>,
}

impl Fans {
    /// Counts the corners of `triangles` for which `counts` says so.
    pub fn of(places: &PositionIds, triangles: &[[u32; 3]], counts: impl Fn(u32) -> bool) -> Self {
        let mut sum = vec![0u64; places.count];
        let hash = |p: u32| mixed(mixed(0x6b61_7275_6921, p.into()), 1);
        for triangle in triangles {
            let at = triangle.map(|v| places.of_vertex[v as usize]);
            let hashes = at.map(hash);
            for i in 0..3 {
                if counts(triangle[i]) {
                    let [next, last] = [hashes[(i + 1) % 3], hashes[(i + 2) % 3]];
                    let sum = &mut sum[at[i] as usize];
                    *sum = sum.wrapping_add(next).wrapping_sub(last);
                }
            }
        }
        Self { sum }
    }

    /// Whether the triangles counted do not close around a place.
    pub fn is_open(&self, place: u32) -> bool {
        self.sum[place as usize] != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{TriMesh, shapes};

    fn open(mesh: &TriMesh) -> usize {
        let places = PositionIds::of_mesh(mesh);
        let fans = Fans::of(&places, &mesh.triangles, |_| true);
        (0..places.count as u32)
            .filter(|&p| fans.is_open(p))
            .count()
    }

    #[test]
    fn spheres_have_no_rim_and_what_is_cut_off_has() {
        let mut sphere = shapes::icosphere(3);
        assert_eq!(open(&sphere), 0);
        sphere.triangles.pop();
        assert_eq!(open(&sphere), 3);
        sphere.triangles.clear();
        assert_eq!(open(&sphere), 0);
    }
}
