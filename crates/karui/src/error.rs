//! The errors of the geometry library, with the numbers in them.

/// What can go wrong in an operation on geometry that is already in memory.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A triangle or polygon names a vertex that does not exist.
    #[error("face {face} uses vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the face.
        face: usize,
        /// The offending vertex index.
        index: u32,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// A per-element array has the wrong length.
    #[error("{what} has {found} entries, expected {expected}")]
    LengthMismatch {
        /// The array, e.g. `normals`.
        what: String,
        /// Entries needed.
        expected: usize,
        /// Entries there.
        found: usize,
    },
    /// A coordinate or attribute is NaN or infinite.
    #[error("{what} {index} is not finite")]
    NotFinite {
        /// The array, e.g. `position`.
        what: String,
        /// Index of the entry.
        index: usize,
    },
    /// Material ranges do not tile the triangle list.
    #[error("material range {range} covers triangles {first}..{end} of {triangles}")]
    BadRange {
        /// Index of the range.
        range: usize,
        /// First triangle.
        first: usize,
        /// One past the last triangle.
        end: usize,
        /// Number of triangles of the mesh.
        triangles: usize,
    },
    /// A scene element refers to one that does not exist, or nodes form a cycle.
    #[error("{what} {index} refers to {target} {to}, which {problem}")]
    BadReference {
        /// Kind of the element that refers, e.g. `node`.
        what: &'static str,
        /// Its index.
        index: usize,
        /// Kind of the element referred to.
        target: &'static str,
        /// Its index.
        to: usize,
        /// E.g. `does not exist` or `is its own ancestor`.
        problem: &'static str,
    },
    /// A face names a vertex twice or has fewer than three corners.
    #[error("face {face} is degenerate: it has fewer than three different corners")]
    DegenerateFace {
        /// Index of the face.
        face: usize,
    },
    /// More than two faces meet in an edge.
    #[error("{faces} faces meet in the edge between vertices {a} and {b}, more than two")]
    NonManifoldEdge {
        /// One end.
        a: u32,
        /// The other end.
        b: u32,
        /// Number of faces that meet.
        faces: usize,
    },
    /// Two faces run through their common edge in the same direction.
    #[error(
        "faces {first} and {second} have opposite orientation at the edge from vertex {a} to {b}"
    )]
    InconsistentEdge {
        /// Where both faces enter the edge.
        a: u32,
        /// Where both faces leave it.
        b: u32,
        /// One face.
        first: usize,
        /// The other face.
        second: usize,
    },
    /// The faces around a vertex form more than one fan.
    #[error("the faces around vertex {vertex} form more than one fan")]
    NonManifoldVertex {
        /// The vertex.
        vertex: u32,
    },
    /// An invariant of a data structure does not hold.
    #[error("broken invariant at {index}: {rule}")]
    Broken {
        /// The rule that does not hold.
        rule: &'static str,
        /// Index of the element where it does not.
        index: usize,
    },
    /// An option lies outside its documented range.
    #[error("option `{option}` is {found}; it must be {expected}")]
    BadOption {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        found: String,
        /// What would be accepted.
        expected: &'static str,
    },
    /// The input holds nothing to work on.
    #[error("{what} is empty")]
    Empty {
        /// What is empty, e.g. `mesh`.
        what: &'static str,
    },
    /// Two pictures to be compared are of different size.
    #[error(
        "a picture of {}x{} pixels has no counterpart of its size, but one of {}x{}",
        first[0], first[1], second[0], second[1]
    )]
    SizeMismatch {
        /// Width and height of one, in pixels.
        first: [u32; 2],
        /// Width and height of the other.
        second: [u32; 2],
    },
    /// More elements than 32-bit indices can name.
    #[error("{found} {what} are more than the {limit} that 32-bit indices can name")]
    TooLarge {
        /// E.g. `vertices`.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Largest number accepted.
        limit: usize,
    },
    /// Repeated meshes would become too many elements if each instance had a
    /// copy of its own.
    #[error("all instances together have {found} {what}, more than the {limit} that may be copied")]
    Unfolds {
        /// E.g. `vertices`.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Largest number accepted.
        limit: usize,
    },
    /// A mesh is not the one that a collapse log or a cluster DAG is of: not of its
    /// connectivity.
    #[error("this is of another mesh: its {what} differs")]
    OtherMesh {
        /// What differs, e.g. `number of vertices`.
        what: &'static str,
    },
    /// A collapse log that was read does not hold together.
    #[error("collapse log, {at}: {problem}")]
    BadLog {
        /// Byte, or number of the collapse or triangle.
        at: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// Bytes that are no hierarchy.
    #[error("hierarchy, byte {at}: {problem}")]
    BadHierarchy {
        /// Number of the byte.
        at: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// A cluster DAG that was read does not hold together.
    #[error("cluster DAG, {at}: {problem}")]
    BadClusters {
        /// Byte, or number of the cluster or group.
        at: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// Subdivision would make more than was allowed.
    #[error(
        "{levels} levels make {faces} faces, more than the {limit} allowed",
        faces = rounded(*faces)
    )]
    TooFine {
        /// Levels asked for.
        levels: u32,
        /// Faces there would be, exact up to 2^53.
        faces: f64,
        /// Most that is allowed.
        limit: u64,
    },
    /// The [`Progress`](crate::Progress) observer asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// All digits, or three if there are too many to read.
fn rounded(count: f64) -> String {
    if count < 1e15 {
        format!("{count}")
    } else if count < 1e300 {
        format!("{count:.2e}")
    } else {
        "over 1e300".into()
    }
}

/// Shorthand for results of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;
