//! A log played again.

use super::CollapseLog;
use super::base::{Base, NONE};
use crate::error::{Error, Result};
use crate::mesh::{Attributes, TriMesh};
use crate::simplify::blend::blend;
use crate::simplify::fast::{output, scale_of};
use crate::simplify::options::{Stop, Stopped};
use crate::simplify::rounds::{Level, Repeat, Values};
use crate::simplify::wedges::Normals;
use crate::simplify::{check_stop, target};
use crate::spatial::Bvh;

/// A log on its way from the input to the result, on a mesh of its
/// connectivity. Goes forward only.
///
/// # Examples
/// ```
/// use karui::{mesh::shapes, simplify::{SimplifyOptions, Stop, simplify}};
///
/// let torus = shapes::torus(1.0, 0.4, 64, 32);
/// let options = SimplifyOptions { log: true, stop: Stop::triangles(100), ..Default::default() };
/// let log = simplify(&torus, &options)?.log.ok_or(karui::Error::Empty { what: "log" })?;
/// let mut replay = log.replay(&torus)?;
/// for triangles in [2000, 1000, 500] {
///     replay.advance(&Stop::triangles(triangles))?;
///     assert_eq!(replay.level()?.mesh.triangles.len(), triangles);
/// }
/// # Ok::<(), karui::Error>(())
/// ```
pub struct Replay<'a> {
    log: &'a CollapseLog,
    mesh: &'a TriMesh,
    /// None for a mesh without triangles.
    repeat: Option<Repeat<'a>>,
    /// Of all wedges, and how many there are.
    attributes: (Attributes, usize),
    /// Where normals are looked up, if they are.
    index: Option<Bvh>,
    /// Whether places are found anew.
    anew: bool,
    scale: f32,
    done: usize,
    stopped: Stopped,
}

/// A level that a log was played to.
#[derive(Debug, Clone)]
pub struct Replayed {
    /// The level.
    pub mesh: TriMesh,
    /// For every vertex of the mesh played on the vertex of the level that it
    /// has become part of; see [`CollapseLog::map`].
    pub map: Vec<Option<u32>>,
    /// Estimate of the distance to the mesh played on, as
    /// [`Simplified::error`](super::super::Simplified::error).
    pub error: f64,
    /// [`Stopped::Target`], [`Stopped::ErrorBound`], or
    /// [`Stopped::Exhausted`] at the end of the log.
    pub stopped: Stopped,
    /// Collapses played.
    pub collapses: usize,
}

impl<'a> Replay<'a> {
    pub(super) fn new(log: &'a CollapseLog, mesh: &'a TriMesh) -> Result<Self> {
        mesh.validate()?;
        let base = &*log.base;
        let anew = !base.check(mesh)?;
        let scale = scale_of(mesh);
        let level = level_of(base, mesh, scale)?;
        let (attributes, wedges) = match &base.wedge {
            None => Default::default(),
            Some(ids) => {
                let vertices = ids.first_vertices(mesh, &base.source);
                (mesh.attributes.gathered(&vertices), vertices.len())
            }
        };
        let looks_up = base.normals == Normals::LookedUp && !mesh.triangles.is_empty();
        Ok(Self {
            log,
            mesh,
            repeat: Repeat::new(level, wedges),
            attributes: (attributes, wedges),
            index: looks_up.then(|| Bvh::build(mesh)).transpose()?,
            anew,
            scale,
            done: 0,
            stopped: Stopped::Target,
        })
    }

    /// Goes on until `stop` is met or the log ends; says which. Shares are of
    /// the triangles of the mesh, a bound on the error is one on
    /// [`Replayed::error`].
    ///
    /// # Errors
    /// [`Error::BadOption`] for a stop out of range, [`Error::BadLog`] for a
    /// log that was read and does not hold together.
    pub fn advance(&mut self, stop: &Stop) -> Result<Stopped> {
        check_stop(stop)?;
        let target = target(self.mesh, stop);
        let most = (target.error * f64::from(self.scale)) as f32;
        let Some(repeat) = &mut self.repeat else {
            return Ok(self.stopped);
        };
        self.stopped = Stopped::Target;
        while repeat.alive() > target.triangles {
            let Some(collapse) = self.log.collapses().get(self.done) else {
                self.stopped = Stopped::Exhausted;
                break;
            };
            let at = self.done;
            let took = repeat.take(collapse, self.anew, most);
            if !took.map_err(|problem| Error::BadLog { at, problem })? {
                self.stopped = Stopped::ErrorBound;
                break;
            }
            self.done += 1;
        }
        for change in repeat.blends() {
            blend(&mut self.attributes.0, change.wedge, &change.mix);
        }
        Ok(self.stopped)
    }

    /// The level reached.
    ///
    /// # Errors
    /// [`Error::BadLog`] for a log that was read and does not hold together.
    pub fn level(&mut self) -> Result<Replayed> {
        let level = self.repeat.as_mut().map(Repeat::level).unwrap_or_default();
        let (attributes, wedges) = &self.attributes;
        let surroundings = (self.log.base.normals, self.index.as_ref(), self.scale);
        let mesh = output(self.mesh, &level, (attributes, *wedges), surroundings);
        let error = self.repeat.as_ref().map_or(0.0, Repeat::error);
        mesh.validate().map_err(|_| Error::BadLog {
            at: self.done,
            problem: "it leads to a mesh that is not valid",
        })?;
        Ok(Replayed {
            map: self.map(&level),
            mesh,
            error: f64::from(error / self.scale),
            stopped: self.stopped,
            collapses: self.done,
        })
    }

    /// Vertices of the level are its wedges, or points if there are none, in
    /// order.
    fn map(&self, level: &Level) -> Vec<Option<u32>> {
        let base = &*self.log.base;
        let Some(repeat) = &self.repeat else {
            return vec![None; self.mesh.positions.len()];
        };
        let mut point_heir = repeat.point_heir.clone();
        let mut wedge_heir = repeat.wedge_heir.clone();
        let mut index = vec![NONE; point_heir.len().max(wedge_heir.len())];
        let mut at_point = vec![NONE; point_heir.len()];
        for (t, points) in level.triangle.iter().enumerate() {
            for (k, &p) in points.iter().enumerate() {
                let point = level.origin[p as usize];
                let wedge = level.wedge.get(t).map_or(point, |wedges| wedges[k]);
                index[wedge as usize] = 0;
                let first = &mut at_point[point as usize];
                *first = wedge.min(*first);
            }
        }
        let mut count = 0..;
        let used = index.iter_mut().filter(|i| **i == 0);
        used.zip(&mut count).for_each(|(i, new)| *i = new);
        let known = |id: u32| index.get(id as usize).copied().filter(|&i| i != NONE);
        let mut heir = |v: u32| {
            let point = heir_of(base.point.of_vertex(v), &mut point_heir)?;
            let wedge = match &base.wedge {
                None => point,
                Some(ids) => heir_of(ids.of_vertex(v), &mut wedge_heir)?,
            };
            // A wedge may lose its last triangle where its point does not.
            known(wedge).or_else(|| known(at_point[point as usize]))
        };
        (0..base.vertices).map(&mut heir).collect()
    }
}

/// The last in the line of heirs; none for an id that there is not. Shortens
/// the line on the way.
fn heir_of(mut id: u32, heir: &mut [u32]) -> Option<u32> {
    let mut next = *heir.get(id as usize)?;
    while next != NONE {
        let after = heir[next as usize];
        if after != NONE {
            heir[id as usize] = after;
        }
        (id, next) = (next, after);
    }
    Some(id)
}

fn level_of<'a>(base: &Base, mesh: &'a TriMesh, scale: f32) -> Result<Level<'a>> {
    let triangle = base.point.triangles(mesh, &base.source);
    let is_whole = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a && a.max(b).max(c) != NONE;
    if let Some(at) = triangle.iter().position(|t| !is_whole(t)) {
        let problem = "a triangle does not have three points";
        return Err(Error::BadLog { at, problem });
    }
    let first = base.point.first_vertices(mesh, &base.source);
    let mut level = Level {
        position: first.iter().map(|&v| mesh.positions[v as usize]).collect(),
        scale,
        triangle,
        source: base.source.clone(),
        values: Values::default(),
        ..Level::default()
    };
    if let Some(ids) = &base.wedge {
        level.wedge = ids.triangles(mesh, &base.source).into_owned();
        if let Some(at) = level.wedge.iter().position(|t| t.contains(&NONE)) {
            let problem = "a corner has no wedge";
            return Err(Error::BadLog { at, problem });
        }
        let range_of = mesh.range_of_triangles();
        let count = 0..level.triangle.len() as u32;
        level.range = count
            .map(|t| range_of[level.source_of(t) as usize])
            .collect();
    }
    Ok(level)
}
