//! What levels of detail without groups take to look as groups do.

use super::groupings::{SIZE, Shot, view};
use super::stage::Stage;
use crate::progress::check_cancelled;
use anyhow::Result;
use karui::metrics::image::{PIXELS_PER_DEGREE, flip};

/// Steps in which coarser levels come nearer, each by a factor of two.
const STEPS: u32 = 12;

/// Levels of objects alone, ever coarser: mean FLIP and mean triangles over the views.
pub struct Curve(Vec<[f64; 2]>);

impl Curve {
    /// `stage` is that of the objects at the levels for their distance.
    pub fn of(stage: &mut Stage<'_>, shots: &[Shot]) -> Result<Self> {
        let points = (0..=STEPS).map(|step| point(stage, shots, 0.5f32.powi(step as i32)));
        Ok(Self(points.collect::<Result<_>>()?))
    }

    /// Triangles with which levels alone come to a FLIP, between two steps by a straight
    /// line; what their coarsest take if they never differ as much.
    pub fn triangles_at(&self, flip: f64) -> f64 {
        let reaches = |w: &&[[f64; 2]]| w[1][0] >= flip;
        let Some([a, b]) = self.0.windows(2).find(reaches).map(|w| [w[0], w[1]]) else {
            return self.0.last().map_or(f64::NAN, |point| point[1]);
        };
        let share = ((flip - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
        a[1] + share * (b[1] - a[1])
    }
}

/// With the distances at which levels are switched made shorter by a factor.
fn point(stage: &mut Stage<'_>, shots: &[Shot], factor: f32) -> Result<[f64; 2]> {
    let mut sum = [0.0, 0.0];
    for shot in shots {
        check_cancelled()?;
        let list = stage.coarser(&view(shot.camera, None), factor)?;
        let picture = stage.picture(&list, &shot.camera, SIZE)?;
        sum[0] += flip(&shot.original, &picture, PIXELS_PER_DEGREE)?.mean;
        sum[1] += list.counts.triangles as f64;
    }
    Ok(sum.map(|sum| sum / shots.len().max(1) as f64))
}

#[cfg(test)]
mod tests {
    use super::Curve;

    #[test]
    fn between_steps_by_a_straight_line_and_no_farther_than_the_coarsest() {
        let curve = Curve(vec![
            [0.01, 100.0],
            [0.03, 60.0],
            [0.03, 50.0],
            [0.05, 40.0],
        ]);
        let found = [0.0, 0.01, 0.02, 0.03, 0.04, 0.9].map(|f| curve.triangles_at(f));
        assert_eq!(
            found.map(f64::round),
            [100.0, 100.0, 80.0, 60.0, 45.0, 40.0]
        );
    }
}
