//! The cheapest stand-in that looks like the members.

use super::box_proxy::BoxOptions;
use super::group::Group;
use super::impostor::ImpostorOptions;
use super::merged::MergedOptions;
use super::pick::Pick;
use super::proxy::{Proxy, ProxyKind};
use crate::error::{Error, Result};

/// What a stand-in may cost and how it may look.
#[derive(Debug, Clone, Copy)]
pub struct ChooseOptions<'a> {
    /// Largest mean FLIP, 0 (no difference is seen) to 1, over the pixels that group
    /// or stand-in cover. Default: 0.15.
    pub tolerance: f64,
    /// Pixels that the diagonal of the group covers on the screen when the stand-in is
    /// switched in; 1 or more, 64 by default. Takes the place of those of the kinds.
    pub pixels: u32,
    /// Directions looked along, without perspective, those of
    /// [`fibonacci_directions`](crate::geom::fibonacci_directions); 1 or more, 6 by
    /// default.
    pub views: u32,
    /// Most triangles; no bound by default.
    pub triangles: Option<usize>,
    /// Most bytes ([`Proxy::bytes`]); no bound by default.
    pub bytes: Option<usize>,
    /// Largest error ([`Proxy::error`]) in pixels when it is switched in; 0 or more, no
    /// bound by default. If nothing keeps to it, the least error is taken.
    pub error: f64,
    /// How a box is made; `None` for no box.
    pub solid: Option<BoxOptions>,
    /// How cards are made; `None` for none. If there is a level card, cards without
    /// it are tried before.
    pub cards: Option<ImpostorOptions>,
    /// How members are merged; `None` for never. Where they stop is not looked at:
    /// see [`ChooseOptions::errors`].
    pub merged: Option<MergedOptions<'a>>,
    /// Errors at which merging stops, one stand-in each, in pixels when it is switched
    /// in; with a bound on triangles, one more stops there and none has more. Default:
    /// 4, 1 and 1/4.
    pub errors: &'a [f64],
}

impl Default for ChooseOptions<'_> {
    fn default() -> Self {
        Self {
            tolerance: 0.15,
            pixels: 64,
            views: 6,
            triangles: None,
            bytes: None,
            error: f64::INFINITY,
            solid: Some(BoxOptions::default()),
            cards: Some(ImpostorOptions::default()),
            merged: Some(MergedOptions::default()),
            errors: &[4.0, 1.0, 0.25],
        }
    }
}

/// What was chosen, and from what.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choice {
    /// The first within tolerance and bounds; if none is, of those within the bounds the
    /// one that looks most like the members; if only the error is beyond its bound, the
    /// one with the least. `None` if none has fewer triangles and keeps to the others.
    pub proxy: Option<Proxy>,
    /// Whether it is within the tolerance and all bounds.
    pub within: bool,
    /// All that were made, in that order.
    pub candidates: Vec<Candidate>,
}

/// What is known of a stand-in that was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// How it was made.
    pub kind: ProxyKind,
    /// Its triangles.
    pub triangles: usize,
    /// Its memory, as [`Proxy::bytes`].
    pub bytes: usize,
    /// Its error, as [`Proxy::error`].
    pub error: f64,
    /// Its mean FLIP; `None` if it was not looked at, being beyond a bound.
    pub image_error: Option<f64>,
}

/// Makes stand-ins from the kind that is expected cheapest on: a box, cards without a
/// level one, cards with it, members merged at the largest error, then at smaller ones.
/// Each is looked at as soon as it is made, and the first is taken whose pictures, when
/// it is switched in, differ from those of the members by no more than the tolerance:
/// what comes after it is not made at all. Nor is what cannot keep to the bound on the
/// error, unless there is nothing else.
///
/// # Errors
/// Those of the kinds; [`Error::BadOption`] for options out of range.
pub fn choose(group: &Group<'_>, options: &ChooseOptions<'_>) -> Result<Choice> {
    options.check()?;
    match group.is_empty() {
        true => Ok(Choice::default()),
        false => Pick::new(group, options).made(),
    }
}

impl Candidate {
    pub(super) fn of(proxy: &Proxy) -> Self {
        Self {
            kind: proxy.kind,
            triangles: proxy.triangles(),
            bytes: proxy.bytes,
            error: proxy.error,
            image_error: proxy.image_error,
        }
    }
}

impl ChooseOptions<'_> {
    /// # Errors
    /// [`Error::BadOption`] for what is out of range.
    pub(in crate::hlod) fn check(&self) -> Result<()> {
        let wrong = |option, found: f64, expected| Error::BadOption {
            option,
            found: found.to_string(),
            expected,
        };
        if !(0.0..=1.0).contains(&self.tolerance) {
            return Err(wrong("tolerance", self.tolerance, "0 to 1"));
        }
        if self.pixels == 0 {
            return Err(wrong("pixels", 0.0, "1 or more"));
        }
        if self.views == 0 {
            return Err(wrong("views", 0.0, "1 or more"));
        }
        if self.error.is_nan() || self.error < 0.0 {
            return Err(wrong("error", self.error, "0 or more"));
        }
        match self.errors.iter().find(|e| !(e.is_finite() && **e >= 0.0)) {
            Some(error) => Err(wrong("errors", *error, "0 or more, and finite")),
            None => Ok(()),
        }
    }
}
