//! Members, and the one surface they make together.

use super::join::join;
use super::look::Look;
use crate::error::{Error, Result};
use crate::geom::{Aabb, DMat4, DVec3};
use crate::mesh::{Material, TriMesh};
use crate::spatial::Bvh;
use std::sync::OnceLock;

/// An object, or the stand-in of a group within the group.
#[derive(Debug, Clone, Copy)]
pub struct Member<'a> {
    /// Its surface: of an object, its coarsest level of detail.
    pub mesh: &'a TriMesh,
    /// Where it stands; affine.
    pub world_from_mesh: DMat4,
    /// What it is made of.
    pub look: &'a Look<'a>,
    /// Which objects it is.
    pub objects: Objects,
    /// Largest distance between `mesh` and the original surface, world units.
    pub error: f64,
}

/// Which objects a mesh is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objects {
    /// All of it is this one.
    One(u32),
    /// Its vertices tell, by their attribute [`FEATURE_ID`](super::FEATURE_ID); it
    /// shows [`NO_OBJECT`](super::NO_OBJECT) if there is none.
    OfVertices,
}

/// The members of a group as one surface, around an origin of its own.
#[derive(Debug, Clone)]
pub struct Group<'a> {
    /// Middle of the members' box.
    pub(super) origin: DVec3,
    /// One range for every slot.
    pub(super) mesh: TriMesh,
    pub(super) slots: Vec<Slot<'a>>,
    /// Largest of the members' errors.
    pub(super) error: f64,
    /// Triangles of all members.
    pub(super) offered: usize,
    /// Over its triangles, once it is needed.
    pub(super) tree: OnceLock<Bvh>,
}

/// A material in use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot<'a> {
    pub look: &'a Look<'a>,
    pub material: Option<u32>,
    /// UV sets that the meshes have; textures that need more are done without.
    pub uv_sets: usize,
}

impl Slot<'_> {
    pub(super) fn material(&self) -> Option<&Material> {
        self.look.materials.get(self.material? as usize)
    }

    pub(super) fn is_same(&self, other: &Self) -> bool {
        let same_look = std::ptr::eq(self.look, other.look);
        same_look && (self.material, self.uv_sets) == (other.material, other.uv_sets)
    }
}

impl<'a> Group<'a> {
    /// Places all members. Triangles of mirrored members are turned so that they
    /// still face outwards; of attributes, normals, UVs and the first set of colours
    /// are kept.
    ///
    /// A group without members or triangles is none to stand in for, but no error.
    ///
    /// # Errors
    /// What [`TriMesh::validate`] finds; [`Error::NotFinite`] for a matrix or where it
    /// takes a vertex; [`Error::BadOption`] for an error that is negative or not
    /// finite; [`Error::BadReference`] for a material that does not exist;
    /// [`Error::TooLarge`] if 32 bits cannot count the vertices or triangles.
    pub fn new(members: &[Member<'a>]) -> Result<Self> {
        for (index, member) in members.iter().enumerate() {
            check(index, member)?;
        }
        join(members)
    }

    pub(super) fn of(origin: DVec3, mesh: TriMesh, slots: Vec<Slot<'a>>) -> Self {
        Self {
            origin,
            mesh,
            slots,
            error: 0.0,
            offered: 0,
            tree: OnceLock::new(),
        }
    }

    /// The group without some of its triangles.
    pub(super) fn without(&self, gone: &[bool]) -> Self {
        let mut mesh = self.mesh.clone();
        mesh.retain_triangles(|t| !gone[t]);
        mesh.remove_unreferenced_vertices();
        Self {
            error: self.error,
            offered: self.offered,
            ..Self::of(self.origin, mesh, self.slots.clone())
        }
    }

    /// To find what is near or in the way.
    pub(super) fn tree(&self) -> Result<&Bvh> {
        if self.tree.get().is_none() {
            // Whoever comes second has built the same.
            let _ = self.tree.set(Bvh::build_quick(&self.mesh)?);
        }
        self.tree.get().ok_or(Error::Empty { what: "group" })
    }

    /// Middle of the members' box in the world.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Box around all triangles, relative to [`Group::origin`].
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.mesh.bounds()
    }

    /// Triangles of all members together.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.offered
    }

    /// Whether there is no triangle with an extent.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bounds().diagonal() <= 0.0
    }
}

fn check(index: usize, member: &Member<'_>) -> Result<()> {
    if !member.world_from_mesh.is_finite() {
        let what = "matrix of member".into();
        return Err(Error::NotFinite { what, index });
    }
    if !(member.error.is_finite() && member.error >= 0.0) {
        return Err(Error::BadOption {
            option: "member.error",
            found: member.error.to_string(),
            expected: "0 or more, and finite",
        });
    }
    member.mesh.validate()?;
    let materials = member.look.materials.len();
    for (range, to) in (0..).zip(member.mesh.ranges.iter().map(|r| r.material)) {
        match to {
            Some(to) if materials > 0 && to as usize >= materials => {
                return Err(Error::BadReference {
                    what: "range",
                    index: range,
                    target: "material",
                    to: to as usize,
                    problem: "does not exist",
                });
            }
            _ => {}
        }
    }
    Ok(())
}
