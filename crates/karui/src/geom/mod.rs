//! Boxes, spheres, triangles: geometry that knows no mesh.

mod aabb;
mod triangle;

pub use aabb::Aabb;
pub use triangle::{area, closest_barycentric, closest_point, interpolate, normal_times_two_areas};

pub use glam::{DMat3, DVec2, DVec3, Mat4, Quat, Vec2, Vec3, Vec4};
