//! How large a refined mesh will be.

use super::level::Level;
use super::options::{Scheme, SubdivOptions};
use crate::error::{Error, Result};

/// Faces after `levels` steps from a mesh of so many faces, corners and edges with two faces
/// and with one; exact up to 2^53.
pub(super) fn faces(scheme: Scheme, levels: u32, level: &Level) -> f64 {
    let [faces, corners] = [level.faces.count(), level.corners.len()].map(|n| n as f64);
    // Beyond these the number is over 1e300, and soon infinite.
    let most = match scheme {
        Scheme::Sqrt2 => 1000,
        Scheme::Sqrt3 => 640,
        _ => 500,
    };
    let levels = levels.min(most) as i32;
    let quads = |steps: i32| {
        if steps == 0 {
            faces
        } else {
            corners * 4f64.powi(steps - 1)
        }
    };
    match scheme {
        Scheme::CatmullClark | Scheme::Bilinear => quads(levels),
        Scheme::Loop => faces * 4f64.powi(levels),
        Scheme::Sqrt3 => faces * 3f64.powi(levels),
        Scheme::Sqrt2 if levels % 2 == 0 => quads(levels / 2),
        Scheme::Sqrt2 => {
            let half = levels / 2;
            let edges = level.edges.len() as f64;
            if half == 0 {
                edges
            } else {
                edges * 2f64.powi(half) + corners * inside(half)
            }
        }
    }
}

/// Edges inside faces after `steps`, for every corner: E' = C + 2E with C four times as many
/// at every step.
fn inside(steps: i32) -> f64 {
    (0..steps).fold(0.0, |edges, step| 2.0 * edges + 4f64.powi(step))
}

/// Refuses what is more than was allowed, or than 32-bit indices can name.
pub(super) fn check(level: &Level, options: &SubdivOptions) -> Result<()> {
    let faces = faces(options.scheme, options.levels, level);
    // Four corners a face.
    let limit = options.max_faces.min(u64::from(u32::MAX / 4));
    if faces > limit as f64 {
        return Err(Error::TooFine {
            levels: options.levels,
            faces,
            limit,
        });
    }
    Ok(())
}
