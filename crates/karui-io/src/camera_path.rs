//! Cameras and lights frame by frame, from JSON or made up.

use crate::error::{Error, ErrorKind, Place, Result};
use karui::geom::{Aabb, Camera, Light, Projection, Vec3, turntable_directions};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What is seen and lit in every frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraPath {
    /// The frames, in order.
    pub frames: Vec<FrameOfPath>,
}

/// One frame. Without lights there are the three of `karui render`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameOfPath {
    /// Where it is seen from.
    pub camera: CameraOfPath,
    /// What shines on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<LightOfPath>>,
}

/// A camera; angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraOfPath {
    /// Where it stands, model units.
    pub eye: [f32; 3],
    /// A point in the middle of the picture, model units.
    pub target: [f32; 3],
    /// What is up in the picture. Default: y.
    #[serde(default = "upwards")]
    pub up: [f32; 3],
    /// Vertical field of view, degrees, unless there is a `height`. Default: 30.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fov: Option<f32>,
    /// Without perspective: height of the picture, model units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f32>,
    /// Distance before which nothing is seen, model units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<f32>,
    /// Distance beyond which nothing is seen, model units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub far: Option<f32>,
}

/// A light, white unless a colour is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "lowercase", tag = "type")]
pub enum LightOfPath {
    /// From infinitely far away.
    Directional {
        /// Where the light goes to; of any length.
        direction: [f32; 3],
        /// Linear RGB.
        #[serde(default = "white")]
        color: [f32; 3],
        /// Factor to the colour.
        #[serde(default = "one")]
        intensity: f32,
    },
    /// From a point, falling off with the squared distance.
    Point {
        /// Where it is, model units.
        position: [f32; 3],
        /// Linear RGB.
        #[serde(default = "white")]
        color: [f32; 3],
        /// Factor to the colour at a distance of one model unit.
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
    ///
    /// # Errors
    /// [`Error`] with the line, if it is no path, or one without frames.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read(path).map_err(|e| Error::file(path, ErrorKind::Io(e)))?;
        Self::parse(&text).map_err(|e| e.in_file(path))
    }

    /// A path that lies in memory as JSON.
    ///
    /// # Errors
    /// As [`CameraPath::read`].
    pub fn parse(text: &[u8]) -> Result<Self> {
        let expected = "a path of cameras in JSON";
        let read: Self = serde_json::from_slice(text).map_err(|e| {
            let kind = ErrorKind::syntax(expected, e.to_string());
            Error::new(Place::Line(e.line() as u64), kind)
        })?;
        match read.frames.is_empty() {
            false => Ok(read),
            true => Err(Error::new(
                Place::File,
                ErrorKind::syntax(expected, "one without frames"),
            )),
        }
    }

    /// Once around what is within `bounds`, in that many frames.
    #[must_use]
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
    ///
    /// # Errors
    /// [`karui::Error::BadOption`] if lights are to go with a camera that looks nowhere.
    pub fn resolve(&self) -> karui::Result<(Camera, Vec<Light>)> {
        let camera = self.camera.resolve();
        let lights = match &self.lights {
            Some(lights) => lights.iter().map(LightOfPath::resolve).collect(),
            None => Light::three_points(&camera)?,
        };
        Ok((camera, lights))
    }
}

impl CameraOfPath {
    /// As the library knows cameras.
    #[must_use]
    pub fn resolve(&self) -> Camera {
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
    /// As the library knows lights.
    #[must_use]
    pub fn resolve(&self) -> Light {
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
        let path = CameraPath::parse(text.as_bytes()).expect("reads");
        let (camera, lights) = path.frames[0].resolve().expect("resolves");
        assert_eq!(camera.up, Vec3::Y);
        assert!(matches!(lights[..], [Light::Point { intensity: 1.0, .. }]));
        let typo = text.replace("target", "targte");
        let wrong = CameraPath::parse(typo.as_bytes()).expect_err("refused");
        assert!(wrong.to_string().contains("targte"), "{wrong}");
        assert!(CameraPath::parse(br#"{"frames":[]}"#).is_err());
    }
}
