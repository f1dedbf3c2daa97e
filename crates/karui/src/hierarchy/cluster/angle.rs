//! Angles as cosine and sine: sums, differences and halves by roots and
//! products alone, so that they are the same on every machine.

use glam::DVec3;

/// An angle in 0..=pi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Angle {
    pub cos: f64,
    pub sin: f64,
}

impl Angle {
    pub const ZERO: Self = Self { cos: 1.0, sin: 0.0 };
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

    /// Below a right angle.
    pub fn of_sin(sin: f64) -> Self {
        let sin = sin.clamp(0.0, 1.0);
        Self {
            cos: ((1.0 - sin) * (1.0 + sin)).sqrt(),
            sin,
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

    /// At least 0.
    pub fn minus(self, other: Self) -> Self {
        if self.cos >= other.cos {
            return Self::ZERO;
        }
        Self {
            cos: self.cos * other.cos + self.sin * other.sin,
            sin: self.sin * other.cos - self.cos * other.sin,
        }
    }

    pub fn half(self) -> Self {
        Self {
            cos: (0.5 * (1.0 + self.cos)).max(0.0).sqrt(),
            sin: (0.5 * (1.0 - self.cos)).max(0.0).sqrt(),
        }
    }

    pub fn at_most(self, other: Self) -> bool {
        self.cos >= other.cos
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
            assert!(near(of(a).half(), 0.5 * a));
            for &b in &steps {
                assert!(near(of(a).plus(of(b)), (a + b).min(std::f64::consts::PI)));
                assert!(near(of(a).minus(of(b)), (a - b).max(0.0)));
                assert_eq!(of(a).at_most(of(b)), a <= b);
            }
        }
        let full = Angle::STRAIGHT.plus(Angle::STRAIGHT);
        assert_eq!(full, Angle::STRAIGHT);
    }
}
