//! The planes of the input that a point stands for: how far it has moved off.

use super::sym3::Sym3;
use glam::Vec3;

/// Squared distance to planes, as seen from a point (Garland & Heckbert 1997).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Planes {
    matrix: Sym3,
    linear: Vec3,
    constant: f32,
    area: f32,
}

impl Planes {
    /// Planes through the point itself, `share` of them.
    pub(super) fn through(planes: Sym3, share: f32) -> Self {
        Self {
            matrix: Sym3(planes.0.map(|v| v * share)),
            area: planes.trace() * share,
            ..Self::default()
        }
    }

    /// The same planes as seen from a point `by` away.
    pub fn moved(&self, by: Vec3) -> Self {
        let along = self.matrix.mul(by);
        Self {
            linear: self.linear + along,
            constant: self.constant + 2.0 * self.linear.dot(by) + along.dot(by),
            ..*self
        }
    }

    /// Both together.
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            matrix: self.matrix + other.matrix,
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
            area: self.area + other.area,
        }
    }

    /// Root mean square distance of the point from the planes.
    pub fn distance(&self) -> f32 {
        if self.area > 0.0 {
            (self.constant / self.area).max(0.0).sqrt()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_grows_with_the_way_off_the_planes() {
        let floor = Planes::through(Sym3::outer(Vec3::Z * 2.0), 1.0);
        assert_eq!(floor.moved(Vec3::X).distance(), 0.0);
        let there = floor.moved(Vec3::new(5.0, 1.0, 0.5));
        assert_eq!(there.distance(), 0.5);
        let back = there.moved(Vec3::new(0.0, 0.0, -0.5));
        assert!(back.distance() < 1e-6);
    }
}
