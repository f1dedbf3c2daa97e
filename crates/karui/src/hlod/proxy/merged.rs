//! The members as one simplified mesh.

use super::budget::Budget;
use super::distance::distance;
use super::floor::is_beyond_reach;
use super::group::Group;
use super::hidden::hidden;
use super::plan::{Plan, Wardrobe};
use super::proxy::{Proxy, ProxyKind};
use super::single::single;
use crate::error::Result;
use crate::mesh::TriMesh;
use crate::progress::{Progress, Silent, step};
use crate::simplify::{ClusterOptions, Quality, SimplifyOptions, Stop, cluster, simplify_chain};
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
    let mut levels = Levels::new(group, &[options.stop], usize::MAX, options)?;
    levels.pop().unwrap_or(Ok(None))
}

/// The members simplified to one stop after another, and made stand-ins of one by one.
pub(super) struct Levels<'a> {
    group: &'a Group<'a>,
    seen: Cow<'a, Group<'a>>,
    plan: Plan,
    budget: Budget,
    /// Coarsest last.
    meshes: Vec<TriMesh>,
    progress: &'a dyn Progress,
}

impl<'a> Levels<'a> {
    /// To `stops`, finest first, none with more than `most` triangles.
    pub fn new(
        group: &'a Group<'a>,
        stops: &[Stop],
        most: usize,
        options: &MergedOptions<'a>,
    ) -> Result<Self> {
        let budget = Budget::new(group, options)?;
        step(options.progress, "merging", 0.0)?;
        let is_none = group.is_empty() || stops.is_empty();
        let seen = match is_none {
            true => Cow::Borrowed(group),
            false => seen(group, options)?,
        };
        let plan = Plan::of(&seen, options.materials, &budget);
        let source = plan.source(&seen);
        step(options.progress, "merging", 0.2)?;
        let meshes = match is_none || source.triangles.is_empty() {
            true => Vec::new(),
            false => levels(&source, group, stops, most, options)?,
        };
        step(options.progress, "merging", 0.6)?;
        Ok(Self {
            group,
            seen,
            plan,
            budget,
            meshes,
            progress: options.progress,
        })
    }

    /// Takes out the coarsest level left and makes it a stand-in, unless it has as many
    /// triangles as the members have, or none.
    pub fn pop(&mut self) -> Option<Result<Option<Proxy>>> {
        let mesh = self.meshes.pop()?;
        Some(self.proxy(mesh))
    }

    fn proxy(&self, mesh: TriMesh) -> Result<Option<Proxy>> {
        if mesh.triangles.is_empty() || mesh.triangles.len() >= self.group.triangles() {
            return Ok(None);
        }
        let error = self.group.error + distance(&self.seen, &mesh)?;
        let dressed = Wardrobe::new(&self.seen, &self.plan)?.dress(mesh, &self.budget)?;
        let scene = dressed.outfit.scene(dressed.mesh);
        let proxy = Proxy::new(ProxyKind::Merged, self.group.origin, scene, error);
        step(self.progress, "merging", 1.0)?;
        Ok(Some(Proxy {
            coarser: dressed.coarser,
            ..proxy
        }))
    }
}

/// Levels that differ, coarsest last. Where topology is in the way of `most` triangles,
/// there is one by vertex clustering.
fn levels(
    source: &TriMesh,
    group: &Group<'_>,
    stops: &[Stop],
    most: usize,
    options: &MergedOptions<'_>,
) -> Result<Vec<TriMesh>> {
    let mut meshes = match is_beyond_reach(source, most, options)? {
        true => Vec::new(),
        false => simplified(source, group, stops, most, options)?,
    };
    if meshes.is_empty() {
        let how = ClusterOptions {
            stop: Stop::triangles(most),
            ..ClusterOptions::default()
        };
        let mut clustered = cluster(source, &how)?.mesh;
        single(&mut clustered);
        meshes.push(clustered);
    }
    Ok(meshes)
}

/// Levels that differ, of no more than `most` triangles, coarsest last.
fn simplified(
    source: &TriMesh,
    group: &Group<'_>,
    stops: &[Stop],
    most: usize,
    options: &MergedOptions<'_>,
) -> Result<Vec<TriMesh>> {
    let stops: Vec<Stop> = stops.iter().map(|stop| of_all(group, stop)).collect();
    let levels = simplify_chain(source, &stops, &simplify_options(options))?;
    let mut meshes: Vec<TriMesh> = levels.into_iter().map(|level| level.mesh).collect();
    meshes.retain(|mesh| mesh.triangles.len() <= most);
    meshes.dedup_by_key(|mesh| mesh.triangles.len());
    Ok(meshes)
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

pub(super) fn simplify_options<'a>(options: &MergedOptions<'a>) -> SimplifyOptions<'a> {
    SimplifyOptions {
        quality: options.quality,
        ..SimplifyOptions::default()
    }
}
