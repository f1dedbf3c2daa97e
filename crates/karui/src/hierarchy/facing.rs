//! Unit vectors in 32 bits.
//!
//! Q. Meyer et al.: On Floating-Point Normal Vectors, EGSR 2010 (octahedral).

use glam::{DVec2, DVec3};

const STEPS: f64 = 32767.0;

/// 16 bits for each coordinate on the unfolded octahedron.
pub(super) fn encode(n: DVec3) -> u32 {
    let flat = n.truncate() / (n.x.abs() + n.y.abs() + n.z.abs());
    let folded = if n.z < 0.0 { fold(flat) } else { flat };
    let bits = |x: f64| u32::from((x * STEPS).round() as i16 as u16);
    bits(folded.x) | bits(folded.y) << 16
}

/// The unit vector that was meant, to 1e-4; exact in single precision.
#[inline]
pub(super) fn decode(code: u32) -> DVec3 {
    let coordinate = |bits: u32| f64::from(bits as u16 as i16) * (1.0 / STEPS);
    let flat = DVec2::new(coordinate(code), coordinate(code >> 16));
    let z = 1.0 - flat.x.abs() - flat.y.abs();
    let unfolded = if z < 0.0 { fold(flat) } else { flat };
    unfolded.extend(z).normalize().as_vec3().as_dvec3()
}

#[inline]
fn fold(p: DVec2) -> DVec2 {
    let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
    DVec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::fibonacci_directions;

    #[test]
    fn directions_come_back() {
        for d in fibonacci_directions(5000) {
            let d = d.as_dvec3().normalize();
            assert!(decode(encode(d)).distance(d) < 1e-4, "{d}");
        }
        for d in [
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            -DVec3::X,
            -DVec3::Y,
            -DVec3::Z,
        ] {
            assert!(decode(encode(d)).distance(d) < 1e-7, "{d}");
        }
    }

    #[test]
    fn any_code_is_a_unit_vector() {
        for code in (0..u32::MAX).step_by(65_521) {
            assert!((decode(code).length() - 1.0).abs() < 1e-7, "{code}");
        }
    }
}
