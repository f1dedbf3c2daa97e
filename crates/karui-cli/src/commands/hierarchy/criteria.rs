//! The tests by view and by light, as options.

use clap::Args;
use karui::geom::{Camera, Light};
use karui::hierarchy::{Silhouette, ViewAndLight};
use std::fmt;

/// The tests by view and by light.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "What is kept (docs/hierarchy.md)")]
pub struct CriteriaArgs {
    /// Least area on the screen, square pixels, of what a vertex touches (tau)
    #[arg(long, value_name = "PX2", default_value_t = 25.0, value_parser = at_least_zero)]
    area: f64,
    /// Least angle between normals, degrees from the axis of their cone (phi)
    #[arg(long, value_name = "DEG", default_value_t = 3.0, value_parser = degrees)]
    flatness: f64,
    /// Keep silhouettes down to this area, square pixels, or `off`
    #[arg(long, value_name = "PX2|off", default_value = "4", value_parser = silhouette)]
    silhouette: SilhouetteArg,
    /// Keep the line between lit and dark down to this area, square pixels, or `off`
    #[arg(long, value_name = "PX2|off", default_value = "4", value_parser = silhouette)]
    light_silhouette: SilhouetteArg,
    /// Keep highlights: degrees between the mirrored light and the eye (rho); 0 turns it off
    #[arg(long, value_name = "DEG", default_value_t = 30.0, value_parser = half_turn)]
    highlight: f64,
    /// Keep highlights down to this area, square pixels
    #[arg(long, value_name = "PX2", default_value_t = 4.0, value_parser = at_least_zero)]
    highlight_area: f64,
    /// Detail that is there stays until it would go were it larger by this factor
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = factor)]
    hysteresis: f64,
    /// Also keep what is outside the picture
    #[arg(long)]
    no_frustum: bool,
    /// Also keep what faces away
    #[arg(long)]
    no_back_facing: bool,
}

/// A [`Silhouette`] from the command line.
pub type SilhouetteArg = Silhouette;

impl CriteriaArgs {
    /// For one frame.
    pub fn resolve(&self, camera: Camera, lights: Vec<Light>, size: (u32, u32)) -> ViewAndLight {
        ViewAndLight {
            camera,
            lights,
            size: [size.0, size.1],
            frustum: !self.no_frustum,
            back_facing: !self.no_back_facing,
            silhouette: self.silhouette,
            area: self.area,
            flatness: self.flatness,
            light_silhouette: self.light_silhouette,
            highlight: self.highlight,
            highlight_area: self.highlight_area,
            hysteresis: self.hysteresis,
        }
    }
}

impl fmt::Display for CriteriaArgs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let least = |s| match s {
            Silhouette::Ignored => "off".to_owned(),
            Silhouette::Kept { area } => format!("{area} px2"),
        };
        write!(
            f,
            "area {} px2, flatness {} degrees, silhouettes {}, of lights {}, highlights {} degrees and {} px2",
            self.area,
            self.flatness,
            least(self.silhouette),
            least(self.light_silhouette),
            self.highlight,
            self.highlight_area,
        )
    }
}

fn silhouette(text: &str) -> Result<Silhouette, String> {
    match text {
        "off" => Ok(Silhouette::Ignored),
        text => at_least_zero(text).map(|area| Silhouette::Kept { area }),
    }
}

/// A number of 0 or more.
pub fn at_least_zero(text: &str) -> Result<f64, String> {
    within(text, f64::INFINITY)
}

fn degrees(text: &str) -> Result<f64, String> {
    within(text, 90.0)
}

fn half_turn(text: &str) -> Result<f64, String> {
    within(text, 180.0)
}

fn factor(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| (1.0..1e9).contains(x));
    number.ok_or_else(|| "expected a number of 1 or more".to_owned())
}

/// A number from 0 to `most`.
pub fn within(text: &str, most: f64) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x| (0.0..=most).contains(x));
    number.ok_or_else(|| match most.is_finite() {
        true => format!("expected a number from 0 to {most}"),
        false => "expected a number of 0 or more".to_owned(),
    })
}
