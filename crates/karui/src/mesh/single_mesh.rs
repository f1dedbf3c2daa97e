//! A whole scene as one mesh.

use super::attributes::gathered;
use super::{Attribute, Attributes, MaterialRange, MorphTarget, Scene, SkinWeights, TriMesh};
use crate::error::{Error, Result};
use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};

impl Scene {
    /// Bakes every placed mesh into one, in the order of [`Scene::instances`].
    ///
    /// Positions, normals, tangents and morph differences are taken to world
    /// space; triangles of mirrored instances are turned so that they still
    /// face outwards. An attribute that only some meshes have is filled up for
    /// the others: normals from the faces, white, weight 1 on joint 0, zeros.
    /// Ranges keep their materials; neighbours of one material are joined.
    ///
    /// # Errors
    /// [`Error::TooLarge`] if 32 bits cannot count the vertices or triangles,
    /// [`Error::Unfolds`] if repeated meshes are too many: see
    /// [`Scene::check_unfolded`].
    pub fn into_single_mesh(mut self) -> Result<TriMesh> {
        self.check_unfolded()?;
        let instances = self.mesh_instances();
        if let [(mesh, matrix)] = instances[..]
            && matrix == Mat4::IDENTITY
        {
            return Ok(self.meshes.swap_remove(mesh).mesh);
        }
        let of = |m: usize| &self.meshes[m].mesh;
        let [vertices, triangles] = self.unfolded();
        check("vertices", vertices)?;
        check("triangles", triangles)?;
        let mut whole = TriMesh::default();
        for &(mesh, world_from_mesh) in &instances {
            append(&mut whole, of(mesh).clone().transformed(world_from_mesh));
        }
        if whole.ranges.iter().all(|r| r.material.is_none()) {
            whole.ranges.clear();
        }
        Ok(whole)
    }

    fn mesh_instances(&self) -> Vec<(usize, Mat4)> {
        self.iter_instances()
            .map(|i| (i.mesh as usize, i.world_from_mesh.as_mat4()))
            .filter(|&(mesh, _)| mesh < self.meshes.len())
            .collect()
    }
}

fn check(what: &'static str, found: usize) -> Result<()> {
    let limit = u32::MAX as usize;
    if found > limit {
        return Err(Error::TooLarge { what, found, limit });
    }
    Ok(())
}

impl TriMesh {
    /// This mesh and another that was part of the same one: with the same kinds
    /// of attributes and as many ranges, each of which is joined.
    #[must_use]
    pub(crate) fn with_ranges_of(mut self, mut part: Self) -> Self {
        let order = by_range(&self, &part);
        let [vertices, faces] = [self.positions.len(), self.triangles.len()];
        let lengths = [vertices, part.positions.len()];
        append_attributes(&mut self.attributes, part.attributes, lengths);
        let lengths = [faces, part.triangles.len()];
        append_named(&mut self.face_attributes, part.face_attributes, lengths);
        self.positions.append(&mut part.positions);
        let moved = |t: &[u32; 3]| t.map(|v| v + vertices as u32);
        self.triangles.extend(part.triangles.iter().map(moved));
        let mut first = 0;
        for (range, added) in self.ranges.iter_mut().zip(&part.ranges) {
            range.count += added.count;
            range.first = first;
            first += range.count;
        }
        self.triangles = gathered(&self.triangles, &order);
        for attribute in &mut self.face_attributes {
            *attribute = attribute.gathered(&order);
        }
        self
    }

    /// The mesh in another space: positions, normals, tangents and morph
    /// differences are transformed, and triangles are turned over if the
    /// matrix mirrors, so that they still face outwards. The identity changes
    /// nothing, not even by rounding.
    #[must_use]
    pub fn transformed(mut self, other_from_mesh: Mat4) -> Self {
        if other_from_mesh != Mat4::IDENTITY {
            transform(&mut self, other_from_mesh);
        }
        self
    }
}

/// Triangles of both, those of the second numbered after those of the first,
/// range by range.
fn by_range(one: &TriMesh, other: &TriMesh) -> Vec<u32> {
    let behind = one.triangles.len() as u32;
    if one.ranges.is_empty() {
        return (0..behind + other.triangles.len() as u32).collect();
    }
    let pair = |(a, b): (&MaterialRange, &MaterialRange)| {
        let first = behind + b.first;
        (a.first..a.first + a.count).chain(first..first + b.count)
    };
    one.ranges
        .iter()
        .zip(&other.ranges)
        .flat_map(pair)
        .collect()
}

fn transform(mesh: &mut TriMesh, world_from_mesh: Mat4) {
    let linear = Mat3::from_mat4(world_from_mesh);
    let determinant = linear.determinant();
    let for_normals = normal_matrix(linear);
    for p in &mut mesh.positions {
        *p = world_from_mesh.transform_point3(*p);
    }
    let attributes = &mut mesh.attributes;
    for n in attributes.normals.iter_mut().flatten() {
        *n = (for_normals * *n).normalize_or(*n);
    }
    for t in attributes.tangents.iter_mut().flatten() {
        let direction = (linear * t.truncate()).normalize_or(t.truncate());
        *t = direction.extend(if determinant < 0.0 { -t.w } else { t.w });
    }
    for morph in &mut attributes.morphs {
        transform_morph(morph, linear, for_normals);
    }
    if determinant < 0.0 {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
}

/// Inverse transpose up to a positive factor: the cofactors, with the sign of
/// the determinant, which also exist for a matrix that flattens.
fn normal_matrix(linear: Mat3) -> Mat3 {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let cofactors = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if linear.determinant() < 0.0 {
        -cofactors
    } else {
        cofactors
    }
}

/// Normal differences keep the scale of the normals they are added to, as far
/// as one factor for the whole mesh can.
fn transform_morph(morph: &mut MorphTarget, linear: Mat3, for_normals: Mat3) {
    let scale = for_normals.determinant().abs().cbrt();
    let for_normals = if scale > 0.0 {
        for_normals / scale
    } else {
        for_normals
    };
    let parts = [
        (&mut morph.positions, linear),
        (&mut morph.normals, for_normals),
        (&mut morph.tangents, for_normals),
    ];
    for (part, matrix) in parts {
        part.iter_mut().flatten().for_each(|d| *d = matrix * *d);
    }
}

fn append(whole: &mut TriMesh, mut part: TriMesh) {
    let vertices = whole.positions.len();
    let faces = whole.triangles.len();
    if whole.attributes.normals.is_some() != part.attributes.normals.is_some() && faces > 0 {
        add_normals(whole);
        add_normals(&mut part);
    }
    append_ranges(&mut whole.ranges, faces as u32, &part.ranges_or_whole());
    let lengths = [vertices, part.positions.len()];
    append_attributes(&mut whole.attributes, part.attributes, lengths);
    let lengths = [faces, part.triangles.len()];
    append_named(&mut whole.face_attributes, part.face_attributes, lengths);
    whole.positions.append(&mut part.positions);
    // An index that was out of range stays so.
    let moved = |t: [u32; 3]| t.map(|v| v.saturating_add(vertices as u32));
    whole
        .triangles
        .extend(part.triangles.into_iter().map(moved));
}

fn append_ranges(ranges: &mut Vec<MaterialRange>, offset: u32, added: &[MaterialRange]) {
    for range in added.iter().filter(|r| r.count > 0) {
        match ranges.last_mut() {
            Some(last) if last.material == range.material => last.count += range.count,
            _ => ranges.push(MaterialRange {
                first: offset + range.first,
                source: None,
                ..*range
            }),
        }
    }
}

/// Gives a mesh without normals area-weighted ones.
fn add_normals(mesh: &mut TriMesh) {
    if mesh.attributes.normals.is_some() {
        return;
    }
    let mut sums = vec![glam::DVec3::ZERO; mesh.positions.len()];
    for &t in &mesh.triangles {
        let corners = t.map(|v| mesh.positions.get(v as usize).map(|p| p.as_dvec3()));
        if let [Some(a), Some(b), Some(c)] = corners {
            let normal = crate::geom::normal_times_two_areas([a, b, c]);
            t.iter().for_each(|&v| sums[v as usize] += normal);
        }
    }
    let unit = |n: glam::DVec3| n.as_vec3().normalize_or(Vec3::Z);
    mesh.attributes.normals = Some(sums.into_iter().map(unit).collect());
}

const WHOLE_WEIGHT: SkinWeights = SkinWeights {
    joints: [0; 4],
    weights: [1.0, 0.0, 0.0, 0.0],
};

/// `lengths`: vertices so far and vertices added.
fn append_attributes(to: &mut Attributes, from: Attributes, lengths: [usize; 2]) {
    append_optional(&mut to.normals, from.normals, Vec3::Z, lengths);
    let tangent = Vec4::new(1.0, 0.0, 0.0, 1.0);
    append_optional(&mut to.tangents, from.tangents, tangent, lengths);
    append_sets(&mut to.uvs, from.uvs, |_| Vec2::ZERO, lengths);
    append_sets(&mut to.colors, from.colors, |_| Vec4::ONE, lengths);
    let weight = |set| match set {
        0 => WHOLE_WEIGHT,
        _ => SkinWeights::default(),
    };
    append_sets(&mut to.skins, from.skins, weight, lengths);
    append_morphs(&mut to.morphs, from.morphs, lengths);
    append_named(&mut to.custom, from.custom, lengths);
}

fn append_optional<T: Clone>(
    to: &mut Option<Vec<T>>,
    from: Option<Vec<T>>,
    filler: T,
    [before, added]: [usize; 2],
) {
    if to.is_none() && from.is_none() {
        return;
    }
    let to = to.get_or_insert_default();
    to.resize(before, filler.clone());
    to.extend(from.into_iter().flatten());
    to.resize(before + added, filler);
}

fn append_sets<T: Clone>(
    to: &mut Vec<Vec<T>>,
    from: Vec<Vec<T>>,
    filler: impl Fn(usize) -> T,
    lengths: [usize; 2],
) {
    let sets = to.len().max(from.len());
    to.resize(sets, Vec::new());
    let mut from = from.into_iter();
    for (set, values) in to.iter_mut().enumerate() {
        let mut values_there = Some(std::mem::take(values));
        append_optional(&mut values_there, from.next(), filler(set), lengths);
        *values = values_there.unwrap_or_default();
    }
}

fn append_morphs(to: &mut Vec<MorphTarget>, from: Vec<MorphTarget>, lengths: [usize; 2]) {
    to.resize(to.len().max(from.len()), MorphTarget::default());
    let mut from = from.into_iter();
    for morph in to {
        let added = from.next().unwrap_or_default();
        append_optional(&mut morph.positions, added.positions, Vec3::ZERO, lengths);
        append_optional(&mut morph.normals, added.normals, Vec3::ZERO, lengths);
        append_optional(&mut morph.tangents, added.tangents, Vec3::ZERO, lengths);
    }
}

/// Joins attributes of the same name, width and type; others stay apart.
fn append_named(to: &mut Vec<Attribute>, from: Vec<Attribute>, [before, added]: [usize; 2]) {
    for attribute in from {
        let same = |a: &Attribute| a.empty_like() == attribute.empty_like();
        let at = to.iter().position(same).unwrap_or_else(|| {
            to.push(attribute.empty_like());
            to.len() - 1
        });
        to[at].resize(before);
        to[at].values.append(attribute.values);
    }
    to.iter_mut().for_each(|a| a.resize(before + added));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AttributeValues, NamedMesh, Node, Transform};
    use glam::Quat;

    fn triangle() -> TriMesh {
        TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])
    }

    fn scene(meshes: Vec<TriMesh>, matrices: &[Mat4]) -> Scene {
        let node = |(i, m): (usize, &Mat4)| Node {
            mesh: Some((i % meshes.len()) as u32),
            transform: Transform::Matrix(*m),
            ..Node::default()
        };
        let nodes: Vec<Node> = matrices.iter().enumerate().map(node).collect();
        let named = |mesh| NamedMesh { name: None, mesh };
        Scene {
            roots: (0..nodes.len() as u32).collect(),
            nodes,
            meshes: meshes.into_iter().map(named).collect(),
            ..Scene::default()
        }
    }

    #[test]
    fn one_mesh_in_place_is_returned_unchanged() {
        let mut mesh = triangle();
        mesh.ranges = mesh.ranges_or_whole();
        let whole = Scene::from_mesh(mesh.clone()).into_single_mesh().unwrap();
        assert_eq!(whole, mesh);
    }

    #[test]
    fn instances_are_placed_and_mirrored_ones_turned() {
        let mut mesh = triangle();
        mesh.attributes.normals = Some(vec![Vec3::new(0.0, 0.6, 0.8); 3]);
        mesh.attributes.tangents = Some(vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3]);
        let mirror = Mat4::from_scale(Vec3::new(-1.0, 2.0, 1.0));
        let shift = Mat4::from_translation(Vec3::Z);
        let whole = scene(vec![mesh], &[mirror, shift])
            .into_single_mesh()
            .unwrap();
        assert_eq!(whole.triangles, [[0, 2, 1], [3, 4, 5]]);
        assert_eq!(whole.positions[2], Vec3::new(0.0, 2.0, 0.0));
        assert_eq!(whole.positions[4], Vec3::new(1.0, 0.0, 1.0));
        let expected = Vec3::new(0.0, 0.3, 0.8).normalize();
        let normals = whole.attributes.normals.unwrap();
        assert!((normals[0] - expected).length() < 1e-6, "{}", normals[0]);
        let tangents = whole.attributes.tangents.unwrap();
        assert_eq!(tangents[0], Vec4::new(-1.0, 0.0, 0.0, -1.0));
    }

    #[test]
    fn normals_turn_with_the_surface() {
        let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.3, 1.0, -2.0);
        for scale in [Vec3::new(1.0, 2.0, 0.5), Vec3::new(-3.0, 1.0, 1.0)] {
            let matrix = Mat4::from_scale_rotation_translation(scale, turn, Vec3::ONE);
            let mut mesh = triangle();
            mesh.attributes.normals = Some(vec![Vec3::Z; 3]);
            let whole = scene(vec![mesh], &[matrix]).into_single_mesh().unwrap();
            let face = crate::geom::normal_times_two_areas(whole.corners(0));
            let normal = whole.attributes.normals.unwrap()[0].as_dvec3();
            assert!(face.normalize().dot(normal) > 1.0 - 1e-6);
        }
    }

    #[test]
    fn missing_attributes_are_filled() {
        let named = |values| Attribute {
            name: "q".into(),
            components: 1,
            values,
        };
        let mut rich = triangle();
        rich.attributes.normals = Some(vec![Vec3::Y; 3]);
        rich.attributes.uvs = vec![vec![Vec2::ONE; 3]];
        rich.attributes.colors = vec![vec![Vec4::ZERO; 3]];
        rich.attributes.skins = vec![vec![SkinWeights::default(); 3]];
        rich.attributes.morphs = vec![MorphTarget {
            positions: Some(vec![Vec3::X; 3]),
            ..MorphTarget::default()
        }];
        rich.attributes.custom = vec![named(AttributeValues::U8(vec![1, 2, 3]))];
        rich.face_attributes = vec![named(AttributeValues::F64(vec![0.5]))];
        for order in [[0, 1], [1, 0]] {
            let pair = order.map(|i| if i == 0 { rich.clone() } else { triangle() });
            let whole = scene(pair.to_vec(), &[Mat4::IDENTITY; 2])
                .into_single_mesh()
                .unwrap();
            let a = &whole.attributes;
            assert!(
                a.lengths().iter().all(|(_, l)| *l == 6),
                "{:?}",
                a.lengths()
            );
            let plain = 3 - 3 * order[0];
            assert_eq!(a.normals.as_ref().unwrap()[plain], Vec3::Z);
            assert_eq!(a.normals.as_ref().unwrap()[3 - plain], Vec3::Y);
            assert_eq!(a.colors[0][plain], Vec4::ONE);
            assert_eq!(a.skins[0][plain], WHOLE_WEIGHT);
            let AttributeValues::U8(q) = &a.custom[0].values else {
                panic!("type changed");
            };
            assert_eq!(q[plain..plain + 3], [0; 3]);
            assert_eq!(q[3 - plain..6 - plain], [1, 2, 3]);
            assert_eq!(whole.face_attributes[0].elements(), 2);
        }
    }

    #[test]
    fn ranges_of_one_material_are_joined() {
        let with = |material| {
            let mut mesh = triangle();
            mesh.ranges = mesh.ranges_or_whole();
            mesh.ranges[0].material = material;
            mesh
        };
        let meshes = vec![with(Some(1)), with(Some(1)), with(None)];
        let whole = scene(meshes, &[Mat4::IDENTITY; 3])
            .into_single_mesh()
            .unwrap();
        let ranges: Vec<_> = whole.ranges.iter().map(|r| (r.first, r.count)).collect();
        assert_eq!(ranges, [(0, 2), (2, 1)]);
    }
}
