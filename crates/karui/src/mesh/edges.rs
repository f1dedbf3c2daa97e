//! Which face corners share an undirected edge.

/// A mesh as a flat list of corners: what edge finding needs to know of it.
pub(crate) trait Corners: Sync {
    /// Number of corners of all faces.
    fn len(&self) -> usize;
    /// Vertex of corner `c`.
    fn vertex(&self, c: u32) -> u32;
    /// The corner after `c` around its face.
    fn next(&self, c: u32) -> u32;
    /// Face of corner `c`.
    fn face(&self, c: u32) -> u32;
    /// Whether the face of corner `c` takes part.
    fn is_used(&self, c: u32) -> bool;

    /// The ends of the edge that starts at corner `c`, in its direction.
    fn edge(&self, c: u32) -> [u32; 2] {
        [self.vertex(c), self.vertex(self.next(c))]
    }
}

/// Triangles by vertex or position id. Those with a repeated corner take no
/// part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TriangleCorners<'a>(pub &'a [[u32; 3]]);

impl Corners for TriangleCorners<'_> {
    fn len(&self) -> usize {
        self.0.len() * 3
    }

    fn vertex(&self, c: u32) -> u32 {
        self.0.as_flattened()[c as usize]
    }

    fn next(&self, c: u32) -> u32 {
        if c % 3 == 2 { c - 2 } else { c + 1 }
    }

    fn face(&self, c: u32) -> u32 {
        c / 3
    }

    fn is_used(&self, c: u32) -> bool {
        is_proper(self.0[c as usize / 3])
    }
}

/// Whether the corners of a triangle are three different vertices.
pub(crate) fn is_proper([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// All undirected edges, in the order of their lesser and then their greater
/// end. An edge is known by the corners that start it, in increasing order.
#[derive(Debug, Clone)]
pub(crate) struct EdgeTable {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl EdgeTable {
    /// Finds the edges of a mesh with `vertices` vertices, all of whose corners
    /// are valid; fewer than 2^32 corners.
    pub fn new(mesh: &impl Corners, vertices: usize) -> Self {
        let (buckets, mut entries) = by_lesser_end(mesh, vertices);
        let mut table = Self {
            starts: Vec::with_capacity(entries.len() / 2 + 1),
            corners: Vec::with_capacity(entries.len()),
        };
        for bucket in buckets.windows(2) {
            let bucket = &mut entries[bucket[0] as usize..bucket[1] as usize];
            bucket.sort_unstable();
            table.append(bucket);
        }
        table.starts.push(table.corners.len() as u32);
        table
    }

    /// Appends the edges of one lesser end, sorted by greater end and corner.
    fn append(&mut self, bucket: &[u64]) {
        let mut previous = u64::MAX;
        for &entry in bucket {
            if entry >> 32 != previous {
                previous = entry >> 32;
                self.starts.push(self.corners.len() as u32);
            }
            self.corners.push(entry as u32);
        }
    }

    /// Number of edges.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The corners that start each edge, edge by edge.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        let range = |w: &[u32]| &self.corners[w[0] as usize..w[1] as usize];
        self.starts.windows(2).map(range)
    }
}

/// Counting sort by lesser end: where each vertex' entries start, and the
/// entries as greater end and corner in one number.
fn by_lesser_end(mesh: &impl Corners, vertices: usize) -> (Vec<u32>, Vec<u64>) {
    let used = || (0..mesh.len() as u32).filter(|&c| mesh.is_used(c));
    let mut starts = vec![0u32; vertices + 2];
    for c in used() {
        let [a, b] = mesh.edge(c);
        starts[a.min(b) as usize + 2] += 1;
    }
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    // While filling, entry v + 1 moves from the start to the end of bucket v.
    let mut entries = vec![0u64; starts.last().map_or(0, |&n| n as usize)];
    for c in used() {
        let [a, b] = mesh.edge(c);
        let place = &mut starts[a.min(b) as usize + 1];
        entries[*place as usize] = u64::from(a.max(b)) << 32 | u64::from(c);
        *place += 1;
    }
    starts.pop();
    (starts, entries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn agrees_with_an_ordered_map(triangles in prop::collection::vec([0u32..9, 0u32..9, 0u32..9], 0..40)) {
            let mut expected: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
            for (t, &[a, b, c]) in triangles.iter().enumerate() {
                if a == b || b == c || a == c {
                    continue;
                }
                for (k, [a, b]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                    expected.entry([a.min(b), a.max(b)]).or_default().push((3 * t + k) as u32);
                }
            }
            let table = EdgeTable::new(&TriangleCorners(&triangles), 9);
            let found: Vec<&[u32]> = table.iter().collect();
            prop_assert_eq!(found, expected.values().collect::<Vec<_>>());
        }
    }
}
