//! `karui subdivide --adaptive`: finer only where a camera looks.

use crate::args::size;
use anyhow::Result;
use karui::geom::{Aabb, Camera, Vec3};
use karui::subdiv::adaptive::{Adaptive, AdaptiveOptions, MAX_DEPTH, View};
use karui::subdiv::{ControlMesh, SubdivOptions, Subdivided};

/// Refinement for one view.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Adaptive refinement (by √2 steps, two to a level)")]
pub struct AdaptiveArgs {
    /// Refine only what the camera sees; --levels and --limit do not matter
    #[arg(long)]
    adaptive: bool,
    /// Where the eye is: the direction from the model towards it, which is then all in view; or
    /// the eye and what it looks at
    #[arg(long, value_name = "X,Y,Z[,X,Y,Z]", value_parser = place, allow_hyphen_values = true,
          default_value = "0.5,0.35,1", requires = "adaptive")]
    camera: Place,
    /// Vertical field of view, degrees
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 35.0,
        requires = "adaptive"
    )]
    fov: f32,
    /// Width and height of the picture, pixels
    #[arg(long, value_name = "N|WxH", default_value = "1920x1080", value_parser = size,
          requires = "adaptive")]
    screen: (u32, u32),
    /// Stop where the surface is as close as this to its limit, pixels, half of it at
    /// silhouettes; else depths decide alone
    #[arg(long, value_name = "PX", requires = "adaptive")]
    pixels: Option<f64>,
    /// Steps where the surface faces the eye [default: 4, or 20 with --pixels]
    #[arg(long, value_name = "N", requires = "adaptive",
          value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_DEPTH)))]
    depth_front: Option<u32>,
    /// Steps along silhouettes [default: 8, or 20 with --pixels]
    #[arg(long, value_name = "N", requires = "adaptive",
          value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_DEPTH)))]
    depth_silhouette: Option<u32>,
}

/// Where a picture is taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Towards(Vec3),
    At(Vec3, Vec3),
}

impl AdaptiveArgs {
    /// The mesh for the view, if that is asked for.
    pub fn refine(
        &self,
        control: &ControlMesh,
        options: &SubdivOptions,
    ) -> Option<karui::Result<Subdivided>> {
        self.adaptive.then(|| self.refined(control, options))
    }

    fn refined(&self, control: &ControlMesh, options: &SubdivOptions) -> karui::Result<Subdivided> {
        let options = control.rules.apply(*options);
        let how = AdaptiveOptions {
            max_faces: usize::try_from(options.max_faces).unwrap_or(usize::MAX),
            ..self.options()
        };
        let mut adaptive = Adaptive::of_control(control, &options)?;
        let drawn = adaptive.refine(&self.view(control), &how)?;
        Ok(Subdivided {
            faces: drawn.mesh.face_count(),
            mesh: drawn.mesh,
        })
    }

    fn options(&self) -> AdaptiveOptions {
        let options = self
            .pixels
            .map_or_else(AdaptiveOptions::default, AdaptiveOptions::within);
        AdaptiveOptions {
            depth_front: self.depth_front.unwrap_or(options.depth_front),
            depth_silhouette: self.depth_silhouette.unwrap_or(options.depth_silhouette),
            ..options
        }
    }

    fn view(&self, control: &ControlMesh) -> View {
        let bounds = Aabb::of(control.positions.iter().copied());
        let direction = match self.camera {
            Place::Towards(direction) => direction,
            Place::At(eye, target) => eye - target,
        };
        let framed = Camera::looking_at(bounds, direction, self.fov.to_radians());
        let camera = match self.camera {
            Place::Towards(_) => framed,
            Place::At(eye, target) => Camera {
                eye,
                target,
                ..framed
            },
        };
        View {
            camera,
            size: [self.screen.0, self.screen.1],
            lights: Vec::new(),
        }
    }
}

fn place(text: &str) -> Result<Place, String> {
    let numbers = text
        .split(',')
        .map(|n| n.trim().parse().ok().filter(|n: &f32| n.is_finite()));
    match numbers.collect::<Option<Vec<f32>>>().as_deref() {
        Some(&[x, y, z]) if [x, y, z] != [0.0; 3] => Ok(Place::Towards(Vec3::new(x, y, z))),
        Some(&[a, b, c, x, y, z]) if [a, b, c] != [x, y, z] => {
            Ok(Place::At(Vec3::new(a, b, c), Vec3::new(x, y, z)))
        }
        _ => Err("expected a direction as three numbers, or two places as six".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_three_numbers_or_six() {
        assert_eq!(
            place("1, 2,-3"),
            Ok(Place::Towards(Vec3::new(1.0, 2.0, -3.0)))
        );
        assert_eq!(place("0,0,1,0,0,0"), Ok(Place::At(Vec3::Z, Vec3::ZERO)));
        for wrong in ["", "1,2", "0,0,0", "1,2,nan", "1,1,1,1,1,1", "1,2,3,4"] {
            assert!(place(wrong).is_err(), "{wrong}");
        }
    }
}
