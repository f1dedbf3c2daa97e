//! The chains of all meshes of a scene.

use super::chain::Job;
use super::options::Surroundings;
use super::parts::Parts;
use super::scale::largest_stretch;
use super::{LodChain, LodLevel, LodOptions, Removed, Screen};
use crate::error::Result;
use crate::mesh::{Scene, TriMesh};
use crate::metrics::Surface;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// The levels of detail of a scene.
#[derive(Debug, Clone)]
pub struct SceneChain {
    /// The chain of every mesh; `None` for meshes without triangles and for
    /// those that only stand in for another ([`Scene::stand_ins`]).
    pub chains: Vec<Option<LodChain>>,
    /// The screen that switch distances are for.
    pub screen: Screen,
    /// Diagonal of the box around the scene, in the world's unit.
    pub diagonal: f64,
}

/// A scene with all meshes at one level, in numbers. Lengths are in the
/// world's unit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LevelSummary {
    /// Triangles, each mesh counted once.
    pub triangles: usize,
    /// Vertices, each mesh counted once.
    pub vertices: usize,
    /// Largest measured distance of any mesh.
    pub max: f64,
    /// Mean distance, averaged over the meshes by their area in the world.
    pub mean: f64,
    /// Root mean square distance, averaged likewise.
    pub rms: f64,
    /// Distance beyond which every mesh may be shown at this level.
    pub switch_distance: f64,
}

/// Builds the levels of every mesh of a scene. A mesh with several instances
/// is measured for the one that is stretched most.
///
/// # Errors
/// [`Error::BadOption`](crate::Error::BadOption) for options out of range,
/// those of [`simplify`](crate::simplify::simplify) and of
/// [`surface_distance`](crate::metrics::surface_distance) for damaged meshes,
/// [`Error::Cancelled`](crate::Error::Cancelled).
pub fn chain_scene(scene: &Scene, options: &LodOptions<'_>) -> Result<SceneChain> {
    options.levels.check()?;
    options.screen.check()?;
    let jobs = jobs(scene, options)?;
    let built = build(&jobs, options)?;
    let chain_of = |(job, built): (Option<Job>, Vec<_>)| job.map(|j| j.finish(built, options));
    Ok(SceneChain {
        chains: jobs.into_iter().zip(built).map(chain_of).collect(),
        screen: options.screen,
        diagonal: scene.bounds().diagonal(),
    })
}

/// One job a mesh, `None` where there is nothing to do.
fn jobs<'a>(scene: &'a Scene, options: &LodOptions<'a>) -> Result<Vec<Option<Job<'a>>>> {
    let placed = placements(scene);
    let (total, diagonal) = (scene.triangle_count(), scene.bounds().diagonal());
    let job = |(m, named): (usize, &'a crate::mesh::NamedMesh)| {
        let mesh = &named.mesh;
        if mesh.triangles.is_empty() || placed[m].only_stands_in {
            return Ok(None);
        }
        let around = Surroundings {
            triangles: total,
            diagonal,
            scale: placed[m].scale(),
        };
        let weights = options.weights.get(m).and_then(Option::as_deref);
        let stops = options
            .levels
            .stops(mesh.triangles.len(), around, &options.screen);
        options.method.check(&stops)?;
        let job = Job {
            surface: Surface::new(mesh)?,
            mesh: Cow::Borrowed(mesh),
            original: mesh,
            pruned: Removed::default(),
            around,
            instances: placed[m].instances,
            weights: weights.map(Cow::Borrowed),
            locks: options.simplify.locks.map(Cow::Borrowed),
            stops,
        };
        job.pruned(options.prune).map(Some)
    };
    scene.meshes.iter().enumerate().map(job).collect()
}

/// Builds all levels of all jobs, what can be at the same time.
fn build(jobs: &[Option<Job<'_>>], options: &LodOptions<'_>) -> Result<Vec<Vec<super::Measured>>> {
    let tasks: Vec<(usize, &Job, Range<usize>)> = (jobs.iter().enumerate())
        .filter_map(|(m, job)| Some((m, job.as_ref()?)))
        .flat_map(|(m, job)| job.tasks().into_iter().map(move |levels| (m, job, levels)))
        .collect();
    let weight = |(_, job, _): &(usize, &Job, Range<usize>)| job.mesh.triangles.len() as f32;
    let parts = Parts::new(
        options.progress,
        "levels",
        tasks.iter().map(weight).collect(),
    );
    let results: Vec<Result<_>> = tasks
        .par_iter()
        .enumerate()
        .map(|(part, (_, job, levels))| job.run(levels.clone(), options, &parts, part))
        .collect();
    let mut built: Vec<_> = jobs.iter().map(|_| Vec::new()).collect();
    for (&(m, ..), result) in tasks.iter().zip(results) {
        built[m].extend(result?);
    }
    Ok(built)
}

/// How a mesh stands in the scene.
#[derive(Debug, Clone, Copy, Default)]
struct Placed {
    stretch: f64,
    instances: usize,
    only_stands_in: bool,
}

impl Placed {
    fn scale(&self) -> f64 {
        // A mesh that is not placed, or shrunk to nothing, is taken as it is.
        if self.stretch > 0.0 {
            self.stretch
        } else {
            1.0
        }
    }
}

fn placements(scene: &Scene) -> Vec<Placed> {
    let mut placed = vec![Placed::default(); scene.meshes.len()];
    scene.for_each_instance(|instance| {
        let node = &scene.nodes[instance.node as usize];
        let Some(mesh) = placed.get_mut(instance.mesh as usize) else {
            return;
        };
        mesh.instances += 1;
        // A skinned mesh stands where its joints put it, not where its node is.
        let stretch = match node.skin {
            Some(_) => 1.0,
            None => largest_stretch(&instance.world_from_mesh.as_mat4()),
        };
        mesh.stretch = mesh.stretch.max(stretch);
    });
    let mut uses = vec![[0usize; 2]; scene.meshes.len()];
    for (node, stands_in) in scene.nodes.iter().zip(scene.stand_ins()) {
        if let Some(uses) = node.mesh.and_then(|m| uses.get_mut(m as usize)) {
            uses[usize::from(stands_in)] += 1;
        }
    }
    for (mesh, [shown, standing_in]) in placed.iter_mut().zip(uses) {
        mesh.only_stands_in = shown == 0 && standing_in > 0;
    }
    placed
}

impl LodChain {
    /// Level `level`, 0 being the original (`None`); the coarsest there is if
    /// there are not that many.
    #[must_use]
    pub fn level(&self, level: usize) -> Option<&LodLevel> {
        let last = self.levels.len().min(level);
        self.levels.get(last.checked_sub(1)?)
    }
}

impl SceneChain {
    /// Number of levels of the mesh with most, the original included.
    #[must_use]
    pub fn level_count(&self) -> usize {
        let counts = self.chains.iter().flatten().map(|c| c.levels.len());
        1 + counts.max().unwrap_or(0)
    }

    /// Parts pruned from all meshes, each counted once; the size of the largest
    /// in the world's unit.
    #[must_use]
    pub fn pruned(&self) -> Removed {
        let chains = self.chains.iter().flatten();
        chains.fold(Removed::default(), |sum, chain| Removed {
            components: sum.components + chain.pruned.components,
            triangles: sum.triangles + chain.pruned.triangles,
            error: sum.error.max(chain.pruned.error * chain.scale),
        })
    }

    /// The scene with every mesh at level `level`, 0 being the original, or at
    /// its coarsest. Links to stand-ins are left out.
    #[must_use]
    pub fn scene_at(&self, scene: &Scene, level: usize) -> Scene {
        let mut coarse = scene.clone();
        for (named, chain) in coarse.meshes.iter_mut().zip(&self.chains) {
            if let Some(level) = chain.as_ref().and_then(|c| c.level(level)) {
                named.mesh = level.mesh.clone();
            }
        }
        if level > 0 {
            coarse.nodes.iter_mut().for_each(|node| node.lods = None);
        }
        coarse
    }

    /// The scene at level `level` in numbers; [`Self::scene_at`] is that scene.
    #[must_use]
    pub fn summary(&self, scene: &Scene, level: usize) -> LevelSummary {
        let mut sum = LevelSummary::default();
        let mut area = 0.0;
        for (named, chain) in scene.meshes.iter().zip(&self.chains) {
            let coarse = chain.as_ref().and_then(|c| c.level(level));
            let mesh: &TriMesh = coarse.map_or(&named.mesh, |l| &l.mesh);
            sum.triangles += mesh.triangles.len();
            sum.vertices += mesh.positions.len();
            let Some(chain) = chain else { continue };
            let weight = chain.area * chain.scale.powi(2) * chain.instances.max(1) as f64;
            area += weight;
            let Some(coarse) = coarse else { continue };
            sum.max = sum.max.max(coarse.distance.max() * chain.scale);
            sum.mean += weight * coarse.distance.mean() * chain.scale;
            sum.rms += weight * (coarse.distance.rms() * chain.scale).powi(2);
            sum.switch_distance = sum.switch_distance.max(coarse.switch_distance);
        }
        if area > 0.0 {
            sum.mean /= area;
            sum.rms = (sum.rms / area).sqrt();
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lod::{Levels, chain_mesh};
    use crate::mesh::{Node, Transform, shapes};
    use crate::metrics::{Samples, SurfaceDistanceOptions, surface_distance};
    use glam::{Mat4, Vec3};

    fn placed(mesh: TriMesh, matrices: &[Mat4]) -> Scene {
        let mut scene = Scene::from_mesh(mesh);
        scene.nodes = (matrices.iter())
            .map(|&matrix| Node {
                mesh: Some(0),
                transform: Transform::Matrix(matrix),
                ..Node::default()
            })
            .collect();
        scene.roots = (0..matrices.len() as u32).collect();
        scene
    }

    fn options(levels: Levels) -> LodOptions<'static> {
        LodOptions {
            levels,
            samples: 5000,
            ..LodOptions::default()
        }
    }

    #[test]
    fn levels_get_coarser_and_never_claim_less() {
        let zoo = shapes::zoo()
            .into_iter()
            .filter(|(_, mesh)| !mesh.triangles.is_empty());
        let halving = Levels::Halving {
            min_triangles: 1,
            max_levels: 6,
        };
        for (name, mesh) in zoo {
            let chain = chain_mesh(&mesh, &options(halving.clone())).unwrap();
            let mut triangles = mesh.triangles.len();
            let (mut error, mut distance) = (0.0, 0.0);
            for level in &chain.levels {
                level.mesh.validate().unwrap();
                assert!(level.mesh.triangles.len() < triangles, "{name}");
                assert!(
                    level.error >= error && level.error >= level.distance.max(),
                    "{name}"
                );
                assert!(level.switch_distance >= distance, "{name}");
                triangles = level.mesh.triangles.len();
                (error, distance) = (level.error, level.switch_distance);
            }
            let asked = chain.levels.len() + chain.dropped.len();
            let expected = (1..=6).filter(|k| mesh.triangles.len() >> k >= 1).count();
            assert_eq!(asked, expected, "{name}");
        }
    }

    #[test]
    fn an_error_asked_for_holds_when_measured_anew() {
        let mesh = shapes::torus(1.0, 0.4, 96, 64);
        let wanted = [0.002, 0.01, 0.05];
        let chain = chain_mesh(&mesh, &options(Levels::Errors(wanted.to_vec()))).unwrap();
        assert_eq!(chain.levels.len(), 3);
        for (level, wanted) in chain.levels.iter().zip(wanted) {
            let other = SurfaceDistanceOptions {
                samples: Samples::Count(50_000),
                seed: 99,
                ..SurfaceDistanceOptions::default()
            };
            let max = surface_distance(&mesh, &level.mesh, &other).unwrap().max();
            assert!(
                level.distance.max() <= wanted,
                "{} {wanted}",
                level.distance.max()
            );
            // Other samples may lie a little farther off.
            assert!(max <= 1.05 * wanted, "{max} {wanted}");
            assert!(
                max >= 0.2 * wanted,
                "{max} {wanted}: far from using what is allowed"
            );
        }
    }

    #[test]
    fn errors_and_distances_are_those_of_the_largest_instance() {
        let mesh = shapes::icosphere(4);
        let levels = || options(Levels::Ratios(vec![0.2]));
        let alone = chain_mesh(&mesh, &levels()).unwrap();
        let large = Mat4::from_scale(Vec3::new(1.0, 3.0, 2.0));
        let scene = placed(mesh, &[Mat4::IDENTITY, large]);
        let chain = chain_scene(&scene, &levels()).unwrap();
        let placed = chain.chains[0].as_ref().unwrap();
        assert_eq!((placed.scale, placed.instances), (3.0, 2));
        let ratio = placed.levels[0].switch_distance / alone.levels[0].switch_distance;
        assert!((ratio - 3.0).abs() < 1e-9);
        let summary = chain.summary(&scene, 1);
        assert_eq!(summary.max, placed.levels[0].error);
        assert!(summary.mean < summary.rms && summary.rms < summary.max);
        assert_eq!(chain.summary(&scene, 0).max, 0.0);
    }

    #[test]
    fn what_cannot_get_coarser_is_left_out_and_named() {
        let mesh = shapes::icosphere(2);
        let locks = vec![true; mesh.positions.len()];
        let mut options = options(Levels::Ratios(vec![0.5, 0.1]));
        options.simplify.locks = Some(&locks);
        let chain = chain_mesh(&mesh, &options).unwrap();
        assert_eq!((chain.levels.len(), chain.dropped.len()), (0, 2));
        assert_eq!(chain.dropped[0].triangles, mesh.triangles.len());
    }

    #[test]
    fn nothing_to_do_and_nonsense() {
        let chain = chain_scene(&Scene::default(), &LodOptions::default()).unwrap();
        assert_eq!(chain.level_count(), 1);
        let mut scene = Scene::from_mesh(shapes::empty());
        scene.nodes[0].mesh = Some(7);
        assert!(chain_scene(&scene, &LodOptions::default()).unwrap().chains[0].is_none());
        assert!(chain_mesh(&shapes::empty(), &LodOptions::default()).is_err());
        let bad = options(Levels::Ratios(vec![2.0]));
        assert!(chain_mesh(&shapes::icosphere(1), &bad).is_err());
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let scene = placed(shapes::torus(1.0, 0.4, 48, 32), &[Mat4::IDENTITY]);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let chain = pool
                .install(|| chain_scene(&scene, &LodOptions::default()))
                .unwrap();
            let chain = chain.chains.into_iter().flatten().next().unwrap();
            let level = |l: LodLevel| (l.mesh, l.distance, l.switch_distance);
            chain.levels.into_iter().map(level).collect::<Vec<_>>()
        };
        assert_eq!(run(1), run(4));
    }
}
