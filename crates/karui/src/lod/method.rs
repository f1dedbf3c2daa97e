//! Ways to make a level out of a mesh.

use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::simplify::{
    Blocked, ClusterOptions, Clustered, FoliageOptions, Simplified, SimplifyOptions, Stop, Stopped,
    TopologyChanges, cluster, foliage, simplify, simplify_chain,
};

/// What makes a level out of a mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Method {
    /// Edge collapse ([`simplify`]).
    #[default]
    Collapse,
    /// Edge collapse, and where it stops before the target, vertex clustering
    /// of what is left.
    CollapseElseCluster,
    /// Vertex clustering ([`cluster`]).
    Cluster,
    /// Fewer leaf cards, each larger ([`foliage`]); by counts and ratios only.
    Foliage {
        /// Triangles up to which a connected part is a leaf card.
        card: usize,
    },
}

/// A level, not measured yet.
pub(super) struct Made {
    pub simplified: Simplified,
    /// Why edge collapse had stopped, if clustering has taken over.
    pub fallback: Option<Stopped>,
}

impl Method {
    /// Foliage differs from the original by what its leaves are apart, whatever
    /// is asked for.
    pub(super) fn check(self, stops: &[Stop]) -> Result<()> {
        if matches!(self, Self::Foliage { .. }) && stops.iter().any(Stop::bounds_error) {
            return Err(Error::BadOption {
                option: "levels",
                found: "a bound on the error".into(),
                expected: "counts or ratios in foliage mode",
            });
        }
        Ok(())
    }

    /// One level, to `options.stop`.
    pub(super) fn make(self, mesh: &TriMesh, options: &SimplifyOptions<'_>) -> Result<Made> {
        match self {
            Self::Cluster => clustered(mesh, options).map(plain),
            Self::Collapse => simplify(mesh, options).map(plain),
            Self::CollapseElseCluster => fall_back(mesh, options, simplify(mesh, options)?),
            Self::Foliage { card } => thinned(mesh, options, card).map(plain),
        }
    }

    /// Levels to one stop after another, none of them with a bound on the error.
    pub(super) fn make_chain(
        self,
        mesh: &TriMesh,
        stops: &[Stop],
        options: &SimplifyOptions<'_>,
    ) -> Result<Vec<Made>> {
        let at = |&stop: &Stop| SimplifyOptions { stop, ..*options };
        if matches!(self, Self::Cluster | Self::Foliage { .. }) {
            return stops.iter().map(|s| self.make(mesh, &at(s))).collect();
        }
        let chain = stops.iter().zip(simplify_chain(mesh, stops, options)?);
        let made = |(stop, simplified)| match self {
            Self::CollapseElseCluster => fall_back(mesh, &at(stop), simplified),
            _ => Ok(plain(simplified)),
        };
        chain.map(made).collect()
    }
}

fn plain(simplified: Simplified) -> Made {
    Made {
        simplified,
        fallback: None,
    }
}

/// Clustering of what is left where something stood in the way, if it gets
/// further: that is closer, on most models, than clustering from the start.
fn fall_back(mesh: &TriMesh, options: &SimplifyOptions<'_>, collapsed: Simplified) -> Result<Made> {
    if matches!(collapsed.stopped, Stopped::Target | Stopped::ErrorBound) {
        return Ok(plain(collapsed));
    }
    let of_ratio = |ratio: f64| (ratio * mesh.triangles.len() as f64).round() as usize;
    let stop = Stop {
        triangles: options.stop.triangles.max(options.stop.ratio.map(of_ratio)),
        ratio: None,
        ..options.stop
    };
    let options = SimplifyOptions { stop, ..*options };
    let clustered = match options.locks {
        // Locks are those of the input's vertices.
        Some(_) => clustered(mesh, &options)?,
        None => clustered(&collapsed.mesh, &options)?,
    };
    if clustered.mesh.triangles.len() >= collapsed.mesh.triangles.len() {
        return Ok(plain(collapsed));
    }
    Ok(Made {
        simplified: Simplified {
            error: collapsed.error + clustered.error,
            collapses: collapsed.collapses + clustered.collapses,
            ..clustered
        },
        fallback: Some(collapsed.stopped),
    })
}

fn thinned(mesh: &TriMesh, options: &SimplifyOptions<'_>, card: usize) -> Result<Simplified> {
    let options = FoliageOptions {
        simplify: *options,
        card,
        ..FoliageOptions::default()
    };
    let thinned = foliage(mesh, &options)?;
    Ok(Simplified {
        mesh: thinned.mesh,
        error: thinned.error,
        stopped: thinned.stopped,
        collapses: thinned.collapses,
        blocked: Blocked::default(),
        log: None,
        topology: TopologyChanges::default(),
    })
}

fn clustered(mesh: &TriMesh, options: &SimplifyOptions<'_>) -> Result<Simplified> {
    let options = ClusterOptions {
        stop: options.stop,
        locks: options.locks,
        progress: options.progress,
    };
    let Clustered {
        mesh,
        error,
        stopped,
        joined,
        ..
    } = cluster(mesh, &options)?;
    Ok(Simplified {
        mesh,
        error,
        stopped,
        collapses: joined,
        blocked: Blocked::default(),
        log: None,
        topology: TopologyChanges::default(),
    })
}
