//! What a caller may ask of a simplification, and what it answers.

use super::log::CollapseLog;
use crate::mesh::TriMesh;
use crate::progress::{Progress, Silent};
use std::fmt;

/// Options of [`simplify`](super::simplify). The defaults suit a textured
/// model that is to keep its outline.
#[derive(Clone, Copy)]
pub struct SimplifyOptions<'a> {
    /// How much time to spend for how small an error. Default:
    /// [`Quality::Balanced`].
    pub quality: Quality,
    /// When to stop. Default: never, that is, at the coarsest mesh the
    /// constraints allow.
    pub stop: Stop,
    /// Where the vertex that replaces an edge may lie. Default: [`Placement::Optimal`].
    pub placement: Placement,
    /// What a collapse costs. Default: [`Cost::Memoryless`].
    pub cost: Cost,
    /// What happens to open borders. Default: [`Border::Preserve`].
    pub border: Border,
    /// One weight a vertex, `>= 0`; 1 is neutral, a larger one keeps detail.
    pub weights: Option<&'a [f32]>,
    /// Vertices that neither move nor vanish.
    pub locks: Option<&'a [bool]>,
    /// Influence of each attribute on the cost.
    pub attributes: AttributeWeights,
    /// Largest turn of a triangle's normal in one collapse, radians, below
    /// pi/2. Default: 1.2 (69 degrees).
    pub max_normal_turn: f64,
    /// Preference for even triangles, 0 or more: a way along the surface counts
    /// this much of one off it. 0.1 is mild, 0.5 strong; the error grows.
    /// Default: 0.
    pub regularity: f64,
    /// Join vertices of unconnected parts closer than this, model units
    /// (vertex-pair contraction, Garland & Heckbert 1997); the topology may
    /// change. Default: `None`.
    pub pairs: Option<f64>,
    /// Whether to write down what collapses, for [`Simplified::log`]; turned
    /// triangles are then not mended but by collapses. Default: no.
    pub log: bool,
    /// Whether small parts, holes and handles may go. Default:
    /// [`Topology::Simplify`].
    pub topology: Topology,
    /// Told about the work and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for SimplifyOptions<'_> {
    fn default() -> Self {
        Self {
            quality: Quality::Balanced,
            stop: Stop::default(),
            placement: Placement::Optimal,
            cost: Cost::Memoryless,
            border: Border::Preserve,
            weights: None,
            locks: None,
            attributes: AttributeWeights::default(),
            max_normal_turn: 1.2,
            regularity: 0.0,
            pairs: None,
            log: false,
            topology: Topology::Simplify,
            progress: &Silent,
        }
    }
}

impl fmt::Debug for SimplifyOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SimplifyOptions")
            .field("quality", &self.quality)
            .field("stop", &self.stop)
            .field("placement", &self.placement)
            .field("cost", &self.cost)
            .field("border", &self.border)
            .field("weights", &self.weights.map(<[f32]>::len))
            .field("locks", &self.locks.map(<[bool]>::len))
            .field("attributes", &self.attributes)
            .field("max_normal_turn", &self.max_normal_turn)
            .field("regularity", &self.regularity)
            .field("pairs", &self.pairs)
            .field("log", &self.log)
            .field("topology", &self.topology)
            .finish_non_exhaustive()
    }
}

/// When to stop: whichever of the bounds that are set is met first. None set:
/// at the coarsest mesh the constraints allow.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stop {
    /// At most this many triangles.
    pub triangles: Option<usize>,
    /// At most this share of the input's triangles, `0..=1`.
    pub ratio: Option<f64>,
    /// Before the error passes this, model units.
    pub error: Option<f64>,
    /// Before the error passes this share of the bounding box's diagonal.
    pub relative_error: Option<f64>,
}

impl Stop {
    /// Stop at this share of the input's triangles.
    #[must_use]
    pub fn ratio(ratio: f64) -> Self {
        Self {
            ratio: Some(ratio),
            ..Self::default()
        }
    }

    /// Stop at this many triangles.
    #[must_use]
    pub fn triangles(triangles: usize) -> Self {
        Self {
            triangles: Some(triangles),
            ..Self::default()
        }
    }

    /// Stop before the error passes `error` model units.
    #[must_use]
    pub fn error(error: f64) -> Self {
        Self::default().or_error(error)
    }

    /// Stop before the error passes this share of the diagonal.
    #[must_use]
    pub fn relative_error(error: f64) -> Self {
        Self::default().or_relative_error(error)
    }

    /// Whether the error is bounded, absolutely or relatively.
    #[must_use]
    pub fn bounds_error(&self) -> bool {
        self.error.is_some() || self.relative_error.is_some()
    }

    /// Also stop before the error passes `error` model units.
    #[must_use]
    pub fn or_error(self, error: f64) -> Self {
        Self {
            error: Some(error),
            ..self
        }
    }

    /// Also stop before the error passes this share of the diagonal.
    #[must_use]
    pub fn or_relative_error(self, error: f64) -> Self {
        Self {
            relative_error: Some(error),
            ..self
        }
    }
}

/// How much time to spend for how small an error. Costs other than
/// [`Cost::Memoryless`] and vertex pairs are only had as by [`Quality::Exact`],
/// whatever is asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Quality {
    /// Few rounds of many collapses: fastest. Looks back at the input where a
    /// triangle may have turned over, and mends those that have where an edge
    /// collapse, a swap or a moved corner can.
    Fast,
    /// More rounds; near the target every collapse is checked against the
    /// input, at the end every triangle, and mended likewise.
    #[default]
    Balanced,
    /// Strictly the cheapest collapse next, every price renewed after each,
    /// every triangle checked against the input: the reference.
    Exact,
}

/// Where the vertex that replaces an edge may lie.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Placement {
    /// Where the error is least; else the better of the ends and the middle.
    #[default]
    Optimal,
    /// On one end of the edge (half-edge collapse): the vertices of the result
    /// are a subset of the input's.
    HalfEdge,
}

/// What a collapse costs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Cost {
    /// Squared distance to the planes of the surface as it is now, and the
    /// enclosed volume kept (Lindstrom & Turk 1998). Closest on average.
    #[default]
    Memoryless,
    /// Quadrics summed up since the input (Garland & Heckbert 1997).
    Accumulated,
    /// As `Accumulated`, but a new vertex takes the mean of both quadrics, not
    /// their sum (An 2014, eq. 4.3), so that what many collapses have led to
    /// counts no more than what one has.
    Averaged,
}

/// What happens to open borders.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Border {
    /// Simplified along themselves and held in place by constraint planes.
    #[default]
    Preserve,
    /// Not touched at all.
    Lock,
    /// Nothing holds them but the planes of their triangles.
    Free,
}

/// Whether small parts, holes and handles may go. [`Quality::Exact`] keeps
/// them always, and so does whoever asks for a [log](SimplifyOptions::log).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Topology {
    /// A part may vanish, a hole of three edges be closed and a handle be cut
    /// where it is three edges around, once that costs no more than the
    /// collapses before. The last part stays, and so does what has locked
    /// vertices.
    #[default]
    Simplify,
    /// All stay, with the triangles that they need.
    Preserve,
}

/// How much each kind of attribute counts, as a multiple of the scale that is
/// derived from the mesh; 0 leaves it out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttributeWeights {
    /// Normals.
    pub normal: f64,
    /// All UV sets.
    pub uv: f64,
    /// All colour sets.
    pub color: f64,
    /// Skin weights.
    pub skin: f64,
}

impl Default for AttributeWeights {
    fn default() -> Self {
        Self {
            normal: 1.0,
            uv: 1.0,
            color: 1.0,
            skin: 1.0,
        }
    }
}

impl AttributeWeights {
    /// Geometry alone decides.
    pub const NONE: Self = Self {
        normal: 0.0,
        uv: 0.0,
        color: 0.0,
        skin: 0.0,
    };
}

/// A simplified mesh and how it came about.
#[derive(Debug, Clone)]
pub struct Simplified {
    /// The coarser mesh.
    pub mesh: TriMesh,
    /// Estimate of the distance to the input, model units: the largest root
    /// mean square distance of a new vertex to the planes it replaces. The
    /// true distance is what [`metrics`](crate::metrics) measures.
    pub error: f64,
    /// Why it went no further.
    pub stopped: Stopped,
    /// Edges (and pairs) collapsed.
    pub collapses: usize,
    /// Candidates that were refused, by reason, at the end of the work.
    pub blocked: Blocked,
    /// What collapsed, if it was asked for. `None` all the same where vertices
    /// without an edge were joined ([`SimplifyOptions::pairs`]), and from what
    /// is no edge collapse.
    pub log: Option<CollapseLog>,
    /// How the topology has changed.
    pub topology: TopologyChanges,
}

/// Changes of topology ([`Topology::Simplify`]).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TopologyChanges {
    /// Connected parts that have vanished.
    pub parts: usize,
    /// Holes that have been closed.
    pub holes: usize,
    /// Handles that have been cut.
    pub handles: usize,
}

impl TopologyChanges {
    pub(crate) fn add(&mut self, other: &Self) {
        self.parts += other.parts;
        self.holes += other.holes;
        self.handles += other.handles;
    }
}

/// Why a simplification went no further.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stopped {
    /// The triangle count asked for was reached.
    Target,
    /// The next collapse would have passed the error bound.
    ErrorBound,
    /// Nothing was left to collapse.
    Exhausted,
    /// What was left was mostly held by locks or a locked border.
    Locked,
    /// What was left would have changed the topology.
    Topology,
    /// What was left would have torn or joined attribute seams.
    Seams,
    /// What was left would have turned triangles over.
    Flips,
}

/// Number of candidates refused, by reason.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Blocked {
    /// An end is locked.
    pub locked: usize,
    /// The link condition: the surface would have changed its topology.
    pub topology: usize,
    /// An attribute seam or a material border would have been torn.
    pub seams: usize,
    /// A triangle (or its UVs) would have turned over or degenerated.
    pub flips: usize,
}

impl Blocked {
    /// The most frequent reason, if there was any.
    #[must_use]
    pub fn reason(&self) -> Stopped {
        let counts = [
            (self.locked, Stopped::Locked),
            (self.topology, Stopped::Topology),
            (self.seams, Stopped::Seams),
            (self.flips, Stopped::Flips),
        ];
        let most = counts.iter().map(|c| c.0).max().unwrap_or(0);
        counts
            .into_iter()
            .find(|&(n, _)| n == most && n > 0)
            .map_or(Stopped::Exhausted, |(_, reason)| reason)
    }
}
