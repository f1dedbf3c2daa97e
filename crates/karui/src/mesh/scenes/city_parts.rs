//! What a city is made of.

use super::build::{Painter, add_mesh, material};
use crate::error::Result;
use crate::mesh::{Material, Scene, Texture, TextureRef, TriMesh, shapes};
use glam::{Mat4, Vec3};

/// What a part of a city is used as. Tiles are 2 x 2 units with their centre
/// at the origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CityRole {
    /// A tile with a house, its front at +z.
    Building,
    /// An empty tile.
    Plot,
    /// A tile with a straight street along z.
    Road,
    /// A tile where streets cross.
    Junction,
    /// A vehicle that drives towards +z.
    Car,
    /// A street light, its arm towards -x.
    Light,
    /// A bush.
    Bush,
    /// Any small thing of the street.
    Thing,
}

impl CityRole {
    /// By the name of a part of the KayKit City Builder pack (`car_taxi`);
    /// `None` for parts that a city does not use.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        let things = ["bench", "dumpster", "firehydrant", "trash_", "box_"];
        Some(match name {
            "base" => Self::Plot,
            "road_straight" => Self::Road,
            "road_junction" => Self::Junction,
            "streetlight" => Self::Light,
            "bush" => Self::Bush,
            _ if name.ends_with("_withoutBase") => return None,
            _ if name.starts_with("building_") => Self::Building,
            _ if name.starts_with("car_") => Self::Car,
            _ if things.iter().any(|t| name.starts_with(t)) => Self::Thing,
            _ => return None,
        })
    }
}

/// Meshes for a city, with their materials.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CityParts {
    /// Meshes, materials, textures and images; no nodes.
    pub(super) scene: Scene,
    /// What every mesh is used as.
    pub(super) roles: Vec<CityRole>,
}

impl CityParts {
    /// Adds a part: all that `part` shows, as one mesh. Materials, textures and
    /// images that are there already are not added again.
    ///
    /// # Errors
    /// Those of [`Scene::validate`] and [`Scene::into_single_mesh`].
    pub fn add(&mut self, name: &str, role: CityRole, part: Scene) -> Result<()> {
        part.validate()?;
        let known = part.images.iter().map(|i| place(&mut self.scene.images, i));
        let images: Vec<u32> = known.collect();
        let textures = part.textures.iter().map(|texture| {
            let image = texture.image.map(|i| images[i as usize]);
            let texture = Texture { image, ..*texture };
            place(&mut self.scene.textures, &texture)
        });
        let textures: Vec<u32> = textures.collect();
        let materials = part.materials.iter().map(|material| {
            let material = renumbered(material.clone(), &textures);
            place(&mut self.scene.materials, &material)
        });
        let materials: Vec<u32> = materials.collect();
        let mut mesh = part.into_single_mesh()?;
        for range in &mut mesh.ranges {
            range.material = range.material.map(|m| materials[m as usize]);
            range.source = None;
        }
        self.push(name, role, mesh);
        Ok(())
    }

    fn push(&mut self, name: &str, role: CityRole, mesh: TriMesh) {
        add_mesh(&mut self.scene, name, mesh);
        self.roles.push(role);
    }

    /// Meshes of a role.
    pub(super) fn of(&self, role: CityRole) -> Vec<u32> {
        let meshes = (0u32..).zip(&self.roles);
        meshes
            .filter(|(_, r)| **r == role)
            .map(|(m, _)| m)
            .collect()
    }

    /// Plain parts: blocks as houses and cars, in several sizes and colours.
    #[must_use]
    pub fn built_in() -> Self {
        let mut parts = Self::default();
        parts.scene.materials = materials();
        for (i, &[width, height, depth]) in HOUSES.iter().enumerate() {
            let house = house(
                FIRST_WALL + i as u32 % WALLS.len() as u32,
                [width, height, depth],
            );
            parts.push(&format!("house {i}"), CityRole::Building, house);
        }
        for i in 0..PAINTS.len() as u32 {
            let car = car(FIRST_WALL + WALLS.len() as u32 + i);
            parts.push(&format!("car {i}"), CityRole::Car, car);
        }
        parts.push("plot", CityRole::Plot, plate(GRASS));
        parts.push("road", CityRole::Road, road());
        parts.push("junction", CityRole::Junction, plate(ASPHALT));
        parts.push("light", CityRole::Light, light());
        parts.push("bush", CityRole::Bush, bush());
        parts
    }
}

/// Index of a value in a list, to which it is added if need be.
fn place<T: Clone + PartialEq>(list: &mut Vec<T>, value: &T) -> u32 {
    let known = list.iter().position(|v| v == value);
    known.unwrap_or_else(|| {
        list.push(value.clone());
        list.len() - 1
    }) as u32
}

fn renumbered(mut material: Material, textures: &[u32]) -> Material {
    let used: [&mut Option<TextureRef>; 5] = [
        &mut material.base_color_texture,
        &mut material.metallic_roughness_texture,
        &mut material.normal_texture,
        &mut material.occlusion_texture,
        &mut material.emissive_texture,
    ];
    for texture in used.into_iter().flatten() {
        texture.texture = textures[texture.texture as usize];
    }
    material
}

const ASPHALT: u32 = 0;
const GRASS: u32 = 1;
const STONE: u32 = 2;
const GLASS: u32 = 3;
const LEAVES: u32 = 4;
const LAMP: u32 = 5;
const FIRST_WALL: u32 = 6;
const WALLS: [[u8; 3]; 5] = [
    [196, 120, 92],
    [214, 196, 160],
    [150, 164, 178],
    [226, 222, 212],
    [128, 96, 84],
];
const PAINTS: [[u8; 3]; 4] = [
    [198, 44, 40],
    [42, 84, 160],
    [232, 190, 50],
    [236, 236, 238],
];
/// Width, height and depth.
const HOUSES: [[f32; 3]; 8] = [
    [1.2, 0.9, 1.1],
    [1.5, 1.3, 1.2],
    [1.3, 1.8, 1.3],
    [1.6, 2.2, 1.4],
    [1.1, 2.9, 1.1],
    [1.4, 3.6, 1.4],
    [1.0, 1.2, 1.5],
    [1.6, 0.7, 1.6],
];
/// Height of tiles.
const TILE: f32 = 0.1;

fn materials() -> Vec<Material> {
    let plain = [
        ("asphalt", [72, 74, 80]),
        ("grass", [124, 158, 92]),
        ("stone", [176, 174, 168]),
        ("glass", [70, 92, 112]),
        ("leaves", [84, 136, 60]),
        ("lamp", [250, 238, 190]),
    ];
    let plain = plain.map(|(name, colour)| material(name, colour, false));
    let walls = WALLS.map(|colour| material("wall", colour, false));
    let paints = PAINTS.map(|colour| material("paint", colour, false));
    plain.into_iter().chain(walls).chain(paints).collect()
}

fn slab(painter: &mut Painter) {
    painter.block(
        [Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, TILE, 1.0)],
        false,
    );
}

fn plate(material: u32) -> TriMesh {
    let mut plate = Painter::default();
    slab(&mut plate);
    plate.paint(material);
    plate.finish()
}

fn road() -> TriMesh {
    let mut road = Painter::default();
    slab(&mut road);
    road.paint(ASPHALT);
    for side in [-0.85f32, 0.85] {
        let low = Vec3::new(side - 0.15, TILE, -1.0);
        road.block([low, low + Vec3::new(0.3, 0.02, 2.0)], false);
    }
    road.paint(STONE);
    road.finish()
}

/// A house on its plot; bands of windows run around it.
fn house(wall: u32, [width, height, depth]: [f32; 3]) -> TriMesh {
    let mut house = Painter::default();
    slab(&mut house);
    house.paint(STONE);
    let half = Vec3::new(width, 0.0, depth) * 0.5;
    let block = |painter: &mut Painter, grow: f32, from: f32, to: f32| {
        let wide = half + Vec3::new(grow, 0.0, grow);
        painter.block(
            [
                -wide + Vec3::Y * (TILE + from),
                wide + Vec3::Y * (TILE + to),
            ],
            false,
        );
    };
    block(&mut house, 0.0, 0.0, height);
    house.paint(wall);
    let floors = (height / 0.4) as u32;
    for floor in 0..floors {
        let at = 0.12 + 0.4 * floor as f32;
        block(&mut house, 0.01, at, at + 0.18);
    }
    house.paint(GLASS);
    house.finish()
}

fn car(paint: u32) -> TriMesh {
    let mut car = Painter::default();
    car.block(
        [Vec3::new(-0.19, 0.05, -0.45), Vec3::new(0.19, 0.18, 0.45)],
        true,
    );
    car.paint(paint);
    car.block(
        [Vec3::new(-0.16, 0.18, -0.28), Vec3::new(0.16, 0.3, 0.2)],
        false,
    );
    car.paint(GLASS);
    car.finish()
}

fn light() -> TriMesh {
    let mut light = Painter::default();
    light.block(
        [Vec3::new(-0.02, 0.0, -0.02), Vec3::new(0.02, 0.95, 0.02)],
        false,
    );
    light.block(
        [
            Vec3::new(-0.24, 0.92, -0.015),
            Vec3::new(-0.02, 0.95, 0.015),
        ],
        true,
    );
    light.paint(STONE);
    light.block(
        [Vec3::new(-0.24, 0.89, -0.03), Vec3::new(-0.14, 0.92, 0.03)],
        true,
    );
    light.paint(LAMP);
    light.finish()
}

fn bush() -> TriMesh {
    let small =
        Mat4::from_translation(Vec3::Y * 0.16) * Mat4::from_scale(Vec3::new(0.14, 0.18, 0.14));
    let mut bush = shapes::icosphere(1).transformed(small);
    bush.ranges = vec![crate::mesh::MaterialRange {
        first: 0,
        count: bush.triangles.len() as u32,
        material: Some(LEAVES),
        source: None,
    }];
    bush
}
