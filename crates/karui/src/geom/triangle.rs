//! Single triangles in double precision.

use glam::DVec3;

/// Normal of the triangle, as long as twice its area.
#[must_use]
pub fn normal_times_two_areas([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Area of the triangle.
#[must_use]
pub fn area(corners: [DVec3; 3]) -> f64 {
    0.5 * normal_times_two_areas(corners).length()
}

/// Point of the triangle nearest to `p`, degenerate triangles included.
#[must_use]
pub fn closest_point(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    interpolate(corners, closest_barycentric(p, corners))
}

/// Point of the triangle with the given barycentric coordinates, written so
/// that a corner is met exactly.
#[must_use]
pub fn interpolate([a, b, c]: [DVec3; 3], [_, v, w]: [f64; 3]) -> DVec3 {
    a + (b - a) * v + (c - a) * w
}

/// Barycentric coordinates (none negative, sum 1) of the point of the triangle
/// nearest to `p`, degenerate triangles included (Ericson, Real-Time Collision
/// Detection, 5.1.5).
#[must_use]
pub fn closest_barycentric(p: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = ratio(d1, d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = ratio(d2, d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let sum = va + vb + vc;
    let inside = [ratio(va, sum), ratio(vb, sum), ratio(vc, sum)];
    // The sum is the squared sine at `a` times both squared lengths; where it
    // is small the three areas are mostly rounding.
    if sum < NEEDLE * ab.length_squared() * ac.length_squared() {
        return nearest_candidate(p, [a, b, c], inside);
    }
    inside
}

/// Squared sine of an angle below which the interior solution is checked
/// against the edges.
const NEEDLE: f64 = 1e-6;

/// Best of the interior solution and the nearest points of the three edges.
fn nearest_candidate(p: DVec3, corners: [DVec3; 3], inside: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = corners;
    let along = |from: DVec3, to: DVec3| {
        let edge = to - from;
        ratio(edge.dot(p - from), edge.length_squared()).clamp(0.0, 1.0)
    };
    let (ab, bc, ca) = (along(a, b), along(b, c), along(c, a));
    let edges = [
        [1.0 - ab, ab, 0.0],
        [0.0, 1.0 - bc, bc],
        [ca, 0.0, 1.0 - ca],
    ];
    let distance = |candidate| p.distance_squared(interpolate(corners, candidate));
    edges.into_iter().fold(inside, |best, edge| {
        if distance(edge) < distance(best) {
            edge
        } else {
            best
        }
    })
}

fn ratio(part: f64, whole: f64) -> f64 {
    if whole == 0.0 { 0.0 } else { part / whole }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn closest_point_by_region() {
        let cases = [
            (DVec3::new(0.2, 0.2, 3.0), DVec3::new(0.2, 0.2, 0.0)),
            (DVec3::new(-1.0, -1.0, 0.0), DVec3::ZERO),
            (DVec3::new(2.0, -1.0, 0.0), DVec3::X),
            (DVec3::new(-1.0, 3.0, 0.0), DVec3::Y),
            (DVec3::new(0.5, -1.0, 0.0), DVec3::new(0.5, 0.0, 0.0)),
            (DVec3::new(-1.0, 0.5, 1.0), DVec3::new(0.0, 0.5, 0.0)),
            (DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.5, 0.5, 0.0)),
        ];
        for (p, expected) in cases {
            assert!((closest_point(p, T) - expected).length() < 1e-15, "{p}");
        }
    }

    #[test]
    fn degenerate_triangle_is_a_segment_or_a_point() {
        let p = DVec3::new(0.5, 1.0, 0.0);
        let segment = [DVec3::ZERO, DVec3::X, DVec3::X];
        assert_eq!(closest_point(p, segment), DVec3::new(0.5, 0.0, 0.0));
        assert_eq!(closest_point(p, [DVec3::X; 3]), DVec3::X);
    }

    #[test]
    fn point_on_a_needle_is_found() {
        // So thin that the interior solution is noise.
        let (a, b) = (DVec3::new(-1e3, 3.0, 7.0), DVec3::new(1e3, -3.0, 9.0));
        let needle = [a, b, a.lerp(b, 0.3) + DVec3::new(0.0, 1e-9, 0.0)];
        for t in [0.01, 0.3, 0.77] {
            let p = a.lerp(b, t);
            assert!(closest_point(p, needle).distance(p) < 1e-8, "{t}");
        }
    }

    #[test]
    fn area_of_half_a_square() {
        assert_eq!(area(T), 0.5);
    }
}
