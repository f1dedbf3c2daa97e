//! The cheapest stand-in that looks like the members.

use super::box_proxy::{BoxOptions, box_proxy};
use super::group::Group;
use super::impostor::{ImpostorOptions, impostor};
use super::judge::Judge;
use super::merged::{MergedOptions, merged_chain};
use super::proxy::{Proxy, ProxyKind};
use crate::error::{Error, Result};
use crate::simplify::Stop;

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
    /// What drawing a triangle counts for, bytes: the cheapest has the least sum of
    /// both. Default: 64.
    pub triangle_bytes: f64,
    /// How a box is made; `None` for no box.
    pub solid: Option<BoxOptions>,
    /// How cards are made; `None` for none. If there is a level card, cards without
    /// it are tried as well.
    pub cards: Option<ImpostorOptions>,
    /// How members are merged; `None` for never. Where they stop is not looked at:
    /// see [`ChooseOptions::errors`].
    pub merged: Option<MergedOptions<'a>>,
    /// Errors at which merging stops, one stand-in each, in pixels when it is switched
    /// in. Default: 4, 1 and 1/4.
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
            triangle_bytes: 64.0,
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
    /// The cheapest within the tolerance; if none is, the one that looks most like the
    /// members. `None` if none has fewer triangles and keeps to the bounds.
    pub proxy: Option<Proxy>,
    /// Whether it is within the tolerance.
    pub within: bool,
    /// All that were made, from the cheapest on.
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
    /// Its mean FLIP; `None` if it was not looked at, a cheaper one being good enough
    /// or it being beyond a bound.
    pub image_error: Option<f64>,
}

/// Makes stand-ins of all kinds and takes the cheapest whose pictures, when it is
/// switched in, differ from those of the members by no more than the tolerance.
///
/// # Errors
/// Those of the kinds; [`Error::BadOption`] for options out of range.
pub fn choose(group: &Group<'_>, options: &ChooseOptions<'_>) -> Result<Choice> {
    check(options)?;
    let mut made = make(group, options)?;
    made.sort_by(|a, b| cost(a, options).total_cmp(&cost(b, options)));
    if made.is_empty() {
        return Ok(Choice::default());
    }
    let judge = Judge::new(group, options.pixels, options.views)?;
    let mut choice = Choice::default();
    let mut best = f64::INFINITY;
    for mut proxy in made {
        let look_at = !choice.within && is_affordable(&proxy, options);
        proxy.image_error = look_at.then(|| judge.flip(&proxy)).transpose()?;
        choice.candidates.push(Candidate::of(&proxy));
        if let Some(seen) = proxy.image_error.filter(|seen| *seen < best) {
            best = seen;
            choice.within = seen <= options.tolerance;
            choice.proxy = Some(proxy);
        }
    }
    Ok(choice)
}

fn make(group: &Group<'_>, options: &ChooseOptions<'_>) -> Result<Vec<Proxy>> {
    let mut made = Vec::new();
    if let Some(solid) = &options.solid {
        made.extend(box_proxy(group, solid)?);
    }
    if let Some(cards) = options.cards {
        let pixels = options.pixels;
        // A level card is good for what is flat and bad for what is high.
        for top in if cards.top {
            &[true, false][..]
        } else {
            &[false]
        } {
            let cards = ImpostorOptions {
                pixels,
                top: *top,
                ..cards
            };
            made.extend(impostor(group, &cards)?);
        }
    }
    let Some(joined) = options.merged else {
        return Ok(made);
    };
    let pixel = group.bounds().diagonal() / f64::from(options.pixels);
    let mut errors = options.errors.to_vec();
    errors.sort_by(f64::total_cmp);
    let stops: Vec<Stop> = errors.iter().map(|e| Stop::error(e * pixel)).collect();
    let joined = MergedOptions {
        pixels: options.pixels,
        ..joined
    };
    made.extend(merged_chain(group, &stops, &joined)?.into_iter().flatten());
    Ok(made)
}

fn cost(proxy: &Proxy, options: &ChooseOptions<'_>) -> f64 {
    proxy.bytes as f64 + options.triangle_bytes * proxy.triangles() as f64
}

fn is_affordable(proxy: &Proxy, options: &ChooseOptions<'_>) -> bool {
    options
        .triangles
        .is_none_or(|most| proxy.triangles() <= most)
        && options.bytes.is_none_or(|most| proxy.bytes <= most)
}

impl Candidate {
    fn of(proxy: &Proxy) -> Self {
        Self {
            kind: proxy.kind,
            triangles: proxy.triangles(),
            bytes: proxy.bytes,
            error: proxy.error,
            image_error: proxy.image_error,
        }
    }
}

fn check(options: &ChooseOptions<'_>) -> Result<()> {
    let wrong = |option, found: f64, expected| Error::BadOption {
        option,
        found: found.to_string(),
        expected,
    };
    if !(0.0..=1.0).contains(&options.tolerance) {
        return Err(wrong("tolerance", options.tolerance, "0 to 1"));
    }
    if options.pixels == 0 {
        return Err(wrong("pixels", 0.0, "1 or more"));
    }
    if options.views == 0 {
        return Err(wrong("views", 0.0, "1 or more"));
    }
    let bytes = options.triangle_bytes;
    if !(bytes.is_finite() && bytes >= 0.0) {
        return Err(wrong("triangle_bytes", bytes, "0 or more, and finite"));
    }
    match options
        .errors
        .iter()
        .find(|e| !(e.is_finite() && **e >= 0.0))
    {
        Some(error) => Err(wrong("errors", *error, "0 or more, and finite")),
        None => Ok(()),
    }
}
