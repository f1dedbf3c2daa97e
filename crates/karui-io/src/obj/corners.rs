//! From corners that name position, texture coordinate and normal each by its
//! own index, to vertices that have all three.

use karui::{
    PolyMesh,
    geom::{DVec3, Vec2, Vec3, Vec4, normal_times_two_areas},
    mesh::Attributes,
    subdiv::{Cage, ControlMesh, FaceVarying},
};

/// No index.
pub(super) const NONE: u32 = u32::MAX;

/// Corners of all faces.
pub(super) struct Corners {
    positions: Vec<u32>,
    /// Empty, or as long as `positions`; [`NONE`] where a corner has none.
    uvs: Vec<u32>,
    normals: Vec<u32>,
    offsets: Vec<u32>,
    /// Empty until a face has a material.
    materials: Vec<Option<u32>>,
}

impl Default for Corners {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            offsets: vec![0],
            materials: Vec::new(),
        }
    }
}

impl Corners {
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    #[inline]
    pub fn push(&mut self, [position, uv, normal]: [u32; 3]) {
        push_sparse(&mut self.uvs, uv, self.positions.len());
        push_sparse(&mut self.normals, normal, self.positions.len());
        self.positions.push(position);
    }

    pub fn truncate(&mut self, len: usize) {
        self.positions.truncate(len);
        self.uvs.truncate(len);
        self.normals.truncate(len);
    }

    /// Ends a face with the corners since the last one. There must be fewer
    /// than 2^32 corners.
    pub fn end_face(&mut self, material: Option<u32>) {
        let face = self.offsets.len() - 1;
        if material.is_some() || !self.materials.is_empty() {
            self.materials.resize(face, None);
            self.materials.push(material);
        }
        self.offsets.push(self.positions.len() as u32);
    }

    /// One vertex for each set of indices in use, ordered by them. Without
    /// texture coordinates and normals the vertices are the positions, used or
    /// not.
    pub fn into_mesh(
        mut self,
        positions: Vec<Vec3>,
        uvs: Vec<Vec2>,
        normals: Vec<Vec3>,
        colors: Option<Vec<Vec4>>,
    ) -> PolyMesh {
        let mut mesh = PolyMesh {
            offsets: std::mem::take(&mut self.offsets),
            face_materials: std::mem::take(&mut self.materials),
            ..PolyMesh::default()
        };
        let simple = self.uvs.is_empty() && self.normals.is_empty();
        if simple {
            mesh.indices = self.positions;
            mesh.positions = positions;
            mesh.attributes.colors.extend(colors);
            return mesh;
        }
        let (indices, vertices) = self.join(positions.len());
        let at = |v: &[u32; 3]| v[0] as usize;
        mesh.positions = vertices.iter().map(|v| positions[at(v)]).collect();
        mesh.indices = indices;
        mesh.attributes = Attributes {
            uvs: gather(&uvs, &vertices, 1, Vec2::ZERO).into_iter().collect(),
            normals: gather(&normals, &vertices, 2, Vec3::ZERO),
            ..Attributes::default()
        };
        let color = |c: Vec<Vec4>| vertices.iter().map(|v| c[at(v)]).collect();
        mesh.attributes.colors.extend(colors.map(color));
        fill_normals(&mut mesh, &vertices);
        mesh
    }

    /// One vertex for every position, texture coordinates by corner. `weights` may be fewer
    /// than `positions`: the rest are 1.
    pub fn into_control(
        self,
        positions: Vec<Vec3>,
        mut weights: Vec<f32>,
        mut uvs: Vec<Vec2>,
        colors: Option<Vec<Vec4>>,
    ) -> ControlMesh {
        let mut indices = self.uvs;
        let has_uvs = indices.iter().any(|&i| i != NONE);
        indices.resize(self.positions.len(), NONE);
        if has_uvs && indices.contains(&NONE) {
            uvs.push(Vec2::ZERO);
            let filler = uvs.len() as u32 - 1;
            let without = indices.iter_mut().filter(|i| **i == NONE);
            without.for_each(|i| *i = filler);
        }
        if !weights.is_empty() {
            weights.resize(positions.len(), 1.0);
        }
        ControlMesh {
            cage: Cage {
                vertices: positions.len(),
                offsets: self.offsets,
                indices: self.positions,
                ..Cage::default()
            },
            weights: (!weights.is_empty()).then_some(weights),
            positions,
            colors,
            uvs: has_uvs.then_some(FaceVarying {
                values: uvs,
                indices,
            }),
            face_materials: self.materials,
            ..ControlMesh::default()
        }
    }

    /// The vertex of every corner and the indices of every vertex.
    ///
    /// Corners are put into one bucket a position and sorted there, which
    /// takes no hashing and no more than n log n whatever the file holds.
    fn join(&self, positions: usize) -> (Vec<u32>, Vec<[u32; 3]>) {
        let (starts, mut order) = self.by_position(positions);
        let index = |of: &[u32], corner: u32| of.get(corner as usize).copied().unwrap_or(NONE);
        let rest = |c: u32| (index(&self.uvs, c), index(&self.normals, c));
        let mut vertex_of = vec![0; order.len()];
        let mut vertices = Vec::new();
        for (position, range) in starts.windows(2).enumerate() {
            let bucket = &mut order[range[0] as usize..range[1] as usize];
            bucket.sort_unstable_by_key(|&c| rest(c));
            let mut last = None;
            for &corner in &*bucket {
                let key = rest(corner);
                if last != Some(key) {
                    vertices.push([position as u32, key.0, key.1]);
                    last = Some(key);
                }
                vertex_of[corner as usize] = vertices.len() as u32 - 1;
            }
        }
        (vertex_of, vertices)
    }

    /// Corners sorted by position: where each position's start, and all.
    fn by_position(&self, positions: usize) -> (Vec<u32>, Vec<u32>) {
        let mut starts = vec![0u32; positions + 1];
        for &p in &self.positions {
            starts[p as usize + 1] += 1;
        }
        for p in 0..positions {
            starts[p + 1] += starts[p];
        }
        let mut slots = starts.clone();
        let mut order = vec![0; self.positions.len()];
        for (corner, &p) in self.positions.iter().enumerate() {
            let slot = &mut slots[p as usize];
            order[*slot as usize] = corner as u32;
            *slot += 1;
        }
        (starts, order)
    }
}

#[inline]
fn push_sparse(indices: &mut Vec<u32>, index: u32, corners: usize) {
    if index != NONE || !indices.is_empty() {
        indices.resize(corners, NONE);
        indices.push(index);
    }
}

/// Part `part` of every vertex; `None` if no vertex has it.
fn gather<T: Copy>(values: &[T], vertices: &[[u32; 3]], part: usize, filler: T) -> Option<Vec<T>> {
    if vertices.iter().all(|v| v[part] == NONE) {
        return None;
    }
    let value = |v: &[u32; 3]| values.get(v[part] as usize).copied().unwrap_or(filler);
    Some(vertices.iter().map(value).collect())
}

/// Gives vertices whose corners name no normal the average of their faces'.
fn fill_normals(mesh: &mut PolyMesh, vertices: &[[u32; 3]]) {
    let Some(mut normals) = mesh.attributes.normals.take() else {
        return;
    };
    if vertices.iter().any(|v| v[2] == NONE) {
        let mut sums = vec![DVec3::ZERO; vertices.len()];
        for face in mesh.faces() {
            let corner = |v: u32| mesh.positions[v as usize].as_dvec3();
            let fan = face.windows(2).map(|w| [face[0], w[0], w[1]]);
            let normal: DVec3 = fan.map(|t| normal_times_two_areas(t.map(corner))).sum();
            face.iter().for_each(|&v| sums[v as usize] += normal);
        }
        for ((normal, sum), vertex) in normals.iter_mut().zip(sums).zip(vertices) {
            if vertex[2] == NONE {
                *normal = sum.normalize_or(DVec3::Z).as_vec3();
            }
        }
    }
    mesh.attributes.normals = Some(normals);
}
