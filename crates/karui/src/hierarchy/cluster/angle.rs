//! Angles as cosine and sine: sums by roots and products alone, so that they are
//! the same on every machine.

use glam::DVec3;

/// An angle in 0..=pi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Angle {
    pub cos: f64,
    pub sin: f64,
}

impl Angle {
    pub const STRAIGHT: Self = Self {
        cos: -1.0,
        sin: 0.0,
    };

    pub fn of_cos(cos: f64) -> Self {
        let cos = cos.clamp(-1.0, 1.0);
        Self {
            cos,
            sin: ((1.0 - cos) * (1.0 + cos)).sqrt(),
        }
    }

    /// Between two unit vectors.
    pub fn between(a: DVec3, b: DVec3) -> Self {
        Self {
            cos: a.dot(b).clamp(-1.0, 1.0),
            sin: a.cross(b).length().min(1.0),
        }
    }

    /// At most pi.
    pub fn plus(self, other: Self) -> Self {
        if self.cos + other.cos <= 0.0 {
            return Self::STRAIGHT;
        }
        Self {
            cos: self.cos * other.cos - self.sin * other.sin,
            sin: self.sin * other.cos + self.cos * other.sin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_angles_as_numbers() {
        let of = |x: f64| Angle {
            cos: x.cos(),
            sin: x.sin(),
        };
        let steps: Vec<f64> = (0..=30).map(|i| f64::from(i) * 0.1).collect();
        let near = |a: Angle, x: f64| (a.cos - x.cos()).abs() < 1e-9;
        for &a in &steps {
            for &b in &steps {
                assert!(near(of(a).plus(of(b)), (a + b).min(std::f64::consts::PI)));
            }
        }
        let full = Angle::STRAIGHT.plus(Angle::STRAIGHT);
        assert_eq!(full, Angle::STRAIGHT);
    }
}
