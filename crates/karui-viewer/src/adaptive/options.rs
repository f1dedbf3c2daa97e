//! What a page can ask of a control mesh.

use crate::live::LiveError;
use karui::subdiv::adaptive::AdaptiveOptions;
use karui::subdiv::{Boundary, CreaseMethod, Rules, Scheme, SubdivOptions, TriangleRule};
use serde::Deserialize;

/// Faces of an answer at most.
const MOST_FACES: usize = 1_000_000;

/// How the surface is made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SmoothOptions {
    /// Which scheme, and how far.
    pub how: How,
    /// In place of what the file says of boundaries.
    pub boundary: Option<BoundaryName>,
    /// In place of what the file says of creases.
    pub creases: Option<CreaseName>,
    /// In place of what the file says of edge points beside triangles.
    pub triangles: Option<TriangleName>,
}

/// Which scheme, and how far.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", tag = "scheme")]
pub enum How {
    /// The limit surface of Catmull-Clark, by √2 steps, where it is looked at.
    Adaptive {
        /// How close to the limit surface, pixels; silhouettes are twice as close. None: the
        /// depths decide alone.
        #[serde(default)]
        pixels: Option<f64>,
        /// Steps where the surface faces the eye. Default: 4, or 20 with `pixels`.
        #[serde(default)]
        depth_front: Option<u32>,
        /// Steps along silhouettes. Default: 8, or 20 with `pixels`.
        #[serde(default)]
        depth_silhouette: Option<u32>,
        /// Whether faces are seen from behind as well. Default: no.
        #[serde(default)]
        two_sided: bool,
    },
    /// Everywhere alike.
    CatmullClark(Uniform),
    /// Everywhere alike.
    Sqrt2(Uniform),
    /// Everywhere alike; triangles alone.
    Sqrt3(Uniform),
    /// Everywhere alike; triangles alone.
    Loop(Uniform),
    /// Everywhere alike; nothing moves.
    Bilinear(Uniform),
}

/// Steps that are the same everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Uniform {
    /// Number of steps.
    pub levels: u32,
}

impl Default for How {
    fn default() -> Self {
        Self::Adaptive {
            pixels: Some(1.0),
            depth_front: None,
            depth_silhouette: None,
            two_sided: false,
        }
    }
}

/// [`Boundary`] by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BoundaryName {
    /// Faces at boundaries are left out.
    None,
    /// Boundaries become smooth curves, corners round.
    Edge,
    /// Boundaries become smooth curves, corners stay.
    Corner,
}

/// [`CreaseMethod`] by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CreaseName {
    /// By 1 a level.
    Uniform,
    /// Smoothed along the crease.
    Chaikin,
}

/// [`TriangleRule`] by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TriangleName {
    /// As everywhere else.
    CatmullClark,
    /// Heavier face points.
    Smooth,
}

impl SmoothOptions {
    /// The rules of the file, but for those given here.
    #[must_use]
    pub fn rules(&self, file: Rules) -> Rules {
        let boundary = |name| match name {
            BoundaryName::None => Boundary::None,
            BoundaryName::Edge => Boundary::EdgeOnly,
            BoundaryName::Corner => Boundary::EdgeAndCorner,
        };
        let creases = |name| match name {
            CreaseName::Uniform => CreaseMethod::Uniform,
            CreaseName::Chaikin => CreaseMethod::Chaikin,
        };
        let triangles = |name| match name {
            TriangleName::CatmullClark => TriangleRule::CatmullClark,
            TriangleName::Smooth => TriangleRule::Smooth,
        };
        Rules {
            boundary: self.boundary.map(boundary).or(file.boundary),
            creases: self.creases.map(creases).or(file.creases),
            triangles: self.triangles.map(triangles).or(file.triangles),
            ..file
        }
    }
}

impl How {
    /// The scheme and its steps, if it is the same everywhere.
    #[must_use]
    pub fn uniform(&self) -> Option<SubdivOptions> {
        let (scheme, uniform) = match *self {
            Self::Adaptive { .. } => return None,
            Self::CatmullClark(uniform) => (Scheme::CatmullClark, uniform),
            Self::Sqrt2(uniform) => (Scheme::Sqrt2, uniform),
            Self::Sqrt3(uniform) => (Scheme::Sqrt3, uniform),
            Self::Loop(uniform) => (Scheme::Loop, uniform),
            Self::Bilinear(uniform) => (Scheme::Bilinear, uniform),
        };
        Some(SubdivOptions {
            scheme,
            levels: uniform.levels,
            max_faces: MOST_FACES as u64,
            ..SubdivOptions::default()
        })
    }

    /// How closely to look, if it depends on the view. `most` faces, and no more than a page
    /// can draw.
    #[must_use]
    pub fn adaptive(&self, most: Option<usize>) -> Option<AdaptiveOptions> {
        let Self::Adaptive {
            pixels,
            depth_front,
            depth_silhouette,
            two_sided,
        } = *self
        else {
            return None;
        };
        let options = pixels.map_or_else(AdaptiveOptions::default, AdaptiveOptions::within);
        Some(AdaptiveOptions {
            depth_front: depth_front.unwrap_or(options.depth_front),
            depth_silhouette: depth_silhouette.unwrap_or(options.depth_silhouette),
            two_sided,
            max_faces: most.unwrap_or(MOST_FACES).min(MOST_FACES),
            max_kept: 2 * MOST_FACES,
            ..options
        })
    }
}

/// Refuses what would keep the machine busy for long: `levels` alone can ask for anything.
pub(super) fn check(how: &How) -> Result<(), LiveError> {
    match how.uniform() {
        Some(options) if options.levels > 12 => Err(LiveError::Range {
            what: "levels",
            expected: "at most 12",
            found: options.levels.to_string(),
        }),
        _ => Ok(()),
    }
}
