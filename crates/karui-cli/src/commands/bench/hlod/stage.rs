//! Pictures of draw lists.

use super::crowd::{Crowd, FOV_Y};
use anyhow::Result;
use karui::TriMesh;
use karui::geom::{Camera, DMat4, Light, Mat4, Projection, Vec3};
use karui::hlod::proxy::{
    BoxOptions, Group, ImpostorOptions, Look, Member, Objects, Proxy, box_proxy, impostor,
};
use karui::hlod::{Assets, DrawList, Item, Levels, Tree, View, Walk};
use karui::mesh::{Material, Texture};
use karui::render::{Instance, Model, Outputs, Picture, RenderOptions, Renderer};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Triangles of a stand-in of either kind.
const STAND_IN: u32 = 12;
/// Texels along the diagonal of a group on its cards.
const TEXELS: u32 = 48;

/// What stands for groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandIns {
    /// The paper's: a box of the mean colour, as transparent as its members leave of it.
    Boxes,
    /// Pictures on two upright cards and a level one.
    Cards,
}

/// What is drawn of a tree. Stand-ins are made when they are first seen.
pub struct Stage<'a> {
    crowd: &'a Crowd,
    tree: &'a Tree,
    look: &'a Look<'a>,
    kind: StandIns,
    /// Triangles of every group.
    triangles: Vec<u32>,
    /// `None` where the members themselves are no more.
    made: BTreeMap<u32, Option<Proxy>>,
    walk: Walk,
}

impl<'a> Stage<'a> {
    /// `look` is that of the crowd.
    pub fn new(crowd: &'a Crowd, tree: &'a Tree, look: &'a Look<'a>, kind: StandIns) -> Self {
        let mut triangles = vec![0u64; tree.group_capacity()];
        for id in tree.bottom_up() {
            let Some(group) = tree.group(id) else {
                continue;
            };
            let below = group.children().map(|child| match child {
                karui::hlod::Member::Group(id) => triangles[id as usize],
                karui::hlod::Member::Object(id) => {
                    crowd.mesh(crowd.coarsest(id)).triangles.len() as u64
                }
            });
            triangles[id as usize] = below.sum();
        }
        let fewer = |n: u64| n.min(STAND_IN.into()) as u32;
        Self {
            crowd,
            tree,
            look,
            kind,
            triangles: triangles.into_iter().map(fewer).collect(),
            made: BTreeMap::new(),
            walk: Walk::default(),
        }
    }

    /// What a frame draws.
    pub fn list(&mut self, view: &View) -> Result<DrawList> {
        self.list_with(&self.crowd.levels, view)
    }

    /// What a frame draws if levels are switched at distances that are shorter by a factor.
    pub fn coarser(&mut self, view: &View, factor: f32) -> Result<DrawList> {
        let mut levels = self.crowd.levels.clone();
        let switches = levels.iter_mut().flat_map(|l| &mut l.switch);
        switches.for_each(|distance| *distance *= factor);
        self.list_with(&levels, view)
    }

    fn list_with(&mut self, levels: &[Levels], view: &View) -> Result<DrawList> {
        let assets = Assets {
            levels,
            levels_of_object: &self.crowd.meshes,
            proxies: &self.triangles,
        };
        Ok(self.walk.frame(self.tree, view, &assets)?.clone())
    }

    /// Draws a list.
    pub fn picture(&mut self, list: &DrawList, camera: &Camera, size: [u32; 2]) -> Result<Picture> {
        self.make(list)?;
        let mut set = Set::of(self.crowd);
        for item in &list.items {
            match *item {
                Item::Object { object, level } => {
                    set.object(self.crowd, object, self.crowd.mesh_at(object, level));
                }
                Item::Group(id) => match self.made.get(&id) {
                    Some(Some(proxy)) => set.stand_in(proxy),
                    _ => self.members(id).into_iter().for_each(|object| {
                        set.object(self.crowd, object, self.crowd.coarsest(object));
                    }),
                },
            }
        }
        set.picture(self.crowd, camera, size)
    }

    fn members(&self, group: u32) -> Vec<u32> {
        let group = self.tree.group(group);
        group.map_or_else(Vec::new, |g| g.objects().collect())
    }

    /// Makes the stand-ins that a list lacks.
    fn make(&mut self, list: &DrawList) -> Result<()> {
        let lacking = |item: &Item| match *item {
            Item::Group(id) => (!self.made.contains_key(&id)).then_some(id),
            Item::Object { .. } => None,
        };
        let lacking: Vec<u32> = list.items.iter().filter_map(lacking).collect();
        let make = |&id: &u32| Ok((id, self.stand_in(id)?));
        let made: Vec<_> = lacking.par_iter().map(make).collect::<Result<_>>()?;
        self.made.extend(made);
        Ok(())
    }

    fn stand_in(&self, id: u32) -> Result<Option<Proxy>> {
        let member = |object: u32| Member {
            mesh: self.crowd.mesh(self.crowd.coarsest(object)),
            world_from_mesh: self.crowd.places[object as usize].as_dmat4(),
            look: self.look,
            objects: Objects::One(object),
            error: 0.0,
        };
        let members: Vec<Member<'_>> = self.members(id).into_iter().map(member).collect();
        let group = Group::new(&members)?;
        Ok(match self.kind {
            StandIns::Boxes => box_proxy(&group, &BoxOptions { blended: true })?,
            StandIns::Cards => impostor(
                &group,
                &ImpostorOptions {
                    pixels: TEXELS,
                    ..ImpostorOptions::default()
                },
            )?,
        })
    }
}

/// All objects that a list draws, as they are.
pub fn original(
    crowd: &Crowd,
    list: &DrawList,
    camera: &Camera,
    size: [u32; 2],
) -> Result<Picture> {
    let mut set = Set::of(crowd);
    for item in &list.items {
        if let Item::Object { object, .. } = *item {
            set.object(crowd, object, crowd.mesh_at(object, 0));
        }
    }
    set.picture(crowd, camera, size)
}

/// A camera with the field of view that levels are made for.
pub fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera {
        eye,
        target,
        up: Vec3::Y,
        projection: Projection::Perspective { fov_y: FOV_Y },
        near: None,
        far: None,
    }
}

/// Everything in one picture.
struct Set {
    instances: Vec<Instance>,
    stand_ins: Vec<TriMesh>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    images: Vec<Option<Picture>>,
    /// Meshes that are no stand-ins.
    meshes: u32,
}

impl Set {
    fn of(crowd: &Crowd) -> Self {
        let mut set = Self {
            instances: Vec::new(),
            stand_ins: Vec::new(),
            materials: crowd.scene.materials.clone(),
            textures: crowd.scene.textures.clone(),
            images: crowd.images.clone(),
            meshes: crowd.all_meshes().count() as u32,
        };
        for &(mesh, place) in &crowd.backdrop {
            set.place(mesh, place);
        }
        set
    }

    fn place(&mut self, mesh: u32, world_from_mesh: Mat4) {
        self.instances.push(Instance {
            mesh,
            node: None,
            world_from_mesh,
        });
    }

    fn object(&mut self, crowd: &Crowd, object: u32, mesh: u32) {
        self.place(mesh, crowd.places[object as usize]);
    }

    fn stand_in(&mut self, proxy: &Proxy) {
        let [materials, textures, images] =
            [self.materials.len(), self.textures.len(), self.images.len()].map(|n| n as u32);
        self.images.extend(proxy.pictures());
        let scene = &proxy.scene;
        self.textures.extend(scene.textures.iter().map(|t| Texture {
            image: t.image.map(|i| i + images),
            ..*t
        }));
        self.materials.extend(scene.materials.iter().cloned());
        for material in &mut self.materials[materials as usize..] {
            let used = [
                &mut material.base_color_texture,
                &mut material.metallic_roughness_texture,
                &mut material.normal_texture,
                &mut material.occlusion_texture,
                &mut material.emissive_texture,
            ];
            for used in used.into_iter().flatten() {
                used.texture += textures;
            }
        }
        let mut mesh = proxy.mesh().clone();
        for range in &mut mesh.ranges {
            range.material = range.material.map(|m| m + materials);
        }
        let index = self.meshes + self.stand_ins.len() as u32;
        self.stand_ins.push(mesh);
        self.place(index, DMat4::from_translation(proxy.origin).as_mat4());
    }

    fn picture(
        &self,
        crowd: &Crowd,
        camera: &Camera,
        [width, height]: [u32; 2],
    ) -> Result<Picture> {
        let model = Model {
            meshes: crowd.all_meshes().chain(&self.stand_ins).collect(),
            instances: self.instances.clone(),
            materials: &self.materials,
            textures: &self.textures,
            images: &self.images,
        };
        let options = RenderOptions {
            width,
            height,
            samples: 2,
            outputs: Outputs::COLOR,
            background: [170, 200, 230, 255],
            ..RenderOptions::default()
        };
        let sun = Light::Directional {
            direction: Vec3::new(0.5, -1.0, -0.4),
            color: Vec3::ONE,
            intensity: 0.9,
        };
        let renderer = Renderer::of_model(&model)?;
        Ok(renderer.frame(camera, &[sun], &options)?.color)
    }
}
