//! Levels that a file brings along (`MSFT_lod`).

use karui::lod::LevelSummary;
use karui::metrics::{Samples, SurfaceDistanceOptions, surface_distance};
use karui::{Scene, TriMesh, lod::Screen};
use rayon::prelude::*;

/// Face samples, and as many edge samples, that a level is measured with each way.
const SAMPLES: u64 = 50_000;

/// The scene at each level, the original first; nothing if the file has one level.
pub fn linked_levels(scene: &Scene) -> Vec<Scene> {
    let links = scene.nodes.iter().filter_map(|n| n.lods.as_ref());
    let count = links.map(|l| l.nodes.len()).max().unwrap_or(0);
    match count {
        0 => Vec::new(),
        _ => (0..=count).map(|level| at_level(scene, level)).collect(),
    }
}

/// Every node replaced by its stand-in, or by its coarsest one.
fn at_level(scene: &Scene, level: usize) -> Scene {
    let mut shown = scene.clone();
    for (node, source) in shown.nodes.iter_mut().zip(&scene.nodes) {
        node.lods = None;
        let links = source.lods.as_ref().filter(|_| level > 0);
        let stand_in = links.and_then(|l| l.nodes.get(level - 1).or(l.nodes.last()));
        if let Some(stand_in) = stand_in.and_then(|&n| scene.nodes.get(n as usize)) {
            *node = stand_in.clone();
            node.lods = None;
        }
    }
    empty_unseen(&mut shown);
    shown
}

/// Takes the triangles of meshes that are placed nowhere, but not the meshes: what else the
/// file says goes by their numbers.
fn empty_unseen(scene: &mut Scene) {
    let mut seen = vec![false; scene.meshes.len()];
    scene.for_each_instance(|instance| {
        if let Some(seen) = seen.get_mut(instance.mesh as usize) {
            *seen = true;
        }
    });
    for (named, seen) in scene.meshes.iter_mut().zip(seen) {
        if !seen {
            named.mesh = TriMesh::default();
        }
    }
}

/// The levels in numbers, measured against the first.
///
/// # Errors
/// Those of [`Scene::into_single_mesh`] and [`surface_distance`].
pub fn measure(levels: &[Scene]) -> karui::Result<Vec<LevelSummary>> {
    let whole: Vec<TriMesh> = (levels.par_iter())
        .map(|scene| scene.clone().into_single_mesh())
        .collect::<karui::Result<_>>()?;
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(SAMPLES),
        ..SurfaceDistanceOptions::default()
    };
    let each = levels.par_iter().zip(&whole).enumerate();
    each.map(|(i, (scene, mesh))| {
        let mut summary = LevelSummary {
            triangles: scene.triangle_count(),
            vertices: scene.meshes.iter().map(|m| m.mesh.positions.len()).sum(),
            ..LevelSummary::default()
        };
        if i > 0 && !mesh.triangles.is_empty() {
            let distance = surface_distance(&whole[0], mesh, &options)?;
            summary.max = distance.max();
            summary.mean = distance.mean();
            summary.rms = distance.rms();
            summary.switch_distance = Screen::default().switch_distance(summary.max);
        }
        Ok(summary)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use karui::lod::{Levels, LodOptions, chain_scene, to_msft_lod};
    use karui::mesh::shapes;

    #[test]
    fn levels_come_back_as_they_were_linked() {
        let scene = Scene::from_mesh(shapes::torus(2.0, 0.7, 48, 24));
        assert!(linked_levels(&scene).is_empty());
        let options = LodOptions {
            levels: Levels::Ratios(vec![0.5, 0.1]),
            ..LodOptions::default()
        };
        let chain = chain_scene(&scene, &options).unwrap();
        let levels = linked_levels(&to_msft_lod(&scene, &chain).scene);
        assert_eq!(levels.len(), chain.level_count());
        let measured = measure(&levels).unwrap();
        for (level, (own, summary)) in levels.iter().zip(measured).enumerate() {
            let expected = chain.scene_at(&scene, level).into_single_mesh().unwrap();
            assert_eq!(own.clone().into_single_mesh().unwrap(), expected);
            let known = chain.summary(&scene, level);
            assert_eq!(summary.triangles, known.triangles);
            assert!(
                (summary.max - known.max).abs() <= 0.1 * known.max,
                "{summary:?}"
            );
        }
    }
}
