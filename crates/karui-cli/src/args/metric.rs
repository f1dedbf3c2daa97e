//! What decides from where on a level may be shown.

use crate::failure::Failure;
use anyhow::Result;
use clap::ValueEnum;
use karui::lod::SeenOptions;

/// What decides from where on a level may be shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Metric {
    /// The largest distance between the surfaces, in pixels
    #[default]
    Surface,
    /// How different pictures look from that distance (FLIP)
    Flip,
}

/// From where on a level may be shown.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Switch distances")]
pub struct MetricArgs {
    /// What decides from where on a level may be shown
    #[arg(long, value_enum, default_value_t, value_name = "METRIC")]
    metric: Metric,
    /// With --metric flip: largest mean FLIP, 0 (no difference seen) to 1 [default: 0.05]
    #[arg(long, value_name = "F")]
    flip: Option<f64>,
    /// With --metric flip: directions that the model is looked at from [default: 24]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    flip_views: Option<u32>,
}

impl MetricArgs {
    /// How levels are to be looked at; `None` if surfaces decide.
    pub fn resolve(&self) -> Result<Option<SeenOptions<'static>>> {
        let default = SeenOptions::default();
        let bound = self.flip.unwrap_or(default.bound);
        if !(0.0..=1.0).contains(&bound) {
            let message = format!("--flip {bound}: FLIP is 0 (no difference seen) to 1");
            return Err(Failure::input(message).into());
        }
        match self.metric {
            Metric::Flip => Ok(Some(SeenOptions {
                bound,
                views: self.flip_views.unwrap_or(default.views),
                ..default
            })),
            Metric::Surface if self.flip.is_some() || self.flip_views.is_some() => {
                let message = "--flip and --flip-views say nothing about surfaces";
                Err(Failure::input(message).hint("add --metric flip").into())
            }
            Metric::Surface => Ok(None),
        }
    }
}
