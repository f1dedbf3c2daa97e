//! How a scene is cut into tiles.

use crate::error::{Error, Result};
use crate::hlod::TreeOptions;
use crate::hlod::proxy::{ChooseOptions, MergedOptions};
use crate::progress::{Progress, Silent};
use crate::simplify::{Quality, Stop};
use std::fmt;

/// How [`Hlod::build`](super::Hlod::build) works.
#[derive(Clone, Copy)]
pub struct HlodOptions<'a> {
    /// How objects are grouped; its `progress` is not used.
    pub tree: TreeOptions<'a>,
    /// Most triangles of objects that are drawn as they are in one tile, but for an
    /// object that has more by itself. Default: 50,000.
    pub triangles: usize,
    /// Most triangles of a stand-in. Default: 20,000.
    pub stand_in: usize,
    /// Coarsest level of an object. Default: a tenth of its triangles.
    pub coarsest: Stop,
    /// How stand-ins are chosen; its bound on triangles is not used. Default: that of
    /// [`ChooseOptions`] at 256 pixels, with errors of at most 16 pixels (what clients
    /// of 3D Tiles switch at), seen from 3 sides, merged with [`Quality::Fast`] at 4
    /// pixels or as many triangles as there may be.
    pub choose: ChooseOptions<'a>,
    /// Told about the work and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for HlodOptions<'_> {
    fn default() -> Self {
        Self {
            tree: TreeOptions::default(),
            triangles: 50_000,
            stand_in: 20_000,
            coarsest: Stop::ratio(0.1),
            choose: ChooseOptions {
                pixels: 256,
                error: 16.0,
                views: 3,
                merged: Some(MergedOptions {
                    quality: Quality::Fast,
                    ..MergedOptions::default()
                }),
                errors: &[4.0],
                ..ChooseOptions::default()
            },
            progress: &Silent,
        }
    }
}

impl fmt::Debug for HlodOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("HlodOptions")
            .field("tree", &self.tree)
            .field("triangles", &self.triangles)
            .field("stand_in", &self.stand_in)
            .field("coarsest", &self.coarsest)
            .field("choose", &self.choose)
            .finish_non_exhaustive()
    }
}

impl<'a> HlodOptions<'a> {
    pub(super) fn check(&self) -> Result<()> {
        for (option, found) in [("triangles", self.triangles), ("stand_in", self.stand_in)] {
            if found == 0 {
                return Err(Error::BadOption {
                    option,
                    found: found.to_string(),
                    expected: "1 or more",
                });
            }
        }
        self.choose.check()
    }

    pub(super) fn tree_options(&self) -> TreeOptions<'a> {
        TreeOptions {
            progress: self.progress,
            ..self.tree
        }
    }
}
