//! Refinement where a surface is looked at, without cracks.
//!
//! Miura, Adachi and Ikedo, "√2-subdivision", 2002, chapter 4, after Alliez, Laurent, Sanson
//! and Schmitt, "Efficient view-dependent refinement of 3D meshes using √3-subdivision",
//! 2003. Faces that are seen are split to one depth, those along the silhouette to another,
//! or as far as makes a difference of so many pixels. Only what is chosen is split, and the
//! edge between it and the rest stays: no edge is ever cut, and there is no vertex that only
//! one of two faces knows of.
//!
//! Every vertex is where uniform Catmull-Clark refinement has it, or that goes to in the
//! limit, whatever is around it in the mesh drawn: that is read from a hierarchy (`store`)
//! which grows where something is needed, with as much around it as the masks take in, and
//! is kept from frame to frame. What is drawn depends on the view alone.

mod draw;
mod eye;
mod grow;
mod limit;
mod look;
mod mesh;
mod options;
mod piece;
mod position;
mod ring;
mod select;
mod split;
mod stamp;
mod store;
#[cfg(test)]
mod tests;
mod values;
mod wedge;

pub use mesh::AdaptiveMesh;
pub use options::{AdaptiveOptions, MAX_DEPTH, View};

use super::cage::Cage;
use super::control_mesh::ControlMesh;
use super::level::Level;
use super::options::{Scheme, SubdivOptions};
use crate::error::{Error, Result};
use draw::Drawing;
use eye::Eye;
use glam::Vec3;
use select::{Choice, End};
use split::Cut;
use store::Store;
use values::Skin;

/// A cage that is refined anew for every view, and what is kept in between.
#[derive(Debug, Clone)]
pub struct Adaptive {
    store: Store,
    skin: Skin,
    frame: u32,
    pass: u32,
    offers: Vec<Vec<u32>>,
    /// Whether there were too many faces in the last frame.
    full: bool,
    drawing: Drawing,
}

impl Adaptive {
    /// Takes a cage with a position for every vertex. Of `options`, the scheme has to be
    /// Catmull-Clark or √2; levels and texture coordinates do not matter.
    ///
    /// # Errors
    /// As [`Cage::validate`]; [`Error::BadOption`] for another scheme,
    /// [`Error::LengthMismatch`] or [`Error::NotFinite`] for positions, and
    /// [`Error::NonManifoldEdge`], [`Error::InconsistentEdge`] or [`Error::DegenerateFace`]
    /// where faces do not meet in pairs.
    pub fn new(cage: &Cage, positions: &[Vec3], options: &SubdivOptions) -> Result<Self> {
        Self::of_level(&level(cage, positions, options)?, positions, options)
    }

    fn of_level(level: &Level, positions: &[Vec3], options: &SubdivOptions) -> Result<Self> {
        Ok(Self {
            store: Store::of_level(level, positions, options)?,
            skin: Skin::default(),
            frame: 0,
            pass: 0,
            offers: Vec::new(),
            full: false,
            drawing: Drawing::default(),
        })
    }

    /// Takes a control mesh with all that it carries: texture coordinates, split at seams as
    /// [`subdivide`](super::subdivide) splits them, colours and materials. What the mesh's
    /// rules say goes before `options`.
    ///
    /// # Errors
    /// As [`Adaptive::new`]; [`Error::LengthMismatch`], [`Error::IndexOutOfRange`] or
    /// [`Error::NotFinite`] for values; [`Error::BadOption`] for weights: rational surfaces
    /// are refined uniformly only.
    pub fn of_control(control: &ControlMesh, options: &SubdivOptions) -> Result<Self> {
        if let Some(weights) = &control.weights {
            let found = format!("{} of them", weights.len());
            return Err(options::bad("weights", &found, "none, to be adaptive"));
        }
        let options = control.rules.apply(*options);
        let level = level(&control.cage, &control.positions, &options)?;
        let mut made = Self::of_level(&level, &control.positions, &options)?;
        made.skin = Skin::new(control, &level, &mut made.store, &options)?;
        Ok(made)
    }

    /// Puts the vertices of the cage elsewhere. Connectivity that has been found is kept.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] or [`Error::NotFinite`].
    pub fn move_cage(&mut self, positions: &[Vec3]) -> Result<()> {
        check(positions, self.store.tiers[0].vertices.len())?;
        self.store.move_cage(positions);
        Ok(())
    }

    /// Number of faces kept, of all levels; each is about 480 bytes.
    #[must_use]
    pub fn kept(&self) -> usize {
        self.store.face_count()
    }

    /// The mesh for a view.
    ///
    /// # Errors
    /// As [`Adaptive::refine_into`].
    pub fn refine(&mut self, view: &View, options: &AdaptiveOptions) -> Result<AdaptiveMesh> {
        let mut mesh = AdaptiveMesh::default();
        self.refine_into(view, options, &mut mesh)?;
        Ok(mesh)
    }

    /// As [`Adaptive::refine`], into a mesh whose memory is used again.
    ///
    /// # Errors
    /// [`Error::BadOption`] if a camera, light, depth or number of pixels is out of range.
    pub fn refine_into(
        &mut self,
        view: &View,
        options: &AdaptiveOptions,
        to: &mut AdaptiveMesh,
    ) -> Result<()> {
        options.validate()?;
        let eye = Eye::new(view)?;
        // Numbers of frames and passes last for weeks.
        if self.kept() > options.max_kept || self.pass > u32::MAX - 4 * MAX_DEPTH {
            self.store.forget();
            self.skin.forget();
            self.drawing = Drawing::default();
            (self.frame, self.pass) = (0, 0);
        }
        // What was too much in the last frame is so in the next one as a rule; to be wrong
        // takes time only.
        let mut end = self.select(&eye, options, self.full);
        if end == End::Unclear {
            end = self.select(&eye, options, true);
        }
        self.full = end == End::Full;
        to.truncated = self.full;
        let all = (&mut self.store, &mut self.skin);
        self.drawing.draw(all, self.frame, options.limit, to);
        Ok(())
    }

    fn select(&mut self, eye: &Eye, options: &AdaptiveOptions, in_order: bool) -> End {
        self.frame += 1;
        self.offers
            .resize_with(options.deepest() as usize, Vec::new);
        self.offers.iter_mut().for_each(Vec::clear);
        let cut = Cut {
            frame: self.frame,
            spread: options.spread,
        };
        let choice = Choice {
            cut,
            eye,
            options,
            in_order,
        };
        select::select(&mut self.store, choice, &mut self.offers, &mut self.pass)
    }
}

/// The cage, if it may be adaptive and has so many positions.
fn level(cage: &Cage, positions: &[Vec3], options: &SubdivOptions) -> Result<Level> {
    if !matches!(options.scheme, Scheme::CatmullClark | Scheme::Sqrt2) {
        return Err(options::bad(
            "scheme",
            &format!("{:?}", options.scheme),
            "CatmullClark or Sqrt2, to be adaptive",
        ));
    }
    check(positions, cage.vertices)?;
    Level::of_cage(cage, options)
}

fn check(positions: &[Vec3], vertices: usize) -> Result<()> {
    if positions.len() != vertices {
        return Err(Error::LengthMismatch {
            what: "positions".into(),
            expected: vertices,
            found: positions.len(),
        });
    }
    match positions.iter().position(|p| !p.is_finite()) {
        Some(index) => Err(super::cage::not_finite("position", index)),
        None => Ok(()),
    }
}
