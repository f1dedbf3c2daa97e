//! Boxes, triangles, cameras, lights: geometry that knows no mesh.

mod aabb;
mod camera;
mod light;
mod triangle;
mod trig;

pub use aabb::Aabb;
pub use camera::{Camera, Projection, fibonacci_directions, turntable_directions};
pub use light::Light;
pub use triangle::{area, closest_barycentric, closest_point, interpolate, normal_times_two_areas};
pub use trig::{sin_cos, tan};

pub use glam::{DMat3, DMat4, DVec2, DVec3, Mat4, Quat, Vec2, Vec3, Vec4};
