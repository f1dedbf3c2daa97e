//! The screen that switch distances are for.

use karui::lod::Screen;

/// The screen that switch distances are for.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Screen")]
pub struct ScreenArgs {
    /// Height of the screen in pixels
    #[arg(long, value_name = "PX", default_value_t = 1080.0)]
    height: f64,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG", default_value_t = 60.0)]
    fov: f64,
    /// Largest error that may be seen, in pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0)]
    pixel_tolerance: f64,
}

impl ScreenArgs {
    /// In the library's units.
    pub fn resolve(&self) -> Screen {
        Screen {
            height_px: self.height,
            fov_y: self.fov.to_radians(),
            tolerance_px: self.pixel_tolerance,
        }
    }
}
