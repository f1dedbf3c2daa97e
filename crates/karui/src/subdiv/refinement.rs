//! A cage refined: connectivity once, values as often as wanted.

use super::cage::{Cage, not_finite};
use super::face_varying::Charts;
use super::level::{Faces, Level};
use super::limit::Limits;
use super::options::{FaceVaryingRule, Scheme, SubdivOptions};
use super::patches::{Memory, Patches};
use super::split::Kind;
use super::sqrt2::Odd;
use super::{masks, size, sqrt3};
use crate::error::{Error, Result};
use crate::progress::{Progress, Silent, step};

/// Connectivity of a refined cage, and how its values follow from the cage's.
#[derive(Debug, Clone)]
pub struct Refinement {
    options: SubdivOptions,
    kind: Kind,
    stages: Vec<Stage>,
    /// The value that each vertex of the first level has; none if each has its own.
    sources: Option<Vec<u32>>,
    /// Values a cage has.
    inputs: usize,
    faces: Faces,
    corners: Vec<u32>,
    vertices: usize,
    holes: Vec<bool>,
    base: Level,
}

/// One step, or several at once.
#[derive(Debug, Clone)]
enum Stage {
    /// The level that is divided, and the vertices this makes.
    Split(Level, usize),
    Patches(Patches),
    Odd(Level, Odd),
    Sqrt3(sqrt3::Step),
}

/// Memory of [`Refinement::evaluate_into`], for the next call.
#[derive(Debug, Clone, Default)]
pub struct Workspace<const N: usize> {
    values: [Vec<[f32; N]>; 2],
    memory: Memory<N>,
}

impl Refinement {
    /// Refines the connectivity of `cage`.
    ///
    /// # Errors
    /// As [`Cage::validate`]; [`Error::TooFine`] if there would be more faces than
    /// `options.max_faces`; [`Error::BadOption`] if the scheme is for triangles and not all
    /// faces are, or is √3 and there are creases or holes.
    pub fn new(cage: &Cage, options: &SubdivOptions) -> Result<Self> {
        Self::with_progress(cage, options, &Silent)
    }

    /// [`Refinement::new`], reporting to `progress`.
    ///
    /// # Errors
    /// As [`Refinement::new`], and [`Error::Cancelled`].
    pub fn with_progress(
        cage: &Cage,
        options: &SubdivOptions,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let base = Level::of_cage(cage, options)?;
        check_scheme(cage, &base, options.scheme)?;
        size::check(&base, options)?;
        let kind = Kind {
            triangles: options.scheme == Scheme::Loop,
            linear: options.scheme == Scheme::Bilinear,
        };
        Self::of_level(base, kind, options, progress)
    }

    /// The refinement of values that differ from face to face at one vertex, such as texture
    /// coordinates: `indices` names one of `count` values for every corner of the cage. Its
    /// faces are those of this refinement, in the same order.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] or [`Error::IndexOutOfRange`] for the indices,
    /// [`Error::BadOption`] under √2 with an odd number of steps or √3, whose faces cross
    /// edges.
    pub fn face_varying(&self, indices: &[u32], count: usize) -> Result<Self> {
        let scheme = self.options.scheme;
        let crosses =
            scheme == Scheme::Sqrt3 || (scheme == Scheme::Sqrt2 && self.options.levels % 2 == 1);
        if crosses && self.options.levels > 0 {
            return Err(Error::BadOption {
                option: "scheme",
                found: format!("{scheme:?} with {} levels", self.options.levels),
                expected: "one whose faces lie within those of the cage",
            });
        }
        let charts = Charts::new(&self.base, indices, count, &self.options)?;
        let mut kind = self.kind;
        kind.linear |= self.options.face_varying == FaceVaryingRule::All;
        let mut fine = Self::of_level(charts.level, kind, &self.options, &Silent)?;
        fine.sources = Some(charts.value);
        fine.inputs = count;
        Ok(fine)
    }

    fn of_level(
        base: Level,
        kind: Kind,
        options: &SubdivOptions,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let mut fine = Self {
            options: *options,
            kind,
            stages: Vec::new(),
            sources: None,
            inputs: base.vertices,
            faces: base.faces.clone(),
            corners: Vec::new(),
            vertices: base.vertices,
            holes: base.holes.clone(),
            base,
        };
        match options.scheme {
            Scheme::Sqrt3 => fine.refine_sqrt3(progress)?,
            Scheme::Sqrt2 => {
                let last = fine.refine(options.levels / 2, options.levels % 2 == 1, progress)?;
                if let Some(last) = last {
                    fine.refine_odd(last);
                }
            }
            _ => {
                fine.refine(options.levels, false, progress)?;
            }
        }
        Ok(fine)
    }

    /// Divides faces `levels` times; the last level itself only if it is `wanted`.
    fn refine(
        &mut self,
        levels: u32,
        wanted: bool,
        progress: &dyn Progress,
    ) -> Result<Option<Level>> {
        let mut level = self.base.clone();
        for done in 0..levels {
            step(progress, "refine", done as f32 / levels as f32)?;
            let left = levels - done;
            if !self.kind.triangles && !self.kind.linear && !wanted && Patches::can_start(&level) {
                self.holes = repeated(&level.holes, 1 << (2 * left));
                let patches = Patches::new(level, left);
                self.vertices = patches.vertex_count();
                self.corners = patches.corners();
                self.faces = Faces::Uniform {
                    size: 4,
                    count: self.corners.len() as u32 / 4,
                };
                self.stages.push(Stage::Patches(patches));
                return Ok(None);
            }
            let next = level.refined(self.kind, left > 1 || wanted);
            self.stages.push(Stage::Split(level, next.vertices));
            level = next;
        }
        self.vertices = level.vertices;
        self.faces = level.faces.clone();
        self.holes = level.holes.clone();
        if wanted {
            return Ok(Some(level));
        }
        self.corners = level.corners;
        Ok(None)
    }

    fn refine_odd(&mut self, level: Level) {
        let odd = Odd::new(&level);
        self.vertices = odd.vertices;
        self.faces = odd.faces.clone();
        self.corners.clone_from(&odd.corners);
        // A face across an edge is left out if both faces of that edge are.
        let holes = !level.holes.is_empty();
        let is_hole = |&e: &u32| {
            let corners = level.edge_corners(e).iter();
            corners
                .into_iter()
                .all(|&c| level.is_hole(level.faces.of_corner(c) as usize))
        };
        self.holes = if holes {
            odd.carried.iter().map(is_hole).collect()
        } else {
            Vec::new()
        };
        self.stages.push(Stage::Odd(level, odd));
    }

    fn refine_sqrt3(&mut self, progress: &dyn Progress) -> Result<()> {
        let mut level = self.base.clone();
        for done in 0..self.options.levels {
            step(progress, "refine", done as f32 / self.options.levels as f32)?;
            let stage = sqrt3::Step::new(level, done);
            level = stage.next_level(&self.options)?;
            self.stages.push(Stage::Sqrt3(stage));
        }
        (self.vertices, self.faces) = (level.vertices, level.faces);
        (self.corners, self.holes) = (level.corners, Vec::new());
        Ok(())
    }

    /// Number of vertices after the last step.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// The faces after the last step, as ranges of corners.
    #[must_use]
    pub fn faces(&self) -> &Faces {
        &self.faces
    }

    /// Vertex of every corner after the last step. The vertices of the cage come first.
    #[must_use]
    pub fn corners(&self) -> &[u32] {
        if self.stages.is_empty() {
            &self.base.corners
        } else {
            &self.corners
        }
    }

    /// Whether face `f` is left out of the surface.
    #[must_use]
    pub fn is_hole(&self, f: usize) -> bool {
        self.holes.get(f).copied().unwrap_or(false)
    }

    /// Whether face `f` is a quad across a crease, from its first corner to its third.
    pub(super) fn is_folded(&self, f: usize) -> bool {
        match self.stages.last() {
            Some(Stage::Odd(level, odd)) => {
                self.faces.corners(f).len() == 4 && level.edge_sharpness(odd.carried[f]) > 0.0
            }
            _ => false,
        }
    }

    /// The face of the cage that every face lies in; one of two if it lies across an edge.
    #[must_use]
    pub fn parents(&self) -> Vec<u32> {
        let mut parents: Vec<u32> = (0..self.faces.count() as u32).collect();
        for stage in self.stages.iter().rev() {
            let before = stage.parents(self.kind);
            parents.iter_mut().for_each(|f| *f = before(*f));
        }
        parents
    }

    /// The cage as the refinement sees it: boundaries are sharp.
    #[must_use]
    pub fn base(&self) -> &Level {
        &self.base
    }

    /// The options it was made with.
    #[must_use]
    pub fn options(&self) -> &SubdivOptions {
        &self.options
    }

    /// Values after the last step from those of the cage: positions, homogeneous positions,
    /// colours, or whatever else `N` numbers are.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] if there is not one value a vertex; [`Error::NotFinite`].
    pub fn evaluate<const N: usize>(&self, values: &[[f32; N]]) -> Result<Vec<[f32; N]>> {
        let mut to = Vec::new();
        self.evaluate_into(values, &mut Workspace::default(), &mut to)?;
        Ok(to)
    }

    /// [`Refinement::evaluate`] into memory that is used again, e.g. for every frame of an
    /// animated cage.
    ///
    /// # Errors
    /// As [`Refinement::evaluate`].
    pub fn evaluate_into<const N: usize>(
        &self,
        values: &[[f32; N]],
        workspace: &mut Workspace<N>,
        to: &mut Vec<[f32; N]>,
    ) -> Result<()> {
        self.check_values(values)?;
        let Workspace {
            values: [from, next],
            memory,
        } = workspace;
        from.clear();
        self.gather(values, from);
        let Some((last, first)) = self.stages.split_last() else {
            to.clone_from(from);
            return Ok(());
        };
        for stage in first {
            resize(next, stage.vertices());
            stage.evaluate(self.kind, from, next, memory);
            std::mem::swap(from, next);
        }
        resize(to, last.vertices());
        last.evaluate(self.kind, from, to, memory);
        to.truncate(self.vertices);
        Ok(())
    }

    /// The values of the first level's vertices.
    fn gather<const N: usize>(&self, values: &[[f32; N]], to: &mut Vec<[f32; N]>) {
        match &self.sources {
            Some(sources) => to.extend(sources.iter().map(|&i| values[i as usize])),
            None => to.extend_from_slice(values),
        }
    }

    fn check_values<const N: usize>(&self, values: &[[f32; N]]) -> Result<()> {
        if values.len() != self.inputs {
            return Err(Error::LengthMismatch {
                what: "values of the cage".into(),
                expected: self.inputs,
                found: values.len(),
            });
        }
        let bad = values.iter().position(|v| !v.iter().all(|c| c.is_finite()));
        bad.map_or(Ok(()), |index| Err(not_finite("value of the cage", index)))
    }

    /// The surface at all vertices after the last step, or of [`Refinement::face_varying`] the
    /// values there as the first numbers of `positions`. This builds what [`Refinement`] else
    /// does without, some 150 bytes a face.
    ///
    /// # Errors
    /// As [`Refinement::evaluate`]; [`Error::BadOption`] under √3.
    pub fn limits(&self, positions: &[[f32; 3]]) -> Result<Limits> {
        self.check_values(positions)?;
        let scheme = self.options.scheme;
        if scheme == Scheme::Sqrt3 {
            return Err(Error::BadOption {
                option: "scheme",
                found: "Sqrt3".into(),
                expected: "another one: its limits are not known here",
            });
        }
        let mut levels = self.options.levels;
        if scheme == Scheme::Sqrt2 {
            levels = levels.div_ceil(2);
        }
        // Masks are for the faces that the scheme makes, which a cage need not have.
        levels += u32::from(
            levels == 0
                && !self
                    .base
                    .is_uniform(if self.kind.triangles { 3 } else { 4 }),
        );
        let mut level = self.base.clone();
        let mut values = Vec::new();
        self.gather(positions, &mut values);
        for _ in 0..levels {
            let next = level.refined(self.kind, true);
            let mut to = vec![[0.0; 3]; next.vertices];
            masks::step(&level, self.kind, &values, &mut to);
            (level, values) = (next, to);
        }
        let mut limits = level.limits(self.kind, &values);
        limits.positions.truncate(self.vertices);
        limits.tangents.truncate(self.vertices);
        limits.normals.truncate(self.vertices);
        limits.one_sided.truncate(self.vertices);
        Ok(limits)
    }
}

impl Stage {
    fn vertices(&self) -> usize {
        match self {
            Self::Split(_, vertices) => *vertices,
            Self::Patches(patches) => patches.vertex_count(),
            Self::Odd(level, odd) => odd.vertices + level.edges.len(),
            Self::Sqrt3(step) => step.vertex_count(),
        }
    }

    /// From a face to the one that it was made of.
    fn parents(&self, kind: Kind) -> Box<dyn Fn(u32) -> u32 + '_> {
        match self {
            Self::Split(..) if kind.triangles => Box::new(|f| f / 4),
            Self::Split(level, _) => Box::new(|f| level.faces.of_corner(f)),
            Self::Patches(patches) => {
                let depth = patches.depth();
                Box::new(move |f| f >> (2 * depth))
            }
            Self::Odd(level, odd) => Box::new(|f| {
                let edge = odd.carried[f as usize];
                level.faces.of_corner(level.edge_corners(edge)[0])
            }),
            Self::Sqrt3(step) => {
                let parents = step.parents();
                Box::new(move |f| parents[f as usize])
            }
        }
    }

    fn evaluate<const N: usize>(
        &self,
        kind: Kind,
        from: &[[f32; N]],
        to: &mut [[f32; N]],
        memory: &mut Memory<N>,
    ) {
        match self {
            Self::Split(level, _) => masks::step(level, kind, from, to),
            Self::Odd(level, _) => masks::step(level, Kind::CATMULL_CLARK, from, to),
            Self::Patches(patches) => patches.evaluate(from, to, memory),
            Self::Sqrt3(step) => step.evaluate(from, to),
        }
    }
}

/// Memory that is new comes from the system as zeros: then the threads that fill it are the
/// first to touch it, rather than this one.
fn resize<const N: usize>(values: &mut Vec<[f32; N]>, count: usize) {
    if values.capacity() < count {
        *values = vec![[0.0; N]; count];
    }
    values.resize(count, [0.0; N]);
}

fn repeated(holes: &[bool], times: usize) -> Vec<bool> {
    holes
        .iter()
        .flat_map(|&hole| std::iter::repeat_n(hole, times))
        .collect()
}

fn check_scheme(cage: &Cage, base: &Level, scheme: Scheme) -> Result<()> {
    let refuse = |found: &str, expected| {
        Err(Error::BadOption {
            option: "scheme",
            found: format!("{scheme:?} {found}"),
            expected,
        })
    };
    let for_triangles = matches!(scheme, Scheme::Loop | Scheme::Sqrt3);
    if for_triangles && !base.is_uniform(3) {
        return refuse("for faces of more than 3 corners", "one for any faces");
    }
    if scheme == Scheme::Sqrt3 && !(cage.creases.is_empty() && cage.holes.is_empty()) {
        return refuse("for a cage with creases or holes", "one that knows them");
    }
    Ok(())
}
