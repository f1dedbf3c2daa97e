//! What is looked at, and how closely.

use crate::error::{Error, Result};
use crate::geom::{Camera, Light};

/// Largest depth that may be asked for.
pub const MAX_DEPTH: u32 = 30;

/// From where a surface is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Where the picture is taken from.
    pub camera: Camera,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Lights whose terminators count, at most 15; see [`AdaptiveOptions::terminator_pixels`].
    pub lights: Vec<Light>,
}

/// How closely to look. Depths count √2 steps: each doubles the faces.
///
/// A face is looked at by what it is: in the picture or not, and then front-facing, on the
/// silhouette, or facing away. It is split while its depth is less than the one its kind may
/// have and it is not yet good enough. Without any of the limits in pixels, depth decides
/// alone, as published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveOptions {
    /// Depth of faces that face the eye. Default 4.
    pub depth_front: u32,
    /// Depth of faces at vertices where the surface turns away from the eye, or from a
    /// light. Default 8.
    pub depth_silhouette: u32,
    /// Depth of what faces away or is outside the picture. Default 0.
    pub depth_hidden: u32,
    /// A front face this close to the limit surface is good enough, pixels; `None`, the
    /// default, if none ever is.
    pub pixels: Option<f64>,
    /// The same at silhouettes, pixels; `None`, the default, is as for front faces.
    pub silhouette_pixels: Option<f64>,
    /// The same where light and dark part, pixels; `None`, the default, leaves lights aside.
    pub terminator_pixels: Option<f64>,
    /// No face in front has a longer side than this, pixels, however flat, up to its depth;
    /// `None`, the default, leaves size aside.
    pub side_pixels: Option<f64>,
    /// Whether faces are seen from behind as well, as those of sheets are; then whatever is
    /// in the picture counts as in front. Default `false`.
    pub two_sided: bool,
    /// Whether vertices are put on the limit surface, so that they stay where they are when
    /// what is around them becomes finer. Default `true`.
    pub limit: bool,
    /// Whether a face next to coarser ones makes them finer where it needs that to be split
    /// itself; else it stays as it is, as published. Default `true`.
    pub spread: bool,
    /// Nothing more is split once there are this many faces. Default 4,000,000.
    pub max_faces: usize,
    /// At the start of a frame, all that has been kept from others is forgotten if it has
    /// more faces than this, each about 480 bytes, and about as much again for texture
    /// coordinates and for colours. Default 4,000,000.
    pub max_kept: usize,
}

impl Default for AdaptiveOptions {
    fn default() -> Self {
        Self {
            depth_front: 4,
            depth_silhouette: 8,
            depth_hidden: 0,
            pixels: None,
            silhouette_pixels: None,
            terminator_pixels: None,
            side_pixels: None,
            two_sided: false,
            limit: true,
            spread: true,
            max_faces: 4_000_000,
            max_kept: 4_000_000,
        }
    }
}

impl AdaptiveOptions {
    /// As close to the limit surface as this many pixels, silhouettes twice as close.
    #[must_use]
    pub fn within(pixels: f64) -> Self {
        Self {
            depth_front: 20,
            depth_silhouette: 20,
            pixels: Some(pixels),
            silhouette_pixels: Some(0.5 * pixels),
            ..Self::default()
        }
    }

    /// Everything to one depth, whatever is looked at.
    #[must_use]
    pub fn uniform(depth: u32) -> Self {
        Self {
            depth_front: depth,
            depth_silhouette: depth,
            depth_hidden: depth,
            ..Self::default()
        }
    }

    /// # Errors
    /// [`Error::BadOption`] for a depth beyond [`MAX_DEPTH`], or pixels that are not
    /// positive and finite.
    pub(super) fn validate(&self) -> Result<()> {
        let depths = [
            ("depth_front", self.depth_front),
            ("depth_silhouette", self.depth_silhouette),
            ("depth_hidden", self.depth_hidden),
        ];
        if let Some((option, depth)) = depths.into_iter().find(|d| d.1 > MAX_DEPTH) {
            return Err(bad(option, &depth, "at most 30"));
        }
        let pixels = [
            ("pixels", self.pixels),
            ("silhouette_pixels", self.silhouette_pixels),
            ("terminator_pixels", self.terminator_pixels),
            ("side_pixels", self.side_pixels),
        ];
        for (option, value) in pixels {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(bad(option, &value, "positive and finite"));
            }
        }
        Ok(())
    }

    /// The depth that nothing exceeds.
    pub(super) fn deepest(&self) -> u32 {
        let depths = [self.depth_front, self.depth_silhouette, self.depth_hidden];
        depths.into_iter().fold(0, u32::max)
    }
}

pub(super) fn bad(
    option: &'static str,
    found: &dyn std::fmt::Display,
    expected: &'static str,
) -> Error {
    Error::BadOption {
        option,
        found: found.to_string(),
        expected,
    }
}
