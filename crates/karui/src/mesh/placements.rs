//! Where one mesh stands many times.

use super::Attribute;
use crate::error::{Error, Result};
use glam::{DMat4, DQuat, Mat4, Quat, Vec3};

/// Placements of a node's mesh in the node's space (`EXT_mesh_gpu_instancing`):
/// placement `i` scales, then rotates, then translates. A million of them take
/// 12 to 40 MB, however large the mesh is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placements {
    /// Translations, one a placement.
    pub translations: Vec<Vec3>,
    /// Unit rotations; `None` if nothing is rotated.
    pub rotations: Option<Vec<Quat>>,
    /// Scales along each axis; `None` if nothing is scaled.
    pub scales: Option<Vec<Vec3>>,
    /// Further values a placement, e.g. `_FEATURE_ID_0` or `_COLOR_0`.
    pub attributes: Vec<Attribute>,
}

impl Placements {
    /// Number of placements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.translations.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.translations.is_empty()
    }

    /// Placement `i` as a matrix; the identity beyond the last.
    #[must_use]
    pub fn matrix(&self, i: usize) -> Mat4 {
        self.matrix_f64(i).as_mat4()
    }

    /// [`Placements::matrix`] before it is rounded.
    #[must_use]
    pub fn matrix_f64(&self, i: usize) -> DMat4 {
        let translation = self.translations.get(i).copied().unwrap_or_default();
        let rotation = self.rotations.as_ref().and_then(|r| r.get(i));
        let scale = self.scales.as_ref().and_then(|s| s.get(i));
        DMat4::from_scale_rotation_translation(
            scale.map_or(glam::DVec3::ONE, |s| s.as_dvec3()),
            rotation.map_or(DQuat::IDENTITY, |r| r.as_dquat()),
            translation.as_dvec3(),
        )
    }

    /// Bytes of memory that the arrays take.
    #[must_use]
    pub fn memory(&self) -> usize {
        let rotations = self.rotations.as_deref().map_or(0, size_of_val);
        let scales = self.scales.as_deref().map_or(0, size_of_val);
        let custom = self.attributes.iter().map(|a| a.values.memory());
        size_of_val(&self.translations[..]) + rotations + scales + custom.sum::<usize>()
    }

    /// Checks that all arrays are as long as the translations and that every
    /// placement is finite.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`] or, beyond 2^32 - 1
    /// placements, [`Error::TooLarge`].
    pub fn validate(&self) -> Result<()> {
        let limit = u32::MAX as usize;
        if self.len() > limit {
            let (what, found) = ("placements", self.len());
            return Err(Error::TooLarge { what, found, limit });
        }
        self.validate_lengths()?;
        let not_finite = |what: &str, index| Error::NotFinite {
            what: format!("{what} of placement"),
            index,
        };
        let vectors = |what, values: &[Vec3]| match values.iter().position(|v| !v.is_finite()) {
            Some(i) => Err(not_finite(what, i)),
            None => Ok(()),
        };
        vectors("translation", &self.translations)?;
        vectors("scale", self.scales.as_deref().unwrap_or_default())?;
        let rotations = self.rotations.as_deref().unwrap_or_default();
        match rotations.iter().position(|q| !q.is_finite()) {
            Some(i) => Err(not_finite("rotation", i)),
            None => Ok(()),
        }
    }

    fn validate_lengths(&self) -> Result<()> {
        let same = |what: &str, found: usize, expected: usize| {
            if found == expected {
                return Ok(());
            }
            let what = format!("{what} of placements");
            Err(Error::LengthMismatch {
                what,
                expected,
                found,
            })
        };
        let count = self.len();
        let rotations = self.rotations.as_ref().map_or(count, Vec::len);
        same("rotations", rotations, count)?;
        same(
            "scales",
            self.scales.as_ref().map_or(count, Vec::len),
            count,
        )?;
        self.attributes.iter().try_for_each(|a| {
            let expected = count.saturating_mul(a.components);
            same(&format!("`{}`", a.name), a.values.len(), expected)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::AttributeValues;

    fn two() -> Placements {
        Placements {
            translations: vec![Vec3::X, Vec3::Y],
            rotations: Some(vec![Quat::IDENTITY, Quat::from_rotation_z(1.0)]),
            scales: Some(vec![Vec3::ONE, Vec3::new(1.0, -2.0, 3.0)]),
            attributes: vec![Attribute {
                name: "_ID".into(),
                components: 1,
                values: AttributeValues::U16(vec![7, 8]),
            }],
        }
    }

    #[test]
    fn scales_then_rotates_then_translates() {
        let placements = two();
        let p = Vec3::new(0.5, 0.25, -1.0);
        let expected = Quat::from_rotation_z(1.0) * (p * Vec3::new(1.0, -2.0, 3.0)) + Vec3::Y;
        assert!(placements.matrix(1).transform_point3(p).distance(expected) < 1e-6);
        assert_eq!(placements.matrix(9), Mat4::IDENTITY);
        assert_eq!(placements.memory(), 2 * (12 + 16 + 12 + 2));
    }

    #[test]
    fn lengths_and_numbers_are_checked() {
        two().validate().unwrap();
        let damage: [fn(&mut Placements); 6] = [
            |p| p.rotations.as_mut().unwrap().truncate(1),
            |p| p.scales.as_mut().unwrap().push(Vec3::ONE),
            |p| p.attributes[0].components = 2,
            |p| p.translations[1].y = f32::NAN,
            |p| p.scales.as_mut().unwrap()[0].z = f32::INFINITY,
            |p| p.rotations.as_mut().unwrap()[1].w = f32::NAN,
        ];
        for (i, damage) in damage.into_iter().enumerate() {
            let mut placements = two();
            damage(&mut placements);
            let error = placements.validate().unwrap_err();
            let length = matches!(error, Error::LengthMismatch { .. });
            assert_eq!(length, i < 3, "{error}");
        }
    }
}
