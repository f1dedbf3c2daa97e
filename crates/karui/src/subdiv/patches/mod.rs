//! The fast way of Catmull-Clark: every quad becomes a grid.
//!
//! Inside a quad the surface is a bicubic B-spline, whatever happens at its edges: its grid
//! is refined row by row, needing nothing but the four curves around it. A curve needs the
//! row on either side of it, which again is a B-spline but for its ends; and the ring around
//! a vertex needs nothing but itself. So rings come first, then curves, then grids, and none
//! waits for its like. Connectivity is arithmetic (`layout.rs`).

mod curves;
mod faces;
mod grids;
mod layout;
mod rings;

use super::cage::INFINITELY_SHARP;
use super::crease::decayed;
use super::level::Level;
use super::options::CreaseMethod;
use layout::Layout;

/// Where each side of a grid of `n` by `n` cells starts and how it goes on,
/// counter-clockwise.
fn sides(n: usize) -> [(usize, isize); 4] {
    let width = n as isize + 1;
    [(0, 1), (n, width), (n * (n + 2), -1), (n * (n + 1), -width)]
}

/// A level of quads that is divided several times at once.
#[derive(Debug, Clone)]
pub(super) struct Patches {
    start: Level,
    layout: Layout,
    /// Place of every edge in the rings of its ends.
    places: Vec<[u32; 2]>,
}

/// Memory of an evaluation, for the next one.
#[derive(Debug, Clone)]
pub(super) struct Memory<const N: usize> {
    rings: rings::Rings<N>,
    curves: Vec<[f32; N]>,
}

impl<const N: usize> Default for Memory<N> {
    fn default() -> Self {
        Self {
            rings: rings::Rings::default(),
            curves: Vec::new(),
        }
    }
}

impl Patches {
    /// Whether `level` can be divided this way: quads that form a manifold, with creases that
    /// are equally sharp from end to end.
    pub fn can_start(level: &Level) -> bool {
        let uneven = |&s: &f32| s > 0.0 && s < INFINITELY_SHARP;
        let odd = |v: usize| level.odd_vertices[v] && !level.vertex_corners(v as u32).is_empty();
        level.is_uniform(4)
            && !level.linear_boundaries
            && level.dependents.is_empty()
            && !level.odd_edges.contains(&true)
            && !(0..level.vertices).any(odd)
            && (level.creases == CreaseMethod::Uniform || !level.edge_sharpness.iter().any(uneven))
    }

    /// `start` divided `depth` times, at least once.
    pub fn new(start: Level, depth: u32) -> Self {
        let layout = Layout::new(
            depth,
            start.vertices,
            start.faces.count(),
            start.edges.len(),
        );
        let place = |e: usize, v: u32| {
            let ring = start.vertex_edges(v);
            ring.iter().position(|&at| at as usize == e).unwrap_or(0) as u32
        };
        let ends = start.edges.iter().enumerate();
        let places = ends.map(|(e, ends)| ends.map(|v| place(e, v))).collect();
        Self {
            start,
            layout,
            places,
        }
    }

    pub fn depth(&self) -> u32 {
        self.layout.depth
    }

    /// Vertices after the last step.
    pub fn vertex_count(&self) -> usize {
        self.layout.vertices as usize
    }

    /// Values of all vertices after the last step.
    pub fn evaluate<const N: usize>(
        &self,
        from: &[[f32; N]],
        to: &mut [[f32; N]],
        memory: &mut Memory<N>,
    ) {
        memory.rings.fill(self, from);
        self.fill_curves(&memory.rings, &mut memory.curves);
        self.fill_grids(&memory.rings, &memory.curves, to);
    }

    /// Vertices of one side of a patch after the last step.
    fn side(&self) -> usize {
        1 << self.layout.depth
    }
}

/// Sharpness after so many steps.
fn after(sharpness: f32, steps: u32) -> f32 {
    (0..steps).fold(sharpness, |s, _| decayed(s))
}
