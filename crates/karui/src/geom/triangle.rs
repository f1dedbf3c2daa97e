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

/// Point of the triangle nearest to `p`, degenerate triangles included
/// (Ericson, Real-Time Collision Detection, 5.1.5).
#[must_use]
pub fn closest_point(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * ratio(d1, d1 - d3);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * ratio(d2, d2 - d6);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ratio(d4 - d3, (d4 - d3) + (d5 - d6));
    }
    let sum = va + vb + vc;
    a + ab * ratio(vb, sum) + ac * ratio(vc, sum)
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
    fn area_of_half_a_square() {
        assert_eq!(area(T), 0.5);
    }
}
