//! What `karui lod` reports, as JSON and as a table.

use crate::explain;
use crate::input::Input;
use crate::table::{bytes, count, number, percent, table};
use karui::lod::{DroppedLevel, LodChain, LodLevel, Reached, SceneChain, Seen};
use karui::simplify::Stop;
use serde::Serialize;
use std::path::PathBuf;

/// `report.json`. Lengths are in model units unless said otherwise.
#[derive(Debug, Serialize)]
pub struct Report {
    karui: &'static str,
    input: PathBuf,
    input_bytes: u64,
    /// Length of the diagonal of the model's box.
    diagonal: f64,
    screen: ScreenReport,
    samples: u64,
    /// How pictures decided; absent if surfaces did.
    #[serde(skip_serializing_if = "Option::is_none")]
    flip: Option<FlipReport>,
    /// The file with all levels.
    pub combined: Option<String>,
    /// Its size, with the files it refers to.
    pub combined_bytes: Option<u64>,
    /// The whole model a level.
    pub levels: Vec<Row>,
    meshes: Vec<MeshReport>,
}

#[derive(Debug, Serialize)]
struct ScreenReport {
    height_px: f64,
    fov_y_degrees: f64,
    tolerance_px: f64,
}

#[derive(Debug, Serialize)]
struct FlipReport {
    /// Largest mean FLIP asked for.
    bound: f64,
    views: u32,
    /// Along each side of a pixel.
    samples_per_side: u32,
}

/// What pictures of the levels said.
pub struct Judged {
    /// Every level but the original.
    pub levels: Vec<Seen>,
    /// Largest mean FLIP asked for.
    pub bound: f64,
    /// Directions looked from.
    pub views: u32,
    /// Samples along each side of a pixel.
    pub samples: u32,
}

/// The whole model at one level.
#[derive(Debug, Serialize)]
pub struct Row {
    level: usize,
    /// File of this level alone.
    pub file: Option<String>,
    /// Size of the level as a file of its own.
    pub bytes: u64,
    /// Triangles, each mesh counted once.
    pub triangles: usize,
    vertices: usize,
    /// Measured, two-sided.
    pub error: Error,
    /// As shares of the diagonal.
    relative_error: Error,
    switch_distance: f64,
    /// What the switch distance is by: `surface` or `flip`.
    metric: &'static str,
    /// Mean FLIP at the switch distance.
    #[serde(skip_serializing_if = "Option::is_none")]
    flip: Option<f64>,
    /// Whether that keeps the bound; if not, the distance is where the search ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    bound_kept: Option<bool>,
}

/// Distances between a level and the original.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Error {
    /// Largest.
    pub max: f64,
    mean: f64,
    rms: f64,
}

#[derive(Debug, Serialize)]
struct MeshReport {
    name: Option<String>,
    triangles: usize,
    vertices: usize,
    instances: usize,
    /// Largest stretch of any instance.
    scale: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pruned: Option<PrunedReport>,
    levels: Vec<MeshLevel>,
    left_out: Vec<LeftOut>,
}

/// Parts removed from a mesh.
#[derive(Debug, Serialize)]
struct PrunedReport {
    parts: usize,
    triangles: usize,
    /// Size of the largest.
    largest: f64,
}

/// One level of one mesh; errors in the unit of the mesh.
#[derive(Debug, Serialize)]
struct MeshLevel {
    asked: Asked,
    triangles: usize,
    vertices: usize,
    error: Error,
    estimate: f64,
    stopped: &'static str,
    /// Why edge collapse had stopped where clustering has taken over.
    #[serde(skip_serializing_if = "Option::is_none")]
    clustered: Option<&'static str>,
    /// In model units.
    switch_distance: f64,
}

#[derive(Debug, Serialize)]
struct LeftOut {
    asked: Asked,
    triangles: usize,
    stopped: &'static str,
}

#[derive(Debug, Serialize)]
struct Asked {
    #[serde(skip_serializing_if = "Option::is_none")]
    triangles: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ratio: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<f64>,
}

impl Report {
    /// Everything but names and sizes of files.
    pub fn new(input: &Input, chain: &SceneChain, samples: u64, judged: Option<&Judged>) -> Self {
        let meshes = input.scene.meshes.iter().zip(&chain.chains);
        Self {
            karui: env!("CARGO_PKG_VERSION"),
            input: input.path.clone(),
            input_bytes: input.bytes,
            diagonal: chain.diagonal,
            screen: ScreenReport {
                height_px: chain.screen.height_px,
                fov_y_degrees: chain.screen.fov_y.to_degrees(),
                tolerance_px: chain.screen.tolerance_px,
            },
            samples,
            flip: judged.map(|j| FlipReport {
                bound: j.bound,
                views: j.views,
                samples_per_side: j.samples,
            }),
            combined: None,
            combined_bytes: None,
            levels: (0..chain.level_count())
                .map(|level| row(input, chain, level, judged))
                .collect(),
            meshes: meshes
                .map(|(named, chain)| MeshReport {
                    name: named.name.clone(),
                    triangles: named.mesh.triangles.len(),
                    vertices: named.mesh.positions.len(),
                    instances: chain.as_ref().map_or(0, |c| c.instances),
                    scale: chain.as_ref().map_or(1.0, |c| c.scale),
                    pruned: chain.as_ref().and_then(pruned),
                    levels: of_chain(chain, |c| c.levels.iter().map(mesh_level).collect()),
                    left_out: of_chain(chain, |c| c.dropped.iter().map(left_out).collect()),
                })
                .collect(),
        }
    }

    /// For people.
    pub fn table(&self) -> String {
        let row = |row: &Row| {
            let mut cells = vec![
                row.level.to_string(),
                count(row.triangles),
                count(row.vertices),
                bytes(row.bytes),
                number(row.error.max),
                number(row.error.mean),
                number(row.error.rms),
                percent(row.relative_error.max),
                percent(row.relative_error.rms),
                number(row.switch_distance),
            ];
            cells.extend(row.flip.map(number));
            cells
        };
        let rows: Vec<_> = self.levels.iter().map(row).collect();
        let mut header = vec![
            "level",
            "triangles",
            "vertices",
            "bytes",
            "max error",
            "mean",
            "RMS",
            "max/diag.",
            "RMS/diag.",
            "shown beyond",
        ];
        header.extend(self.flip.is_some().then_some("FLIP there"));
        table(&header, &rows, false)
    }
}

fn of_chain<T>(chain: &Option<LodChain>, list: impl Fn(&LodChain) -> Vec<T>) -> Vec<T> {
    chain.as_ref().map(list).unwrap_or_default()
}

fn row(input: &Input, chain: &SceneChain, level: usize, judged: Option<&Judged>) -> Row {
    let summary = chain.summary(&input.scene, level);
    let error = |unit: f64| Error {
        max: summary.max / unit,
        mean: summary.mean / unit,
        rms: summary.rms / unit,
    };
    // A model that is one point has no diagonal to compare with.
    let diagonal = if chain.diagonal > 0.0 {
        chain.diagonal
    } else {
        1.0
    };
    // Of the original, nothing differs.
    let seen = judged.map(|j| level.checked_sub(1).and_then(|l| j.levels.get(l)));
    Row {
        level,
        file: None,
        bytes: 0,
        triangles: summary.triangles,
        vertices: summary.vertices,
        error: error(1.0),
        relative_error: error(diagonal),
        switch_distance: summary.switch_distance,
        metric: if judged.is_some() { "flip" } else { "surface" },
        flip: seen.map(|s| s.map_or(0.0, |s| s.flip)),
        bound_kept: seen.map(|s| s.is_none_or(|s| s.reached != Reached::Never)),
    }
}

fn pruned(chain: &LodChain) -> Option<PrunedReport> {
    let removed = chain.pruned;
    (removed.components > 0).then_some(PrunedReport {
        parts: removed.components,
        triangles: removed.triangles,
        largest: removed.error,
    })
}

fn mesh_level(level: &LodLevel) -> MeshLevel {
    MeshLevel {
        asked: asked(&level.asked),
        triangles: level.mesh.triangles.len(),
        vertices: level.mesh.positions.len(),
        error: Error {
            max: level.distance.max(),
            mean: level.distance.mean(),
            rms: level.distance.rms(),
        },
        estimate: level.estimate,
        stopped: explain::key(level.stopped),
        clustered: level.fallback.map(explain::key),
        switch_distance: level.switch_distance,
    }
}

fn left_out(level: &DroppedLevel) -> LeftOut {
    LeftOut {
        asked: asked(&level.asked),
        triangles: level.triangles,
        stopped: explain::key(level.stopped),
    }
}

fn asked(stop: &Stop) -> Asked {
    Asked {
        triangles: stop.triangles,
        ratio: stop.ratio,
        error: stop.error,
    }
}
