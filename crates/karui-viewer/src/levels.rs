//! The levels of a model, as they are sent.

use axum::body::Bytes;
use karui::lod::{SceneChain, Seen, to_msft_lod};
use karui::{Scene, TriMesh};
use karui_io::{Error, GltfOptions, glb_bytes};
use serde::Serialize;

/// The levels of a model.
#[derive(Debug)]
pub struct LevelSet {
    /// What made them; `None` if there is the original alone.
    pub chain: Option<SceneChain>,
    /// The original first.
    pub rows: Vec<Row>,
    glbs: Vec<Bytes>,
}

/// A level in numbers. Lengths are in model units.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    level: usize,
    /// Triangles, each mesh counted once.
    triangles: usize,
    vertices: usize,
    /// As a GLB of its own.
    bytes: usize,
    /// Measured between the surfaces, both ways.
    error: Errors,
    /// Distance of the eye beyond which no error is larger than the tolerance.
    switch_distance: f64,
    /// Mean FLIP there, if pictures decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    flip: Option<f64>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Errors {
    max: f64,
    mean: f64,
    rms: f64,
}

impl LevelSet {
    /// The original alone.
    pub fn of_original(scene: &Scene) -> Result<Self, Error> {
        let glb = glb(scene)?;
        let vertices = scene.meshes.iter().map(|m| m.mesh.positions.len()).sum();
        let errors = [0.0; 3];
        let row = row(0, [scene.triangle_count(), vertices], glb.len(), errors);
        Ok(Self {
            chain: None,
            rows: vec![row],
            glbs: vec![glb],
        })
    }

    /// The original and the levels of a chain; what pictures said about each if they
    /// decided.
    pub fn of_chain(
        scene: &Scene,
        chain: SceneChain,
        seen: Option<&[Seen]>,
    ) -> Result<Self, Error> {
        let (mut rows, mut glbs) = (Vec::new(), Vec::new());
        for level in 0..chain.level_count() {
            let glb = glb(&chain.scene_at(scene, level))?;
            let sum = chain.summary(scene, level);
            let errors = [sum.max, sum.mean, sum.rms];
            let of = |s: &[Seen]| {
                level
                    .checked_sub(1)
                    .map_or(Some(0.0), |l| Some(s.get(l)?.flip))
            };
            rows.push(Row {
                switch_distance: sum.switch_distance,
                flip: seen.and_then(of),
                ..row(level, [sum.triangles, sum.vertices], glb.len(), errors)
            });
            glbs.push(glb);
        }
        let chain = Some(chain);
        Ok(Self { chain, rows, glbs })
    }

    /// A level as a GLB.
    pub fn glb(&self, level: usize) -> Option<Bytes> {
        self.glbs.get(level).cloned()
    }

    /// A level as a scene.
    pub fn scene(&self, original: &Scene, level: usize) -> Option<Scene> {
        if level >= self.rows.len() {
            return None;
        }
        Some(match &self.chain {
            Some(chain) => chain.scene_at(original, level),
            None => original.clone(),
        })
    }

    /// The mesh that stands for mesh `mesh` of the original at a level.
    pub fn mesh<'a>(&'a self, original: &'a Scene, mesh: usize, level: usize) -> &'a TriMesh {
        let chain = self
            .chain
            .as_ref()
            .and_then(|c| c.chains.get(mesh)?.as_ref());
        let coarse = chain.and_then(|c| c.level(level));
        coarse.map_or(&original.meshes[mesh].mesh, |l| &l.mesh)
    }

    /// All levels in one GLB (`MSFT_lod`).
    pub fn combined(&self, original: &Scene) -> Result<Bytes, Error> {
        match &self.chain {
            Some(chain) => glb(&to_msft_lod(original, chain).scene),
            None => glb(original),
        }
    }
}

fn row(level: usize, [triangles, vertices]: [usize; 2], bytes: usize, errors: [f64; 3]) -> Row {
    let [max, mean, rms] = errors;
    Row {
        level,
        triangles,
        vertices,
        bytes,
        error: Errors { max, mean, rms },
        switch_distance: 0.0,
        flip: None,
    }
}

fn glb(scene: &Scene) -> Result<Bytes, Error> {
    Ok(glb_bytes(scene, &GltfOptions::default())?.into())
}
