//! The input's surface, indexed when it is needed.

use super::block::Rules;
use super::level::Level;
use super::repair::{Guard, repair};
use super::suspects::suspects_against;
use crate::error::Result;
use crate::mesh::TriMesh;
use crate::spatial::{Bvh, Facings};
use std::sync::OnceLock;

/// Triangles up to which there is an index where none is asked for: it takes
/// more memory than all else.
const INDEXED: usize = 1 << 22;

/// What simplified triangles are compared with.
pub(crate) struct Input<'a> {
    mesh: &'a TriMesh,
    scale: f32,
    /// Whether collapses near the target are checked, and all triangles at the
    /// end rather than suspects alone.
    careful: bool,
    index: OnceLock<(Bvh, Facings)>,
}

impl<'a> Input<'a> {
    /// A mesh, of which a model unit is `scale` scaled ones.
    pub fn new(mesh: &'a TriMesh, scale: f32, careful: bool) -> Self {
        Self {
            mesh,
            scale,
            careful,
            index: OnceLock::new(),
        }
    }

    /// The index over the mesh, made if there is none; none if there are no
    /// triangles.
    ///
    /// # Errors
    /// As [`Bvh::build_quick`].
    pub fn index(&self) -> Result<Option<&Bvh>> {
        if self.mesh.triangles.is_empty() {
            return Ok(None);
        }
        self.both().map(|both| Some(&both.0))
    }

    /// The index over the mesh, made if there is none.
    fn both(&self) -> Result<&(Bvh, Facings)> {
        if let Some(both) = self.index.get() {
            return Ok(both);
        }
        let index = Bvh::build_quick(self.mesh)?;
        let facings = Facings::of(&index);
        Ok(self.index.get_or_init(|| (index, facings)))
    }

    /// What all collapses near the target are to be checked against, if they
    /// are.
    ///
    /// # Errors
    /// As [`Bvh::build_quick`].
    pub fn guard(&self) -> Result<Option<Guard<'_>>> {
        match self.careful && !self.mesh.triangles.is_empty() {
            true => self.guard_of(true).map(Some),
            false => Ok(None),
        }
    }

    /// What single triangles may be checked against; none if making it would
    /// take too much memory.
    ///
    /// # Errors
    /// As [`Bvh::build_quick`].
    pub fn guard_if_asked(&self) -> Result<Option<Guard<'_>>> {
        let there = self.index.get().is_some();
        match there || self.mesh.triangles.len() <= INDEXED {
            true => self.guard_of(false).map(Some),
            false => Ok(None),
        }
    }

    fn guard_of(&self, all: bool) -> Result<Guard<'_>> {
        let (index, facings) = self.both()?;
        Ok(Guard {
            index,
            facings,
            scale: self.scale,
            all,
        })
    }

    /// A level without the triangles that oppose the mesh, as far as there are
    /// cures.
    ///
    /// # Errors
    /// As [`Bvh::build_quick`].
    pub fn repaired<'l>(&self, level: Level<'l>, rules: Rules) -> Result<Level<'l>> {
        let bad = match self.index.get() {
            Some(_) => self.guard_of(true)?.all_against(&level),
            None => suspects_against(&level, self.mesh, self.scale)?,
        };
        Ok(match bad.is_empty() {
            true => level,
            false => match self.guard_if_asked()? {
                Some(guard) => repair(level, rules, guard, &bad),
                None => level,
            },
        })
    }
}
