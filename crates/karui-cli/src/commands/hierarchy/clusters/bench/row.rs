//! What the bench finds, and how it is told.

use super::BuildArgs;
use crate::commands::bench::page::machine;
use crate::table::{bytes, count, percent, table};
use serde::Serialize;

/// What is found of a model.
#[derive(Debug, Serialize)]
pub struct Row {
    /// Its name.
    pub model: String,
    /// Its triangles.
    pub triangles: usize,
    /// Of the build alone.
    pub build_seconds: f64,
    /// Of all levels.
    pub clusters: usize,
    /// Levels of them.
    pub levels: usize,
    /// Mean share of the triangles that a cluster of level 0 may have.
    pub fill: f64,
    /// Triangles of the coarsest cut by its triangles.
    pub root_share: f64,
    /// Failed attempts to simplify a group.
    pub stuck: usize,
    /// In memory, by triangles of the model.
    pub bytes_per_triangle: f64,
    /// As written to a file.
    pub file_bytes: usize,
    /// Medians over the frames of the walk, without and with culling.
    pub drawn: [usize; 2],
    /// Likewise, of a cut.
    pub cut_milliseconds: [f64; 2],
    /// 95 % of the cuts with culling take no longer.
    pub late: f64,
    /// Median time of the index buffer, with culling.
    pub index_milliseconds: f64,
}

/// The rows as a table, and how they were measured.
pub fn markdown(rows: &[Row], frames: u32, build: BuildArgs) -> String {
    let header = [
        "model",
        "triangles",
        "build s",
        "M/s",
        "clusters",
        "levels",
        "fill",
        "roots",
        "stuck",
        "B/tri",
        "file",
        "all",
        "all ms",
        "seen",
        "seen ms",
        "95 %",
        "index ms",
    ];
    let cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    format!(
        "## Clusters in levels of detail, frame by frame\n\n\
         Written by `karui hierarchy clusters bench FILES --sizes N,N -o FILE` ({} build).\n\n\
         - Clusters of at most {} triangles, at most {} of them in a group unless these cannot be\n\
         \u{20} simplified. M/s: million triangles of the model built a second, on all threads. Fill:\n\
         \u{20} triangles of the mean cluster of level 0 by what it may have. Roots: triangles of the coarsest\n\
         \u{20} cut by those of the model. Stuck: failed attempts to simplify a group. B/tri: bytes in memory\n\
         \u{20} by triangles of the model. File: as `karui hierarchy clusters build` writes it.\n\
         - The walk: {} frames of 1920 x 1080 pixels, an error of at most 1 pixel, no lights. Models:\n\
         \u{20} once around, 0.3 rad above, all of the model in a field of view of 0.6 rad. Landscapes\n\
         \u{20} (`shapes::landscape`, seed 1): once around in a circle, a quarter of the shorter side from the\n\
         \u{20} middle, 20 units (quads) above the highest point, looking ahead and a quarter downwards, field\n\
         \u{20} of view 1 rad.\n\
         - All: triangles drawn and milliseconds of `ClusterDag::cut`, nothing culled. Seen: the same\n\
         \u{20} without what is outside the picture or faces away; 95 %: of these cuts take no longer. Index:\n\
         \u{20} milliseconds of `Cut::triangles` of what is seen. Medians over the frames, each measured once\n\
         \u{20} and in this order, so that the first cut warms the caches for the second; on one thread,\n\
         \u{20} nothing kept from frame to frame.\n\n\
         {}\n\n{}\n",
        if cfg!(debug_assertions) {
            "dev"
        } else {
            "release"
        },
        build.max_triangles,
        build.group_size,
        count(frames as usize),
        machine(),
        table(&header, &cells, true)
    )
}

fn cells(row: &Row) -> Vec<String> {
    vec![
        format!("`{}`", row.model),
        count(row.triangles),
        format!("{:.2}", row.build_seconds),
        format!("{:.2}", row.triangles as f64 / row.build_seconds * 1e-6),
        count(row.clusters),
        count(row.levels),
        percent(row.fill),
        percent(row.root_share),
        count(row.stuck),
        format!("{:.1}", row.bytes_per_triangle),
        bytes(row.file_bytes as u64),
        count(row.drawn[0]),
        format!("{:.4}", row.cut_milliseconds[0]),
        count(row.drawn[1]),
        format!("{:.4}", row.cut_milliseconds[1]),
        format!("{:.4}", row.late),
        format!("{:.4}", row.index_milliseconds),
    ]
}
