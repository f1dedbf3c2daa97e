//! The topology report against the numbers that another program found in the
//! same models (`MANIFEST.tsv`).

use karui::mesh::{TopologyReport, TriMesh, diagnose};
use karui_io::Format;
use std::path::{Path, PathBuf};

/// What both programs count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Counts {
    boundary_edges: usize,
    nonmanifold_edges: usize,
    nonmanifold_vertices: usize,
    inconsistent_edges: usize,
    components: usize,
    zero_area: usize,
    duplicates: usize,
}

impl Counts {
    fn of(report: &TopologyReport) -> Self {
        Self {
            boundary_edges: report.boundary_edges,
            nonmanifold_edges: report.nonmanifold_edges,
            nonmanifold_vertices: report.nonmanifold_vertices,
            inconsistent_edges: report.inconsistent_edges,
            components: report.components,
            zero_area: report.degenerate + report.zero_area,
            duplicates: report.duplicate_faces,
        }
    }

    /// From a row like `no (231 boundary edges)`, `no (edges 0, vertices 33,
    /// orientation 0)`, `6`, `zero-area 0, duplicate 0, slivers 21`.
    fn of_row(row: &[&str]) -> Option<Self> {
        let [closed, manifold, components, defects] = row.get(7..11)?.try_into().ok()?;
        let [nonmanifold_edges, nonmanifold_vertices, inconsistent_edges] = match manifold {
            "yes" => [0; 3],
            other => *numbers(other).first_chunk()?,
        };
        let [zero_area, duplicates] = *numbers(defects).first_chunk()?;
        Some(Self {
            boundary_edges: numbers(closed).first().copied().unwrap_or(0),
            nonmanifold_edges,
            nonmanifold_vertices,
            inconsistent_edges,
            components: components.parse().ok()?,
            zero_area,
            duplicates,
        })
    }
}

fn numbers(text: &str) -> Vec<usize> {
    let words = text.split(|c: char| !c.is_ascii_digit());
    words.filter_map(|word| word.parse().ok()).collect()
}

fn models() -> PathBuf {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models");
    std::env::var_os("KARUI_MODELS").map_or(default, PathBuf::from)
}

/// Name and expected counts of every model in a format that is read.
fn rows(manifest: &str) -> Vec<(String, Counts)> {
    let rows = manifest
        .lines()
        .map(|line| line.split('\t').collect::<Vec<_>>());
    rows.filter_map(|row| Some((row.first()?.to_string(), Counts::of_row(&row)?)))
        .filter(|(name, _)| Format::from_path(Path::new(name)).is_ok())
        .collect()
}

fn counts(mesh: &TriMesh) -> Counts {
    Counts::of(&diagnose(mesh).expect("valid indices"))
}

/// All meshes of a model laid over one another, without the placement that a
/// scene gives them: that is what the other program counted.
fn as_read(path: &Path) -> Counts {
    let mut all = TriMesh::default();
    for mesh in karui_io::read(path).expect("readable").meshes {
        let first = all.positions.len() as u32;
        let shifted = mesh.mesh.triangles.iter().map(|t| t.map(|v| v + first));
        all.triangles.extend(shifted);
        all.positions.extend(mesh.mesh.positions);
    }
    counts(&all)
}

/// Polygons cut into fans, as the other program does, not into ears.
fn as_fans(path: &Path) -> Counts {
    let polygons = karui_io::read_poly(path).expect("readable");
    let fan = |face: &[u32]| -> Vec<[u32; 3]> {
        face[1..]
            .windows(2)
            .map(|w| [face[0], w[0], w[1]])
            .collect()
    };
    let triangles = polygons.faces().flat_map(fan).collect();
    counts(&TriMesh::new(polygons.positions.clone(), triangles))
}

/// Concave or repeated polygons, where fans and ears differ.
const CUT_DIFFERENTLY: [&str; 4] = [
    "hard/concave_polygon.obj",
    "hard/sponza.obj.gz",
    "subdivision/opensubdiv/catmark_gregory_test1.obj",
    "subdivision/opensubdiv/catmark_val2_interior.obj",
];

/// Files that break their format, which the two programs read differently:
/// facets of two or four vertices.
const READ_DIFFERENTLY: [&str; 3] = [
    "hard/stl-broken/fourVertices.ascii.stl",
    "hard/stl-broken/quad.ascii.stl",
    "hard/stl-broken/twoVertices.ascii.stl",
];

#[test]
fn counts_agree() {
    let folder = models();
    let Ok(manifest) = std::fs::read_to_string(folder.join("MANIFEST.tsv")) else {
        println!("SKIPPED: no models in {}", folder.display());
        return;
    };
    let rows = rows(&manifest);
    assert!(rows.len() > 300, "{} rows", rows.len());
    for (name, expected) in rows
        .iter()
        .filter(|(n, _)| !READ_DIFFERENTLY.contains(&n.as_str()))
    {
        let path = folder.join(name);
        if CUT_DIFFERENTLY.contains(&name.as_str()) {
            assert_ne!(as_read(&path), *expected, "{name} no longer differs");
            assert_eq!(as_fans(&path), *expected, "{name} in fans");
        } else {
            assert_eq!(as_read(&path), *expected, "{name}");
        }
    }
}
