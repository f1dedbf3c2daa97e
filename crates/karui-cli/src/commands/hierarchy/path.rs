//! Cameras and lights frame by frame, from JSON or made up.

use crate::failure::Failure;
use anyhow::Result;
use karui::geom::{Aabb, Camera, Light, Projection, Vec3, turntable_directions};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What is seen and lit in every frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraPath {
    pub frames: Vec<FrameOfPath>,
}

/// One frame. Without lights there are the three of `karui render`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameOfPath {
    pub camera: CameraOfPath,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<LightOfPath>>,
}

/// A camera; angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraOfPath {
    pub eye: [f32; 3],
    pub target: [f32; 3],
    #[serde(default = "upwards")]
    pub up: [f32; 3],
    /// Vertical field of view; none for a picture as high as `height`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fov: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub far: Option<f32>,
}

/// A light, white unless a colour is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "lowercase", tag = "type")]
pub enum LightOfPath {
    Directional {
        direction: [f32; 3],
        #[serde(default = "white")]
        color: [f32; 3],
        #[serde(default = "one")]
        intensity: f32,
    },
    Point {
        position: [f32; 3],
        #[serde(default = "white")]
        color: [f32; 3],
        #[serde(default = "one")]
        intensity: f32,
    },
}

fn upwards() -> [f32; 3] {
    [0.0, 1.0, 0.0]
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn one() -> f32 {
    1.0
}

impl CameraPath {
    /// Reads a path from a JSON file.
    pub fn read(path: &Path) -> Result<Self> {
        let fail = |e: &dyn std::fmt::Display| Failure::input(format!("{}: {e}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|e| fail(&e))?;
        let hint = "docs/hierarchy.md shows what a path looks like";
        let read: Self = serde_json::from_str(&text).map_err(|e| fail(&e).hint(hint))?;
        if read.frames.is_empty() {
            return Err(fail(&"the path has no frames").hint(hint).into());
        }
        Ok(read)
    }

    /// Once around what is within `bounds`, in that many frames.
    pub fn around(bounds: Aabb, frames: u32) -> Self {
        let camera = |direction| {
            let camera = Camera::looking_at(bounds, direction, 30f32.to_radians());
            FrameOfPath {
                camera: CameraOfPath {
                    eye: camera.eye.to_array(),
                    target: camera.target.to_array(),
                    up: upwards(),
                    fov: Some(30.0),
                    height: None,
                    near: None,
                    far: None,
                },
                lights: None,
            }
        };
        Self {
            frames: turntable_directions(frames, 0.3)
                .into_iter()
                .map(camera)
                .collect(),
        }
    }
}

impl FrameOfPath {
    /// The camera and lights of the frame.
    pub fn resolve(&self) -> Result<(Camera, Vec<Light>)> {
        let camera = self.camera.resolve();
        let lights = match &self.lights {
            Some(lights) => lights.iter().map(LightOfPath::resolve).collect(),
            None => Light::three_points(&camera)?,
        };
        Ok((camera, lights))
    }
}

impl CameraOfPath {
    fn resolve(&self) -> Camera {
        let projection = match (self.height, self.fov) {
            (Some(height), _) => Projection::Orthographic { height },
            (None, fov) => Projection::Perspective {
                fov_y: fov.unwrap_or(30.0).to_radians(),
            },
        };
        Camera {
            eye: self.eye.into(),
            target: self.target.into(),
            up: self.up.into(),
            projection,
            near: self.near,
            far: self.far,
        }
    }
}

impl LightOfPath {
    fn resolve(&self) -> Light {
        match *self {
            Self::Directional {
                direction,
                color,
                intensity,
            } => Light::Directional {
                direction: direction.into(),
                color: color.into(),
                intensity,
            },
            Self::Point {
                position,
                color,
                intensity,
            } => Light::Point {
                position: Vec3::from(position),
                color: color.into(),
                intensity,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_comes_back() {
        let bounds = Aabb::of([Vec3::ZERO, Vec3::ONE]);
        let path = CameraPath::around(bounds, 5);
        let text = serde_json::to_string(&path).expect("writes");
        assert_eq!(
            serde_json::from_str::<CameraPath>(&text).expect("reads"),
            path
        );
    }

    #[test]
    fn what_is_left_out_is_filled_in() {
        let text = r#"{"frames":[{"camera":{"eye":[0,0,3],"target":[0,0,0]},
            "lights":[{"type":"point","position":[1,2,3]}]}]}"#;
        let path: CameraPath = serde_json::from_str(text).expect("reads");
        let (camera, lights) = path.frames[0].resolve().expect("resolves");
        assert_eq!(camera.up, Vec3::Y);
        assert!(matches!(lights[..], [Light::Point { intensity: 1.0, .. }]));
        let typo = text.replace("target", "targte");
        assert!(serde_json::from_str::<CameraPath>(&typo).is_err());
    }
}
