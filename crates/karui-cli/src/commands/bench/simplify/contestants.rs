//! Who is compared.

use super::super::clock::{Cost, Watch};
use super::peers::Peer;
use crate::failure::Failure;
use anyhow::Result;
use karui::TriMesh;
use karui::simplify::{SimplifyOptions, Stop, simplify};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// A set of our options and its name.
pub type Mode = (&'static str, fn() -> SimplifyOptions<'static>);

/// Our modes: to add one, add a line.
pub const MODES: [Mode; 1] = [("default", SimplifyOptions::default)];

/// A way to simplify.
pub struct Contestant {
    /// A mode of ours or a function of another library; no two are the same.
    pub name: String,
    pub threads: usize,
    tool: Tool,
}

enum Tool {
    Ours(SimplifyOptions<'static>, ThreadPool),
    Peer(Peer),
}

impl Contestant {
    /// The mode or peer of this name; `threads` is for ours only.
    pub fn named(name: &str, threads: usize) -> Result<Self> {
        let tool = if let Some((_, options)) = MODES.iter().find(|m| m.0 == name) {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
            Tool::Ours(options(), pool)
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
            Tool::Ours(options, pool) => {
                let options = SimplifyOptions {
                    stop: Stop::triangles(triangles),
                    ..*options
                };
                let (done, cost) = watch.call(|| pool.install(|| simplify(mesh, &options)));
                Ok((done?.mesh, cost))
            }
            Tool::Peer(peer) => peer.run(mesh, triangles, watch),
        }
    }
}
