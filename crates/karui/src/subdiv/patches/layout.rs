//! Where the vertices of a patch lie in the order of the whole mesh.
//!
//! Numbers follow from those of the start: a level has its parent's vertices, then one a
//! face, then one an edge; its edges are one a corner, then two a parent's edge. So what a
//! patch adds in one step lies together, at a place proportional to the patch's number.

/// Vertices that every patch (or edge) adds at one time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Block {
    /// Number of the first of patch (edge) 0.
    pub first: u32,
    /// Where each lies in the grid of the patch, or along the edge.
    pub places: Vec<u32>,
    /// Whether it belongs to edges rather than to patches.
    pub of_edges: bool,
}

/// The layout of patches divided `depth` times.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub depth: u32,
    /// Blocks in order of numbers; before them come the vertices of the start.
    pub blocks: Vec<Block>,
    /// First corner of every face in the grid.
    pub cells: Vec<u32>,
    /// Vertices of the whole mesh.
    pub vertices: u64,
}

/// A piece of an edge, in units of the finest grid.
type Piece = [[u32; 2]; 2];

impl Layout {
    /// Of a mesh of so many vertices, faces and edges.
    pub fn new(depth: u32, vertices: usize, faces: usize, edges: usize) -> Self {
        let side = 1u32 << depth;
        let mut layout = Self {
            depth,
            blocks: Vec::new(),
            cells: Vec::new(),
            vertices: vertices as u64,
        };
        let mut cells = vec![[0u32, 0]];
        // Pieces of edges that appeared in patches, latest first, then of the start's.
        let mut inside: Vec<Vec<Piece>> = Vec::new();
        let mut along: Vec<Piece> = vec![[[0, 0], [side, 0]]];
        for step in 0..depth {
            let size = side >> step;
            let half = size / 2;
            let center = |c: &[u32; 2]| [c[0] + half, c[1] + half];
            layout.push(
                faces,
                cells.iter().map(|c| layout_place(center(c), side)),
                false,
            );
            for pieces in &inside {
                layout.push(
                    faces,
                    pieces.iter().map(|p| layout_place(middle(p), side)),
                    false,
                );
            }
            layout.push(edges, along.iter().map(|p| middle(p)[0]), true);
            inside = inside.iter().map(|pieces| halves(pieces)).collect();
            let spokes = cells.iter().flat_map(|c| {
                let [x, y] = *c;
                let ends = [
                    [x + half, y],
                    [x + size, y + half],
                    [x + half, y + size],
                    [x, y + half],
                ];
                ends.map(|end| [center(c), end])
            });
            inside.insert(0, spokes.collect());
            along = halves(&along);
            let quarters =
                |&[x, y]: &[u32; 2]| [[x, y], [x + half, y], [x + half, y + half], [x, y + half]];
            cells = cells.iter().flat_map(quarters).collect();
        }
        layout.cells = cells.iter().map(|&c| layout_place(c, side)).collect();
        layout
    }

    fn push(&mut self, count: usize, places: impl Iterator<Item = u32>, of_edges: bool) {
        let places: Vec<u32> = places.collect();
        let first = self.vertices as u32;
        self.vertices += places.len() as u64 * count as u64;
        self.blocks.push(Block {
            first,
            places,
            of_edges,
        });
    }
}

fn layout_place([x, y]: [u32; 2], side: u32) -> u32 {
    y * (side + 1) + x
}

fn middle(piece: &Piece) -> [u32; 2] {
    [0, 1].map(|i| u32::midpoint(piece[0][i], piece[1][i]))
}

/// Both halves of every piece, each from the middle outwards.
fn halves(pieces: &[Piece]) -> Vec<Piece> {
    let halves = |p: &Piece| [[middle(p), p[0]], [middle(p), p[1]]];
    pieces.iter().flat_map(halves).collect()
}
