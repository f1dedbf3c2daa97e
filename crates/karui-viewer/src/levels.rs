//! The levels of a model, as they are sent.

use crate::links::{linked_levels, measure};
use axum::body::Bytes;
use karui::lod::{LevelSummary, SceneChain, Seen, to_msft_lod};
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
    /// What the file brought along, the original first; nothing if a chain made the levels.
    linked: Vec<Scene>,
    glbs: Vec<Bytes>,
}

/// A level in numbers. Lengths are in model units.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    level: usize,
    /// Triangles, each mesh counted once.
    pub triangles: usize,
    /// The same of vertices.
    pub vertices: usize,
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
    /// What a file holds: the original, and the levels that it brings along.
    pub fn of_file(scene: &Scene) -> Result<Self, Error> {
        let linked = linked_levels(scene);
        if linked.is_empty() {
            return Self::of_original(scene);
        }
        let fail = |error: karui::Error| Error::file("", error.into());
        let summaries = measure(&linked).map_err(fail)?;
        let (mut rows, mut glbs) = (Vec::new(), Vec::new());
        for (level, (own, sum)) in linked.iter().zip(summaries).enumerate() {
            let glb = glb(own)?;
            rows.push(row(level, &sum, glb.len()));
            glbs.push(glb);
        }
        Ok(Self {
            chain: None,
            rows,
            linked,
            glbs,
        })
    }

    fn of_original(scene: &Scene) -> Result<Self, Error> {
        let glb = glb(scene)?;
        let sum = LevelSummary {
            triangles: scene.triangle_count(),
            vertices: scene.meshes.iter().map(|m| m.mesh.positions.len()).sum(),
            ..LevelSummary::default()
        };
        Ok(Self {
            chain: None,
            rows: vec![row(0, &sum, glb.len())],
            linked: Vec::new(),
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
            let of = |s: &[Seen]| match level.checked_sub(1) {
                Some(l) => Some(s.get(l)?.flip),
                None => Some(0.0),
            };
            rows.push(Row {
                flip: seen.and_then(of),
                ..row(level, &chain.summary(scene, level), glb.len())
            });
            glbs.push(glb);
        }
        let chain = Some(chain);
        let linked = Vec::new();
        Ok(Self {
            chain,
            rows,
            linked,
            glbs,
        })
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
        Some(match (&self.chain, self.linked.get(level)) {
            (Some(chain), _) => chain.scene_at(original, level),
            (None, Some(linked)) => linked.clone(),
            (None, None) => original.clone(),
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

fn row(level: usize, sum: &LevelSummary, bytes: usize) -> Row {
    Row {
        level,
        triangles: sum.triangles,
        vertices: sum.vertices,
        bytes,
        error: Errors {
            max: sum.max,
            mean: sum.mean,
            rms: sum.rms,
        },
        switch_distance: sum.switch_distance,
        flip: None,
    }
}

fn glb(scene: &Scene) -> Result<Bytes, Error> {
    Ok(glb_bytes(scene, &GltfOptions::default())?.into())
}
