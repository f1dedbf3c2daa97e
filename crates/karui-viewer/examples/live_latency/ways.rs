//! Where the camera and the light go.

use karui::geom::{Aabb, Camera, Projection, Vec3, turntable_directions};
use serde_json::{Value, json};

/// A way around a model.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    /// What it is called.
    pub name: &'static str,
    /// How close the eye comes, as a factor to the distance at which all is seen.
    closest: f32,
    /// Whether the light goes along.
    lit: bool,
}

/// All of them.
pub const WAYS: [Way; 3] = [
    Way {
        name: "around",
        closest: 1.0,
        lit: false,
    },
    Way {
        name: "closer and away",
        closest: 0.3,
        lit: false,
    },
    Way {
        name: "around, with the light",
        closest: 1.0,
        lit: true,
    },
];

impl Way {
    /// Camera messages along it.
    pub fn messages(
        &self,
        bounds: Aabb,
        frames: u32,
        options: &Value,
        budget: &Value,
    ) -> Vec<String> {
        let directions = turntable_directions(frames, 0.3);
        let still = bounds.center() + Vec3::new(-0.6, 0.7, 0.8) * bounds.diagonal() as f32;
        let message = |(seq, direction): (u32, Vec3)| {
            let mut camera = Camera::looking_at(bounds, direction, 30f32.to_radians());
            let turn = std::f32::consts::TAU * seq as f32 / frames as f32;
            let share = 0.5 * (1.0 - self.closest) * (1.0 - turn.cos());
            camera.eye -= (camera.eye - camera.target) * share;
            let along = camera.eye + camera.up * bounds.diagonal() as f32;
            let light = if self.lit { along } else { still };
            let Projection::Perspective { fov_y } = camera.projection else {
                unreachable!("looking_at has a perspective");
            };
            json!({
                "seq": seq, "size": [1280, 720], "options": options, "budget": budget,
                "frame": {
                    "camera": {
                        "eye": camera.eye.to_array(), "target": camera.target.to_array(),
                        "fov": fov_y.to_degrees(),
                    },
                    "lights": [{ "type": "point", "position": light.to_array() }],
                },
            })
            .to_string()
        };
        (1u32..).zip(directions).map(message).collect()
    }
}
