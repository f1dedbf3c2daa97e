//! The members as one simplified mesh.

use super::budget::Budget;
use super::distance::distance;
use super::group::Group;
use super::hidden::hidden;
use super::plan::{Plan, Wardrobe};
use super::proxy::{Proxy, ProxyKind};
use crate::error::Result;
use crate::progress::{Progress, Silent, step};
use crate::simplify::{Quality, SimplifyOptions, Stop, simplify_chain};
use std::borrow::Cow;
use std::fmt;

/// How members are merged.
#[derive(Clone, Copy)]
pub struct MergedOptions<'a> {
    /// When to stop simplifying; errors are in world units. Default: at a quarter of
    /// the members' triangles.
    pub stop: Stop,
    /// How much time to spend for how small an error. Default: [`Quality::Balanced`].
    pub quality: Quality,
    /// Whether connected parts that are never seen from outside are left out.
    /// Default: yes.
    pub drop_hidden: bool,
    /// Most materials that are kept apart as they are. With more, or with images of
    /// more pixels than the texture may have, colours go into one texture, or onto
    /// the vertices where nothing is textured. Default: 4.
    pub materials: usize,
    /// Pixels that the diagonal of the group covers on the screen when it is switched
    /// in; the texture has as many texels along the same way. 1 or more, 256 by
    /// default.
    pub pixels: u32,
    /// Longest side of the texture, texels: 32 to 4096; 1024 by default. A texture
    /// that would be larger is made coarser ([`Proxy::coarser`]).
    pub side: u32,
    /// Told about the work and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for MergedOptions<'_> {
    fn default() -> Self {
        Self {
            stop: Stop::ratio(0.25),
            quality: Quality::Balanced,
            drop_hidden: true,
            materials: 4,
            pixels: 256,
            side: 1024,
            progress: &Silent,
        }
    }
}

impl fmt::Debug for MergedOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MergedOptions")
            .field("stop", &self.stop)
            .field("quality", &self.quality)
            .field("drop_hidden", &self.drop_hidden)
            .field("materials", &self.materials)
            .field("pixels", &self.pixels)
            .field("side", &self.side)
            .finish_non_exhaustive()
    }
}

/// The members joined and simplified together, without the parts that are hidden in
/// others. Every triangle keeps the object it is of, so that picking still works.
///
/// Materials stay as they are where they are few ([`MergedOptions::materials`]).
/// Otherwise base colours alone are kept, in one texture or on the vertices; for
/// everything else of a material there is one mean for all that is opaque, masked or
/// blended. Hidden parts do not count for the error.
///
/// `None` if that leaves as many triangles as the members have, or none.
///
/// # Errors
/// Those of [`simplify_chain`] and
/// [`BadOption`](crate::Error::BadOption) for options out of range.
pub fn merged(group: &Group<'_>, options: &MergedOptions<'_>) -> Result<Option<Proxy>> {
    let mut levels = merged_chain(group, &[options.stop], options)?;
    Ok(levels.pop().flatten())
}

/// As [`merged`], to one stop after another, finest first.
pub(super) fn merged_chain(
    group: &Group<'_>,
    stops: &[Stop],
    options: &MergedOptions<'_>,
) -> Result<Vec<Option<Proxy>>> {
    let budget = Budget::new(group, options)?;
    if group.is_empty() || stops.is_empty() {
        return Ok(Vec::new());
    }
    step(options.progress, "merging", 0.0)?;
    let seen = seen(group, options)?;
    let plan = Plan::of(&seen, options.materials, &budget);
    let source = plan.source(&seen);
    if source.triangles.is_empty() {
        return Ok(Vec::new());
    }
    step(options.progress, "merging", 0.2)?;
    let stops: Vec<Stop> = stops.iter().map(|stop| of_all(group, stop)).collect();
    let levels = simplify_chain(&source, &stops, &simplify_options(options))?;
    step(options.progress, "merging", 0.6)?;
    let wardrobe = Wardrobe::new(&seen, plan)?;
    let mut chain = Vec::new();
    for level in levels {
        let mesh = level.mesh;
        if mesh.triangles.is_empty() || mesh.triangles.len() >= group.triangles() {
            chain.push(None);
            continue;
        }
        let error = group.error + distance(&seen, &mesh)?;
        let dressed = wardrobe.dress(mesh, &budget)?;
        let scene = dressed.outfit.scene(dressed.mesh);
        let proxy = Proxy::new(ProxyKind::Merged, group.origin, scene, error);
        chain.push(Some(Proxy {
            coarser: dressed.coarser,
            ..proxy
        }));
        step(options.progress, "merging", 0.9)?;
    }
    step(options.progress, "merging", 1.0)?;
    Ok(chain)
}

/// The group without what is hidden.
fn seen<'a>(group: &'a Group<'a>, options: &MergedOptions<'_>) -> Result<Cow<'a, Group<'a>>> {
    if !options.drop_hidden {
        return Ok(Cow::Borrowed(group));
    }
    let hidden = hidden(group)?;
    if !hidden.contains(&true) {
        return Ok(Cow::Borrowed(group));
    }
    Ok(Cow::Owned(group.without(&hidden)))
}

/// With shares of all members, hidden parts included.
fn of_all(group: &Group<'_>, stop: &Stop) -> Stop {
    let count = |r: f64| (r.max(0.0) * group.triangles() as f64).round() as usize;
    Stop {
        triangles: stop
            .triangles
            .into_iter()
            .chain(stop.ratio.map(count))
            .max(),
        ratio: None,
        ..*stop
    }
}

fn simplify_options<'a>(options: &MergedOptions<'a>) -> SimplifyOptions<'a> {
    SimplifyOptions {
        quality: options.quality,
        ..SimplifyOptions::default()
    }
}
