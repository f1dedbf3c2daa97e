//! A scene as objects with levels of detail.

use anyhow::Result;
use karui::geom::Mat4;
use karui::hlod::{Levels, Object, Shape};
use karui::mesh::{LodLinks, Scene};
use karui::render::{Model, Picture};
use karui::{SimplifyOptions, Stop, TriMesh, simplify};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Vertical field of view of all pictures, radians.
pub const FOV_Y: f32 = 0.9;

/// Shares of their triangles that meshes without levels get levels of, and shares of
/// the picture's height below which these are shown.
const MADE: [(f64, f32); 2] = [(0.3, 0.3), (0.1, 0.1)];
/// Meshes of fewer triangles get none.
const WORTH_IT: usize = 100;

/// Objects, and what there is to draw for them.
pub struct Crowd {
    pub scene: Scene,
    pub images: Vec<Option<Picture>>,
    /// Levels that the scene did not have.
    made: Vec<TriMesh>,
    /// What is perceived of every object.
    pub objects: Vec<Object>,
    /// Mesh of every object.
    pub meshes: Vec<u32>,
    pub places: Vec<Mat4>,
    /// Triangles and distances of the levels of every mesh.
    pub levels: Vec<Levels>,
    /// Which meshes the levels are, the finest first.
    pub level_meshes: Vec<Vec<u32>>,
    /// What is drawn in any case and is no object.
    pub backdrop: Vec<(u32, Mat4)>,
}

impl Crowd {
    /// Every placed mesh is an object but those called `backdrop`. Levels are those
    /// of the scene, else made, if `make_levels`.
    pub fn new(
        scene: Scene,
        images: Vec<Option<Picture>>,
        backdrop: &str,
        make_levels: bool,
    ) -> Result<Self> {
        let mut crowd = Self {
            level_meshes: given_levels(&scene),
            scene,
            images,
            made: Vec::new(),
            objects: Vec::new(),
            meshes: Vec::new(),
            places: Vec::new(),
            levels: Vec::new(),
            backdrop: Vec::new(),
        };
        crowd.gather(backdrop)?;
        let switches = crowd.switches(make_levels)?;
        let sizes = crowd.sizes();
        crowd.levels = (0..crowd.scene.meshes.len())
            .map(|mesh| crowd.levels_of(mesh, sizes[mesh], &switches[mesh]))
            .collect();
        Ok(crowd)
    }

    fn gather(&mut self, backdrop: &str) -> Result<()> {
        let shapes = self.shapes()?;
        let stand_in = self.scene.stand_ins();
        for instance in self.scene.iter_instances() {
            let mesh = instance.mesh as usize;
            let Some(shape) = shapes[mesh].filter(|_| !stand_in[instance.node as usize]) else {
                continue;
            };
            let place = instance.world_from_mesh.as_mat4();
            if self.scene.meshes[mesh].name.as_deref() == Some(backdrop) {
                self.backdrop.push((instance.mesh, place));
                continue;
            }
            self.objects.push(shape.placed(&instance.world_from_mesh));
            self.meshes.push(instance.mesh);
            self.places.push(place);
        }
        Ok(())
    }

    /// Of every mesh that has triangles.
    fn shapes(&self) -> Result<Vec<Option<Shape>>> {
        let model = Model {
            meshes: self.scene.meshes.iter().map(|m| &m.mesh).collect(),
            instances: Vec::new(),
            materials: &self.scene.materials,
            textures: &self.scene.textures,
            images: &self.images,
        };
        let shape = |mesh: usize| match model.meshes[mesh].triangles.is_empty() {
            true => Ok(None),
            false => Ok(Some(Shape::of(&model, mesh)?)),
        };
        (0..model.meshes.len()).into_par_iter().map(shape).collect()
    }

    /// Shares of the picture's height below which the second and further levels of
    /// every mesh are shown; makes them where there are none.
    fn switches(&mut self, make_levels: bool) -> Result<Vec<Vec<f32>>> {
        let given = given_switches(&self.scene);
        let mut shown = vec![false; self.scene.meshes.len()];
        self.meshes.iter().for_each(|&m| shown[m as usize] = true);
        let lacks = |m: &usize| {
            let large = self.scene.meshes[*m].mesh.triangles.len() >= WORTH_IT;
            make_levels && shown[*m] && large && self.level_meshes[*m].len() == 1
        };
        let lacking: Vec<usize> = (0..shown.len()).filter(lacks).collect();
        let make = |&m: &usize| made_levels(&self.scene.meshes[m].mesh);
        let made: Vec<Vec<TriMesh>> = lacking.par_iter().map(make).collect::<Result<_>>()?;
        let mut switches: Vec<Vec<f32>> = (0..shown.len() as u32)
            .map(|m| given.get(&m).cloned().unwrap_or_default())
            .collect();
        for (mesh, levels) in lacking.into_iter().zip(made) {
            switches[mesh] = MADE.iter().map(|(_, share)| *share).collect();
            for level in levels {
                let index = self.scene.meshes.len() + self.made.len();
                self.level_meshes[mesh].push(index as u32);
                self.made.push(level);
            }
        }
        Ok(switches)
    }

    /// Diagonal of the largest object of every mesh.
    fn sizes(&self) -> Vec<f32> {
        let mut sizes = vec![0.0; self.scene.meshes.len()];
        for (object, &mesh) in self.objects.iter().zip(&self.meshes) {
            let size = &mut sizes[mesh as usize];
            *size = f64::max(*size, object.bounds.diagonal());
        }
        sizes.into_iter().map(|size| size as f32).collect()
    }

    fn levels_of(&self, mesh: usize, size: f32, shares: &[f32]) -> Levels {
        let distance = |share: &f32| size / (2.0 * (0.5 * FOV_Y).tan() * share);
        let levels = self.level_meshes[mesh].iter();
        Levels {
            switch: shares.iter().map(distance).collect(),
            triangles: levels
                .map(|&m| self.mesh(m).triangles.len() as u32)
                .collect(),
        }
    }

    /// All meshes: the scene's, then those made.
    pub fn all_meshes(&self) -> impl Iterator<Item = &TriMesh> {
        self.scene.meshes.iter().map(|m| &m.mesh).chain(&self.made)
    }

    /// One of them.
    pub fn mesh(&self, index: u32) -> &TriMesh {
        let index = index as usize;
        match index.checked_sub(self.scene.meshes.len()) {
            Some(made) => &self.made[made],
            None => &self.scene.meshes[index].mesh,
        }
    }

    /// Mesh of an object at one of its levels.
    pub fn mesh_at(&self, object: u32, level: u32) -> u32 {
        self.level_meshes[self.meshes[object as usize] as usize][level as usize]
    }

    /// Mesh of an object at its coarsest level.
    pub fn coarsest(&self, object: u32) -> u32 {
        let levels = &self.level_meshes[self.meshes[object as usize] as usize];
        levels[levels.len() - 1]
    }
}

/// The mesh itself, and the levels that a node gives it.
fn given_levels(scene: &Scene) -> Vec<Vec<u32>> {
    let mut levels: Vec<Vec<u32>> = (0..scene.meshes.len() as u32).map(|m| vec![m]).collect();
    for (mesh, lods) in linked(scene) {
        let own = &mut levels[mesh as usize];
        if own.len() == 1 {
            let nodes = lods.nodes.iter().map(|&n| &scene.nodes[n as usize]);
            own.extend(nodes.filter_map(|n| n.mesh));
        }
    }
    levels
}

fn given_switches(scene: &Scene) -> BTreeMap<u32, Vec<f32>> {
    let mut switches = BTreeMap::new();
    for (mesh, lods) in linked(scene) {
        let shares = lods.coverage.iter().take(lods.nodes.len());
        switches
            .entry(mesh)
            .or_insert_with(|| shares.copied().collect());
    }
    switches
}

/// Meshes whose nodes have levels at the same place, each with all that it takes.
fn linked(scene: &Scene) -> impl Iterator<Item = (u32, &LodLinks)> {
    let is_whole = |lods: &&LodLinks, transform| {
        let nodes = || lods.nodes.iter().map(|&n| &scene.nodes[n as usize]);
        lods.coverage.len() > lods.nodes.len()
            && nodes().all(|n| n.mesh.is_some() && &n.transform == transform)
    };
    scene.nodes.iter().filter_map(move |node| {
        let lods = node.lods.as_ref();
        Some((node.mesh?, lods.filter(|l| is_whole(l, &node.transform))?))
    })
}

fn made_levels(mesh: &TriMesh) -> Result<Vec<TriMesh>> {
    let level = |(ratio, _): (f64, f32)| {
        let options = SimplifyOptions {
            stop: Stop::ratio(ratio),
            ..SimplifyOptions::default()
        };
        Ok(simplify(mesh, &options)?.mesh)
    };
    MADE.into_iter().map(level).collect()
}
