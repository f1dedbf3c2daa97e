//! What perception knows of a mesh, before it is placed.

mod paint;
mod volume;

use super::bounds::Bounds;
use super::object::Object;
use super::oklab::cube_root;
use crate::error::{Error, Result};
use crate::geom::{DVec3, Vec3};
use crate::mesh::PositionIds;
use crate::render::Model;
use glam::{DMat3, DMat4};

/// What perception knows of a mesh: found once, then placed any number of times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Box around all triangles, in the mesh's space; a point at its origin if
    /// there is none.
    pub bounds: Bounds,
    /// Of a closed mesh what its surface encloses: the signed volume without its
    /// sign, so that cavities count as such. Otherwise that of its box, in the
    /// mesh's space.
    pub volume: f64,
    /// Area of the surface that is seen: cut-out and transparent parts count by
    /// what they cover.
    pub area: f64,
    /// Mean colour of that area, linear RGB: factor x texture x vertex colour.
    pub color: Vec3,
}

impl Shape {
    /// Of mesh number `mesh` of a model, whose instances do not matter. Textures
    /// are looked up texel by texel, up to 1024 of them for a triangle.
    ///
    /// # Errors
    /// [`Error::BadReference`] if there is no such mesh or a range names a
    /// material that does not exist; [`Error::IndexOutOfRange`],
    /// [`Error::LengthMismatch`], [`Error::BadRange`] or [`Error::NotFinite`] for a
    /// mesh that does not hold together.
    pub fn of(model: &Model<'_>, mesh: usize) -> Result<Self> {
        let found = model.meshes.get(mesh).ok_or(Error::BadReference {
            what: "shape",
            index: mesh,
            target: "mesh",
            to: mesh,
            problem: "does not exist",
        })?;
        found.validate_indices()?;
        found.validate_lengths()?;
        found.validate_ranges()?;
        if let Some(index) = found.positions.iter().position(|p| !p.is_finite()) {
            let what = "position".into();
            return Err(Error::NotFinite { what, index });
        }
        let corners = found.triangles.iter().flatten();
        let corners = corners.map(|&v| Bounds::point(found.positions[v as usize].as_dvec3()));
        let bounds = corners.reduce(|a, b| a.union(&b));
        let bounds = bounds.unwrap_or(Bounds::point(DVec3::ZERO));
        let seen = paint::seen(model, found)?;
        let ids = PositionIds::of_mesh(found);
        Ok(Self {
            bounds,
            volume: volume::enclosed(found, &ids, bounds.center()).unwrap_or(bounds.volume()),
            area: seen.area,
            color: seen.color,
        })
    }

    /// The mesh where `world_from_mesh`, an affine matrix, puts it, at rest. The box
    /// is that of the turned box; volumes grow by the determinant, areas by the
    /// square of its third root, which is exact where a scale is the same along all
    /// axes. A matrix with numbers that are none gives an object that
    /// [`Tree::build`](super::Tree::build) refuses.
    #[must_use]
    pub fn placed(&self, world_from_mesh: &DMat4) -> Object {
        let grown = DMat3::from_mat4(*world_from_mesh).determinant().abs();
        let length = cube_root(grown);
        Object {
            bounds: self.bounds.transformed(world_from_mesh),
            volume: self.volume * grown,
            area: self.area * length * length,
            color: self.color,
            velocity: Vec3::ZERO,
        }
    }

    /// Velocity of the mesh's middle on the way from one placement to another,
    /// which takes `seconds`: what an animation does between two of its frames.
    ///
    /// # Errors
    /// [`Error::BadOption`] if `seconds` is not positive.
    pub fn velocity(&self, from: &DMat4, to: &DMat4, seconds: f64) -> Result<Vec3> {
        if !(seconds > 0.0 && seconds.is_finite()) {
            return Err(Error::BadOption {
                option: "seconds",
                found: seconds.to_string(),
                expected: "positive",
            });
        }
        let middle = self.bounds.center();
        let way = to.transform_point3(middle) - from.transform_point3(middle);
        Ok((way / seconds).as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn placing_turns_scales_and_mirrors() {
        let mesh = shapes::closed_cube(2);
        let shape = Shape::of(&Model::of_mesh(&mesh), 0).unwrap();
        assert!((shape.volume - 1.0).abs() < 1e-6, "{shape:?}");
        assert!((shape.area - 6.0).abs() < 1e-6);
        let place = DMat4::from_translation(DVec3::splat(1e9))
            * DMat4::from_rotation_y(std::f64::consts::FRAC_PI_4)
            * DMat4::from_scale(DVec3::new(2.0, -2.0, 2.0));
        let object = shape.placed(&place);
        assert!((object.volume - 8.0).abs() < 1e-5);
        assert!((object.area - 24.0).abs() < 1e-5);
        let size = object.bounds.size();
        let expected = DVec3::new(8f64.sqrt(), 2.0, 8f64.sqrt());
        assert!(size.distance(expected) < 1e-6, "{size}");
    }

    #[test]
    fn an_open_mesh_has_the_volume_of_its_box() {
        let mesh = shapes::terrain(8, 8, 3);
        let shape = Shape::of(&Model::of_mesh(&mesh), 0).unwrap();
        assert_eq!(shape.volume, shape.bounds.volume());
        let empty = shapes::empty();
        let shape = Shape::of(&Model::of_mesh(&empty), 0).unwrap();
        assert_eq!((shape.volume, shape.area), (0.0, 0.0));
        assert_eq!(shape.bounds, Bounds::point(DVec3::ZERO));
        assert!(Shape::of(&Model::of_mesh(&empty), 1).is_err());
    }

    #[test]
    fn velocity_is_way_by_time() {
        let mesh = shapes::closed_cube(1);
        let shape = Shape::of(&Model::of_mesh(&mesh), 0).unwrap();
        let to = DMat4::from_translation(DVec3::new(3.0, 0.0, 4.0));
        let found = shape.velocity(&DMat4::IDENTITY, &to, 0.5).unwrap();
        assert_eq!(found, Vec3::new(6.0, 0.0, 8.0));
        assert!(shape.velocity(&DMat4::IDENTITY, &to, 0.0).is_err());
    }
}
