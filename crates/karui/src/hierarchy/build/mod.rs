//! From a mesh to a hierarchy: one half-edge collapse after the other, the
//! cheapest vertex first.

mod lanes;
mod points;
mod prepare;
mod price;
mod queue;
mod record;

use super::options::HierarchyOptions;
use super::surface::NONE;
use super::{Hierarchy, MeshHash, options::BuildCounts};
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::progress::step;
use points::Points;
use price::{Offer, Ring};
use queue::{Price, Queue};
use rayon::prelude::*;
use record::Record;

/// Collapses between two reports of progress.
const STRIDE: usize = 4096;

impl Hierarchy {
    /// Prepares `mesh` for refinement frame by frame: collapses half-edges, the
    /// cheapest vertex first, down to one in [`HierarchyOptions::alpha`] vertices
    /// or until none is left that can go without a change of topology.
    ///
    /// The cost of a half-edge is `Q w`: `Q` the sum of squared distances of the
    /// vertex kept to the planes of the vertex removed, accumulated, by the root
    /// of its faces less two; `w` the flatness of the faces that change. What
    /// lies on a border or seam moves along it only and pays for leaving its
    /// line. Sequential but for the first prices, so that the result is the same
    /// for any number of threads.
    ///
    /// What is not manifold is cut open first, and held there:
    /// [`Hierarchy::counts`].
    ///
    /// # Errors
    /// What [`TriMesh::validate`] finds, [`Error::BadOption`] for an `alpha`
    /// below 1, [`Error::LengthMismatch`] and [`Error::NotFinite`] for weights or
    /// locks, [`Error::Cancelled`].
    ///
    /// Source: Miyamura and Imai, view- and lighting-dependent simplification on
    /// half-edge hierarchies; R. Pajarola, FastMesh, 2001.
    pub fn build(mesh: &TriMesh, options: &HierarchyOptions<'_>) -> Result<Self> {
        mesh.validate()?;
        check(mesh, options)?;
        step(options.progress, "connect", 0.0)?;
        let points = Points::new(mesh, options)?;
        let mut finest = Self {
            vertices: mesh.positions.len(),
            surface: points.drawn(),
            triangle_of_face: points.triangle_of_face.clone(),
            nodes: Vec::new(),
            dependents: Vec::new(),
            bounds: mesh.bounds(),
            mesh: MeshHash::of(mesh),
            counts: BuildCounts::default(),
        };
        step(options.progress, "price", 0.0)?;
        let mut builder = Builder::new(points);
        builder.run(options)?;
        finest.counts = builder.points.counts;
        finest.counts.coarsest = builder.faces_left();
        (finest.nodes, finest.dependents) = builder.record.finish();
        Ok(finest)
    }
}

fn check(mesh: &TriMesh, options: &HierarchyOptions<'_>) -> Result<()> {
    if options.alpha.is_nan() || options.alpha < 1.0 {
        return Err(Error::BadOption {
            option: "alpha",
            found: options.alpha.to_string(),
            expected: "at least 1",
        });
    }
    let expected = mesh.positions.len();
    let lengths = [
        ("weights", options.weights.map(<[f32]>::len)),
        ("locks", options.locks.map(<[bool]>::len)),
    ];
    for (what, found) in lengths {
        if let Some(found) = found.filter(|&found| found != expected) {
            let what = what.into();
            return Err(Error::LengthMismatch {
                what,
                expected,
                found,
            });
        }
    }
    let bad = |w: &f32| !w.is_finite() || *w < 0.0;
    match options.weights.and_then(|w| w.iter().position(bad)) {
        Some(index) => Err(Error::NotFinite {
            what: "weight".into(),
            index,
        }),
        None => Ok(()),
    }
}

struct Builder {
    points: Points,
    ring: Ring,
    queue: Queue,
    /// The half-edge by which every point would go.
    choice: Vec<u32>,
    record: Record,
    touched: Vec<u32>,
}

impl Builder {
    fn new(points: Points) -> Self {
        let count = points.points.len();
        let offer = |ring: &mut Ring, p: u32| ring.offer(&points, p);
        let offers: Vec<Option<Offer>> = (0..count as u32)
            .into_par_iter()
            .with_min_len(4096)
            .map_init(|| Ring::new(count), offer)
            .collect();
        let prices: Vec<Option<Price>> = offers.iter().map(|o| o.map(|o| o.price)).collect();
        Self {
            ring: Ring::new(count),
            queue: Queue::new(&prices),
            choice: offers
                .iter()
                .map(|o| o.map_or(NONE, |o| o.half_edge))
                .collect(),
            record: Record::new(count, points.range.len()),
            touched: Vec::new(),
            points,
        }
    }

    fn run(&mut self, options: &HierarchyOptions<'_>) -> Result<()> {
        let used = self
            .points
            .points
            .iter()
            .filter(|p| p.corner != NONE)
            .count();
        let goal = used - (used as f64 / options.alpha).ceil() as usize;
        let mut collapsed = 0;
        while collapsed < goal {
            let Some(point) = self.queue.pop() else {
                break;
            };
            if self.try_collapse(point) {
                collapsed += 1;
            }
            if collapsed.is_multiple_of(STRIDE) {
                step(options.progress, "collapse", collapsed as f32 / goal as f32)?;
            }
        }
        Ok(())
    }

    fn faces_left(&self) -> usize {
        self.points.range.len() - self.record.faces_hidden
    }

    /// Collapses the point's half-edge, unless that is not allowed any more: then
    /// it gets another price.
    fn try_collapse(&mut self, point: u32) -> bool {
        let half_edge = self.choice[point as usize];
        if !self.ring.allows(&self.points, point, half_edge) {
            let offer = self.ring.allowed_offer(&self.points, point);
            self.enter(point, offer);
            return false;
        }
        self.record.add(&self.points, &self.ring, point, half_edge);
        // The points whose faces change; the one kept is among them.
        self.touched.clear();
        self.touched.extend_from_slice(self.ring.neighbors());
        self.points.collapse(point, half_edge);
        for i in 0..self.touched.len() {
            self.price(self.touched[i]);
        }
        true
    }

    fn price(&mut self, point: u32) {
        let offer = self.ring.offer(&self.points, point);
        self.enter(point, offer);
    }

    fn enter(&mut self, point: u32, offer: Option<Offer>) {
        self.choice[point as usize] = offer.map_or(NONE, |o| o.half_edge);
        self.queue.set(point, offer.map(|o| o.price));
    }
}
