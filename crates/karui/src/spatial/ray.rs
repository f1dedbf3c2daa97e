//! Whether anything is in the way.

use super::Bvh;
use super::bvh::{LEAF, NONE, Node};
use glam::{DVec3, Vec3, Vec4};
use smallvec::SmallVec;

/// A half-line, and from where on it counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, model units.
    pub origin: DVec3,
    /// Where it goes; of length 1.
    pub direction: DVec3,
    /// What is crossed before this distance does not count, model units.
    pub least: f64,
}

impl Bvh {
    /// Whether `ray` crosses a triangle that `blocks`, given the triangle's index
    /// in the mesh and whether the ray leaves through its front.
    ///
    /// Boxes are tested in `f32`: a ray may miss a triangle whose edge it only
    /// touches, and then counts as free.
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray, blocks: impl Fn(u32, bool) -> bool) -> bool {
        let origin = ray.origin.as_vec3();
        let inverse = ray.direction.as_vec3().recip();
        let mut stack = SmallVec::<[u32; 128]>::new();
        stack.push(0);
        while let Some(child) = stack.pop() {
            if child & LEAF == 0 {
                push_crossed(&self.nodes[child as usize], origin, inverse, &mut stack);
                continue;
            }
            let slot = child & !LEAF;
            if let Some(front) = crossing(ray, self.corners(slot))
                && blocks(self.triangle(slot), front)
            {
                return true;
            }
        }
        false
    }
}

fn push_crossed(node: &Node, origin: Vec3, inverse: Vec3, stack: &mut SmallVec<[u32; 128]>) {
    let (mut enter, mut leave) = (Vec4::ZERO, Vec4::INFINITY);
    for axis in 0..3 {
        let (o, i) = (Vec4::splat(origin[axis]), Vec4::splat(inverse[axis]));
        let (a, b) = ((node.min[axis] - o) * i, (node.max[axis] - o) * i);
        // A ray within a side of a box gives no number there and misses the box.
        enter = a.min(b).max(enter);
        leave = leave.min(a.max(b) * (1.0 + 4.0 * f32::EPSILON));
    }
    let mut crossed = enter.cmple(leave).bitmask();
    let first = stack.len();
    let mut nearness = [0.0; 4];
    while crossed != 0 {
        let lane = crossed.trailing_zeros() as usize;
        crossed &= crossed - 1;
        if node.child[lane] != NONE {
            nearness[stack.len() - first] = enter[lane];
            stack.push(node.child[lane]);
        }
    }
    // What is near is more often in the way: it is looked into first.
    let pushed = &mut stack[first..];
    for end in 1..pushed.len() {
        let mut at = end;
        while at > 0 && nearness[at - 1] < nearness[at] {
            nearness.swap(at - 1, at);
            pushed.swap(at - 1, at);
            at -= 1;
        }
    }
}

/// Whether the triangle is left through its front, if it is crossed at all (Möller
/// and Trumbore, "Fast, minimum storage ray-triangle intersection", 1997). Edges
/// belong to both sides.
fn crossing(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<bool> {
    /// A share of a side that closes the seam between two triangles.
    const SEAM: f64 = 1e-9;
    let (ab, ac) = (b - a, c - a);
    let across = ray.direction.cross(ac);
    let determinant = ab.dot(across);
    let by = 1.0 / determinant;
    let from = ray.origin - a;
    let u = from.dot(across) * by;
    let around = from.cross(ab);
    let v = ray.direction.dot(around) * by;
    let distance = ac.dot(around) * by;
    let inside = u >= -SEAM && v >= -SEAM && u + v <= 1.0 + SEAM && distance > ray.least;
    // A positive determinant is a ray against the normal, one that enters.
    inside.then_some(determinant < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::fibonacci_directions;
    use crate::mesh::{TriMesh, shapes};

    fn plain(mesh: &TriMesh, ray: &Ray) -> bool {
        (0..mesh.triangles.len()).any(|t| crossing(ray, mesh.corners(t)).is_some())
    }

    #[test]
    fn as_if_every_triangle_were_tried() {
        let mesh = shapes::torus(1.0, 0.3, 24, 12);
        let bvh = Bvh::build(&mesh).unwrap();
        let (mut hits, mut all) = (0, 0);
        for (i, direction) in fibonacci_directions(500).into_iter().enumerate() {
            let origin = DVec3::new(0.37, -0.21, 0.13) * (i % 7) as f64;
            let ray = Ray {
                origin,
                direction: direction.as_dvec3().normalize(),
                least: 0.0,
            };
            let found = bvh.is_blocked(&ray, |_, _| true);
            assert_eq!(found, plain(&mesh, &ray), "{ray:?}");
            (hits, all) = (hits + u32::from(found), all + 1);
        }
        assert!(hits > all / 10 && hits < all, "{hits} of {all}");
    }

    #[test]
    fn from_inside_fronts_are_left_and_from_outside_entered() {
        let bvh = Bvh::build(&shapes::cube(1)).unwrap();
        let ray = |x| Ray {
            origin: DVec3::new(x, 0.1, 0.2),
            direction: DVec3::X,
            least: 0.0,
        };
        assert!(bvh.is_blocked(&ray(0.0), |_, front| front));
        assert!(!bvh.is_blocked(&ray(0.0), |_, front| !front));
        assert!(bvh.is_blocked(&ray(-9.0), |_, front| !front));
        assert!(!bvh.is_blocked(&ray(9.0), |_, _| true));
        let later = Ray {
            least: 5.0,
            ..ray(0.0)
        };
        assert!(!bvh.is_blocked(&later, |_, _| true));
    }
}
