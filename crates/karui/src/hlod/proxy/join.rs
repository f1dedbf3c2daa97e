//! From members to one mesh.

use super::group::{Group, Member, Objects, Slot};
use super::proxy::{FEATURE_ID, NO_OBJECT};
use crate::error::{Error, Result};
use crate::geom::{DMat3, DVec3, Vec2, Vec3, Vec4};
use crate::mesh::{
    Attribute, AttributeValues, Attributes, MaterialRange, NormalWeight, PositionIds, TriMesh,
    vertex_normals,
};

/// Triangles of one member that share a slot.
struct Piece {
    slot: usize,
    member: usize,
    range: MaterialRange,
}

/// Members are valid.
pub(super) fn join<'a>(members: &[Member<'a>]) -> Result<Group<'a>> {
    let placed = placed(members)?;
    let origin = middle(members, &placed);
    let (slots, pieces) = pieces(members);
    let mut whole = Whole::new(members, &slots)?;
    for piece in &pieces {
        let member = &members[piece.member];
        let normals = whole.normals_of(member)?;
        whole.append(piece, member, &placed[piece.member], origin, normals);
    }
    let positions = &whole.mesh.positions;
    if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
        let what = "placed position".into();
        return Err(Error::NotFinite { what, index });
    }
    Ok(Group {
        error: members.iter().map(|m| m.error).fold(0.0, f64::max),
        offered: members.iter().map(|m| m.mesh.triangles.len()).sum(),
        ..Group::of(origin, whole.finished(), slots)
    })
}

/// Vertices in the world.
fn placed(members: &[Member<'_>]) -> Result<Vec<Vec<DVec3>>> {
    let place = |(index, member): (usize, &Member<'_>)| {
        let at = |p: &Vec3| member.world_from_mesh.transform_point3(p.as_dvec3());
        let placed: Vec<DVec3> = member.mesh.positions.iter().map(at).collect();
        match placed.iter().all(|p| p.is_finite()) {
            true => Ok(placed),
            false => Err(Error::NotFinite {
                what: "placed member".into(),
                index,
            }),
        }
    };
    members.iter().enumerate().map(place).collect()
}

/// Middle of the box around all triangles.
fn middle(members: &[Member<'_>], placed: &[Vec<DVec3>]) -> DVec3 {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (member, placed) in members.iter().zip(placed) {
        for &v in member.mesh.triangles.iter().flatten() {
            (min, max) = (min.min(placed[v as usize]), max.max(placed[v as usize]));
        }
    }
    let middle = min * 0.5 + max * 0.5;
    if middle.is_finite() {
        middle
    } else {
        DVec3::ZERO
    }
}

/// All materials in use by first appearance, and pieces in their order.
fn pieces<'a>(members: &[Member<'a>]) -> (Vec<Slot<'a>>, Vec<Piece>) {
    let (mut slots, mut pieces): (Vec<Slot<'a>>, Vec<Piece>) = Default::default();
    for (m, member) in members.iter().enumerate() {
        let ranges = member.mesh.ranges_or_whole();
        for range in ranges.into_iter().filter(|r| r.count > 0) {
            let known = !member.look.materials.is_empty();
            let slot = Slot {
                look: member.look,
                material: range.material.filter(|_| known),
                uv_sets: member.mesh.attributes.uvs.len(),
            };
            let at = slots.iter().position(|s| s.is_same(&slot));
            pieces.push(Piece {
                slot: at.unwrap_or(slots.len()),
                member: m,
                range,
            });
            if at.is_none() {
                slots.push(slot);
            }
        }
    }
    pieces.sort_by_key(|piece| piece.slot);
    (slots, pieces)
}

/// The mesh as it grows.
struct Whole {
    mesh: TriMesh,
    ids: Vec<u32>,
    with_normals: bool,
    /// For the member at hand: vertex of the whole, and the piece that took it.
    taken: Vec<(u32, u32)>,
    piece: u32,
}

impl Whole {
    fn new(members: &[Member<'_>], slots: &[Slot<'_>]) -> Result<Self> {
        let used = members.iter().filter(|m| !m.mesh.triangles.is_empty());
        let total = |len: fn(&Member<'_>) -> usize| used.clone().map(len).sum::<usize>();
        let corners = total(|m| 3 * m.mesh.triangles.len());
        if corners > u32::MAX as usize {
            return Err(Error::TooLarge {
                what: "corners",
                found: corners,
                limit: u32::MAX as usize,
            });
        }
        let most = used.clone().map(|m| m.mesh.positions.len()).max();
        let uv_sets = slots.iter().map(|s| s.uv_sets).max().unwrap_or(0);
        let with_colors = used.clone().any(|m| !m.mesh.attributes.colors.is_empty());
        let with_normals = used.clone().any(|m| m.mesh.attributes.normals.is_some());
        let range = |slot| MaterialRange {
            material: Some(slot),
            ..MaterialRange::default()
        };
        let mesh = TriMesh {
            attributes: Attributes {
                normals: with_normals.then(Vec::new),
                uvs: vec![Vec::new(); uv_sets],
                colors: vec![Vec::new(); usize::from(with_colors)],
                ..Attributes::default()
            },
            ranges: (0..slots.len() as u32).map(range).collect(),
            ..TriMesh::default()
        };
        Ok(Self {
            mesh,
            ids: Vec::new(),
            with_normals,
            taken: vec![(0, 0); most.unwrap_or(0)],
            piece: 0,
        })
    }

    /// Normals for a member that has none, if others have.
    fn normals_of(&self, member: &Member<'_>) -> Result<Option<Vec<Vec3>>> {
        if !self.with_normals || member.mesh.attributes.normals.is_some() {
            return Ok(None);
        }
        let ids = PositionIds::of_mesh(member.mesh);
        vertex_normals(member.mesh, &ids, NormalWeight::Area).map(Some)
    }

    fn append(
        &mut self,
        piece: &Piece,
        member: &Member<'_>,
        placed: &[DVec3],
        origin: DVec3,
        normals: Option<Vec<Vec3>>,
    ) {
        let linear = DMat3::from_mat4(member.world_from_mesh);
        let mirrored = linear.determinant() < 0.0;
        let source = &member.mesh.attributes;
        let normals = normals.as_deref().or(source.normals.as_deref());
        let turned = normals.map(|n| (n, normal_matrix(linear)));
        let vertices = Vertices {
            placed,
            origin,
            source,
            turned,
            objects: member.objects,
        };
        self.piece += 1;
        for triangle in &member.mesh.triangles[piece.range.triangles()] {
            let mut triangle = triangle.map(|v| self.vertex(v, &vertices));
            if mirrored {
                triangle.swap(1, 2);
            }
            self.mesh.triangles.push(triangle);
        }
        let end = self.mesh.triangles.len() as u32;
        let range = &mut self.mesh.ranges[piece.slot];
        if range.count == 0 {
            range.first = end - piece.range.count;
        }
        range.count += piece.range.count;
    }

    fn vertex(&mut self, v: u32, from: &Vertices<'_>) -> u32 {
        let (known, piece) = self.taken[v as usize];
        if piece == self.piece {
            return known;
        }
        let new = self.mesh.positions.len() as u32;
        self.taken[v as usize] = (new, self.piece);
        self.push(v as usize, from);
        new
    }

    fn push(&mut self, v: usize, from: &Vertices<'_>) {
        let attributes = &mut self.mesh.attributes;
        let place = from.placed[v] - from.origin;
        self.mesh.positions.push(place.as_vec3());
        if let Some(normals) = &mut attributes.normals {
            normals.push(from.normal(v));
        }
        for (set, uvs) in attributes.uvs.iter_mut().enumerate() {
            uvs.push(from.source.uvs.get(set).map_or(Vec2::ZERO, |uvs| uvs[v]));
        }
        for colors in &mut attributes.colors {
            let color = from.source.colors.first().map_or(Vec4::ONE, |c| c[v]);
            colors.push(color);
        }
        self.ids.push(from.id(v));
    }

    fn finished(mut self) -> TriMesh {
        self.mesh.attributes.custom = vec![ids(self.ids)];
        self.mesh
    }
}

/// The attribute that tells objects apart.
/// Makes all of a mesh one object, of the first material.
pub(super) fn make_one(mesh: &mut TriMesh, object: u32) {
    mesh.attributes.custom = vec![ids(vec![object; mesh.positions.len()])];
    mesh.ranges = vec![MaterialRange {
        count: mesh.triangles.len() as u32,
        material: Some(0),
        ..MaterialRange::default()
    }];
}

pub(super) fn ids(ids: Vec<u32>) -> Attribute {
    Attribute {
        name: FEATURE_ID.into(),
        components: 1,
        values: AttributeValues::U32(ids),
    }
}

/// Ids of a mesh's vertices, if it has them.
pub(super) fn ids_of(attributes: &Attributes) -> Option<&[u32]> {
    let named = |a: &&Attribute| a.name == FEATURE_ID && a.components == 1;
    match &attributes.custom.iter().find(named)?.values {
        AttributeValues::U32(ids) => Some(ids),
        _ => None,
    }
}

/// Where a member's vertices come from.
struct Vertices<'m> {
    placed: &'m [DVec3],
    origin: DVec3,
    source: &'m Attributes,
    turned: Option<(&'m [Vec3], DMat3)>,
    objects: Objects,
}

impl Vertices<'_> {
    fn normal(&self, v: usize) -> Vec3 {
        let Some((normals, matrix)) = &self.turned else {
            return Vec3::Z;
        };
        let turned = (*matrix * normals[v].as_dvec3()).try_normalize();
        turned.map_or(normals[v], |n| n.as_vec3())
    }

    fn id(&self, v: usize) -> u32 {
        match self.objects {
            Objects::One(id) => id,
            Objects::OfVertices => ids_of(self.source).map_or(NO_OBJECT, |ids| ids[v]),
        }
    }
}

/// Inverse transpose up to a positive factor, which also exists for a matrix that
/// flattens.
fn normal_matrix(linear: DMat3) -> DMat3 {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if linear.determinant() < 0.0 {
        -cofactors
    } else {
        cofactors
    }
}
