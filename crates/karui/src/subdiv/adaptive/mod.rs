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
mod mesh;
mod options;
mod piece;
mod position;
mod ring;
mod select;
mod split;
mod store;
#[cfg(test)]
mod tests;
mod wedge;

pub use mesh::AdaptiveMesh;
pub use options::{AdaptiveOptions, MAX_DEPTH, View};

use super::cage::Cage;
use super::options::{Scheme, SubdivOptions};
use crate::error::{Error, Result};
use draw::Drawing;
use eye::Eye;
use glam::Vec3;
use split::Cut;
use store::Store;

/// A cage that is refined anew for every view, and what is kept in between.
#[derive(Debug, Clone)]
pub struct Adaptive {
    store: Store,
    frame: u32,
    pass: u32,
    offers: Vec<Vec<u32>>,
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
        if !matches!(options.scheme, Scheme::CatmullClark | Scheme::Sqrt2) {
            return Err(options::bad(
                "scheme",
                &format!("{:?}", options.scheme),
                "CatmullClark or Sqrt2, to be adaptive",
            ));
        }
        check(positions, cage.vertices)?;
        Ok(Self {
            store: Store::new(cage, positions, options)?,
            frame: 0,
            pass: 0,
            offers: Vec::new(),
            drawing: Drawing::default(),
        })
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
        if self.kept() > options.max_kept || self.pass > u32::MAX - 2 * MAX_DEPTH {
            self.store.forget();
            (self.frame, self.pass) = (0, 0);
        }
        self.next_frame(options.deepest() as usize);
        let mut cut = Cut {
            store: &mut self.store,
            frame: self.frame,
            spread: options.spread,
            offers: &mut self.offers,
            faces: 0,
        };
        to.truncated = !select::select(&mut cut, &eye, options, &mut self.pass);
        self.drawing
            .draw(&mut self.store, self.frame, options.limit, to);
        Ok(())
    }

    fn next_frame(&mut self, depths: usize) {
        self.frame += 1;
        self.offers.resize_with(depths, Vec::new);
        self.offers.iter_mut().for_each(Vec::clear);
    }
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
