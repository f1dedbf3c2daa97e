//! Who is compared.

use super::super::clock::{Cost, Watch};
use super::peers::Peer;
use crate::failure::Failure;
use anyhow::Result;
use karui::TriMesh;
use karui::simplify::{ClusterOptions, Quality, SimplifyOptions, Stop, cluster, simplify};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// One of our modes.
pub struct Mode {
    pub name: &'static str,
    /// Whether it keeps no topology, and so is put beside those that do not
    /// either, without attributes.
    pub loose: bool,
    /// Simplifies a mesh to at most so many triangles.
    run: fn(&TriMesh, usize) -> karui::Result<TriMesh>,
}

/// Our modes: to add one, add a line.
pub const MODES: [Mode; 4] = [
    Mode::tight("fast", |mesh, n| collapsed(mesh, n, Quality::Fast)),
    Mode::tight("balanced", |mesh, n| collapsed(mesh, n, Quality::Balanced)),
    Mode::tight("exact", |mesh, n| collapsed(mesh, n, Quality::Exact)),
    Mode {
        name: "sloppy",
        loose: true,
        run: clustered,
    },
];

impl Mode {
    const fn tight(name: &'static str, run: fn(&TriMesh, usize) -> karui::Result<TriMesh>) -> Self {
        Self {
            name,
            loose: false,
            run,
        }
    }
}

fn collapsed(mesh: &TriMesh, triangles: usize, quality: Quality) -> karui::Result<TriMesh> {
    let options = SimplifyOptions {
        stop: Stop::triangles(triangles),
        quality,
        ..SimplifyOptions::default()
    };
    Ok(simplify(mesh, &options)?.mesh)
}

fn clustered(mesh: &TriMesh, triangles: usize) -> karui::Result<TriMesh> {
    let options = ClusterOptions {
        stop: Stop::triangles(triangles),
        ..ClusterOptions::default()
    };
    Ok(cluster(mesh, &options)?.mesh)
}

/// A way to simplify.
pub struct Contestant {
    /// A mode of ours or a function of another library; no two are the same.
    pub name: String,
    pub threads: usize,
    tool: Tool,
}

enum Tool {
    Ours(Mode, ThreadPool),
    Peer(Peer),
}

impl Contestant {
    /// The mode or peer of this name; `threads` is for ours only.
    pub fn named(name: &str, threads: usize) -> Result<Self> {
        let tool = if let Some(mode) = MODES.into_iter().find(|m| m.name == name) {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
            Tool::Ours(mode, pool)
        } else if let Some(peer) = Peer::named(name) {
            Tool::Peer(peer)
        } else {
            return Err(Failure::input(format!("{name}: no such mode")).into());
        };
        Ok(Self {
            name: name.to_owned(),
            threads,
            tool,
        })
    }

    /// Whether it is one of our modes.
    pub fn is_ours(&self) -> bool {
        matches!(self.tool, Tool::Ours(..))
    }

    /// Simplifies `mesh` to at most `triangles`. The cost is that of the one
    /// call; copies of what a peer overwrites are made before it.
    pub fn run(&self, mesh: &TriMesh, triangles: usize, watch: Watch) -> Result<(TriMesh, Cost)> {
        match &self.tool {
            Tool::Ours(mode, pool) => {
                let call = || pool.install(|| (mode.run)(mesh, triangles));
                let (done, cost) = watch.call(call);
                Ok((done?, cost))
            }
            Tool::Peer(peer) => peer.run(mesh, triangles, watch),
        }
    }
}
