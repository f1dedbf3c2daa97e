//! What to do with a cage: scheme, depth and rules.

/// How a mesh is refined.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Scheme {
    /// Every n-gon into n quads (Catmull and Clark, "Recursively generated B-spline
    /// surfaces on arbitrary topological meshes", 1978).
    #[default]
    CatmullClark,
    /// Catmull-Clark in two steps, each doubling the faces (Miura, Adachi and Ikedo,
    /// "√2-subdivision", 2002).
    Sqrt2,
    /// Every triangle into three, edges turned (Kobbelt, "√3-subdivision", 2000).
    Sqrt3,
    /// Every triangle into four (Loop, "Smooth subdivision surfaces based on triangles",
    /// 1987).
    Loop,
    /// As Catmull-Clark, but nothing moves: new vertices are means.
    Bilinear,
}

/// What happens where the surface ends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Boundary {
    /// The surface ends where the faces around it are complete: faces at a boundary that
    /// is not sharp by a tag are left out of the result.
    None,
    /// Boundaries become smooth curves, corners round.
    EdgeOnly,
    /// Boundaries become smooth curves, vertices of only one face stay where they are.
    #[default]
    EdgeAndCorner,
}

/// How the sharpness of a crease decays from level to level.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CreaseMethod {
    /// By 1 a level (DeRose, Kass and Truong, "Subdivision surfaces in character
    /// animation", 1998).
    #[default]
    Uniform,
    /// By 1 a level after smoothing along the crease: three quarters of its own, a quarter
    /// of the mean of the others at the vertex.
    Chaikin,
}

/// Weights of edge points beside triangles in Catmull-Clark.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum TriangleRule {
    /// As everywhere else.
    #[default]
    CatmullClark,
    /// Heavier face points, for smoother surfaces over triangles.
    Smooth,
}

/// Where texture coordinates are interpolated linearly rather than smoothly; the names are
/// OpenSubdiv's.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FaceVaryingRule {
    /// Smooth everywhere, corners of charts as well.
    None,
    /// Corners of charts stay.
    CornersOnly,
    /// Also where more than two charts meet, and where a crease or another chart's bow tie
    /// sharpens one of two.
    #[default]
    CornersPlus1,
    /// Also both sides if one is a corner, and where a seam ends inside.
    CornersPlus2,
    /// Boundaries of charts stay as straight as they are.
    Boundaries,
    /// Everywhere.
    All,
}

/// Options of [`Refinement`](super::Refinement).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubdivOptions {
    /// The scheme. Default Catmull-Clark.
    pub scheme: Scheme,
    /// Number of steps; 0 leaves the cage as it is. Default 2.
    pub levels: u32,
    /// What happens at boundaries. Default [`Boundary::EdgeAndCorner`].
    pub boundary: Boundary,
    /// How creases decay. Default [`CreaseMethod::Uniform`].
    pub creases: CreaseMethod,
    /// Edge points beside triangles. Default [`TriangleRule::CatmullClark`].
    pub triangles: TriangleRule,
    /// How texture coordinates are refined. Default [`FaceVaryingRule::CornersPlus1`].
    pub face_varying: FaceVaryingRule,
    /// Refuse to make more faces than this. Default 2^28, which is 8 GB of positions and
    /// indices.
    pub max_faces: u64,
}

impl Default for SubdivOptions {
    fn default() -> Self {
        Self {
            scheme: Scheme::default(),
            levels: 2,
            boundary: Boundary::default(),
            creases: CreaseMethod::default(),
            triangles: TriangleRule::default(),
            face_varying: FaceVaryingRule::default(),
            max_faces: 1 << 28,
        }
    }
}
