//! A city.

use super::build::{Places, add_places};
use super::city_parts::{CityParts, CityRole};
use crate::error::{Error, Result};
use crate::mesh::{Scene, random::Random};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Side of a tile.
const TILE: f32 = 2.0;
/// Height at which things stand on a tile.
const TOP: f32 = 0.1;

/// What a city is like.
#[derive(Debug, Clone, PartialEq)]
pub struct CityOptions {
    /// Number of objects: tiles of streets and houses, cars, lights, bushes and
    /// what else stands around. Default 1000.
    pub count: usize,
    /// Another number, another city. Default 1.
    pub seed: u64,
    /// Tiles from one street to the next, 1 to 100. Default 3.
    pub block: u32,
    /// Mean number of cars a tile of street, 0 to 2. Default 0.5.
    pub traffic: f32,
}

impl Default for CityOptions {
    fn default() -> Self {
        Self {
            count: 1000,
            seed: 1,
            block: 3,
            traffic: 0.5,
        }
    }
}

impl CityOptions {
    fn check(&self) -> Result<()> {
        let bad = |option, found: String, expected| {
            Err(Error::BadOption {
                option,
                found,
                expected,
            })
        };
        if !(1..=100).contains(&self.block) {
            return bad("block", self.block.to_string(), "from 1 to 100");
        }
        if !(0.0..=2.0).contains(&self.traffic) {
            return bad("traffic", self.traffic.to_string(), "from 0 to 2");
        }
        if self.count > u32::MAX as usize {
            return bad("count", self.count.to_string(), "below 2^32");
        }
        Ok(())
    }
}

/// Exactly [`CityOptions::count`] objects on a grid of streets around the
/// origin, one node a mesh of `parts` that is used. More objects are the same
/// city and more of it, ring by ring.
///
/// # Errors
/// [`Error::BadOption`] for options out of range, [`Error::Empty`] if no part
/// is a house or an empty tile.
pub fn city(options: &CityOptions, parts: &CityParts) -> Result<Scene> {
    options.check()?;
    let mut streets = Streets::new(options, parts)?;
    let mut ring = 0;
    while streets.left > 0 {
        for (i, j) in tiles_of(ring) {
            streets.tile(i, j);
        }
        ring += 1;
    }
    let mut scene = parts.scene.clone();
    for (mesh, places) in (0u32..).zip(streets.places) {
        add_places(&mut scene, mesh, places);
    }
    Ok(scene)
}

/// Tiles at a distance of `ring` from the middle one, in rows.
fn tiles_of(ring: i64) -> impl Iterator<Item = (i64, i64)> {
    let row = move |j: i64| {
        let step = if j.abs() == ring {
            1
        } else {
            (2 * ring).max(1)
        };
        (-ring..=ring).step_by(step as usize).map(move |i| (i, j))
    };
    (-ring..=ring).flat_map(row)
}

/// A city as it grows.
struct Streets<'a> {
    options: &'a CityOptions,
    left: usize,
    /// By mesh.
    places: Vec<Places>,
    /// Meshes by role, in the order of [`ROLES`].
    meshes: [Vec<u32>; 8],
}

const ROLES: [CityRole; 8] = [
    CityRole::Building,
    CityRole::Plot,
    CityRole::Road,
    CityRole::Junction,
    CityRole::Car,
    CityRole::Light,
    CityRole::Bush,
    CityRole::Thing,
];

impl<'a> Streets<'a> {
    fn new(options: &'a CityOptions, parts: &CityParts) -> Result<Self> {
        let meshes = ROLES.map(|role| parts.of(role));
        if meshes[0].is_empty() && meshes[1].is_empty() {
            return Err(Error::Empty {
                what: "list of houses and plots",
            });
        }
        Ok(Self {
            options,
            left: options.count,
            places: parts.roles.iter().map(|_| Places::default()).collect(),
            meshes,
        })
    }

    /// Adds one of the parts of a role, if there are any and objects are left.
    fn add(&mut self, role: CityRole, random: &mut Random, at: Vec3, yaw: f32) {
        let meshes = &self.meshes[role as usize];
        if self.left > 0 && !meshes.is_empty() {
            self.left -= 1;
            let mesh = meshes[random.below(meshes.len())];
            self.places[mesh as usize].push(at, yaw, 1.0);
        }
    }

    fn tile(&mut self, i: i64, j: i64) {
        let random = &mut Random::of_cell(self.options.seed, i, j);
        let period = i64::from(self.options.block) + 1;
        let (across, along) = (i.rem_euclid(period), j.rem_euclid(period));
        let centre = Vec3::new(i as f32, 0.0, j as f32) * TILE;
        match (across, along) {
            (0, 0) => self.add(CityRole::Junction, random, centre, 0.0),
            (0, _) => self.street(random, centre, 0.0),
            (_, 0) => self.street(random, centre, FRAC_PI_2),
            _ => self.plot(random, centre, [across, along], period),
        }
    }

    /// A tile of street along z, turned by `yaw`.
    fn street(&mut self, random: &mut Random, centre: Vec3, yaw: f32) {
        self.add(CityRole::Road, random, centre, yaw);
        let beside = |x: f32, y: f32, z: f32| centre + turned(Vec3::new(x, y, z), yaw);
        for side in [0.0, PI] {
            let lane = if side == 0.0 { -0.3 } else { 0.3 };
            if random.next() < self.options.traffic * 0.5 {
                let z = random.between(-0.5, 0.5);
                self.add(CityRole::Car, random, beside(lane, TOP, z), yaw + side);
            }
        }
        for (side, x) in [(0.0, 0.92), (PI, -0.92)] {
            let draw = random.next();
            let z = random.between(0.2, 0.8);
            if draw < 0.35 {
                self.add(CityRole::Light, random, beside(x, TOP, 0.0), yaw + side);
            } else if draw < 0.55 {
                self.add(
                    CityRole::Thing,
                    random,
                    beside(x, TOP, z),
                    yaw + side + FRAC_PI_2,
                );
            }
        }
    }

    /// A house that looks at the nearest street, or green where there is none.
    fn plot(&mut self, random: &mut Random, centre: Vec3, place: [i64; 2], period: i64) {
        let last = period - 1;
        let front = match place {
            [_, 1] => Some(PI),
            [_, along] if along == last => Some(0.0),
            [1, _] => Some(-FRAC_PI_2),
            [across, _] if across == last => Some(FRAC_PI_2),
            _ => None,
        };
        let built = !self.meshes[CityRole::Building as usize].is_empty();
        match front.filter(|_| built && random.next() < 0.92) {
            Some(yaw) => self.add(CityRole::Building, random, centre, yaw),
            None => {
                self.add(CityRole::Plot, random, centre, 0.0);
                for _ in 0..random.below(7) {
                    let (x, z) = (random.between(-0.8, 0.8), random.between(-0.8, 0.8));
                    let yaw = random.between(0.0, PI);
                    self.add(CityRole::Bush, random, centre + Vec3::new(x, TOP, z), yaw);
                }
            }
        }
    }
}

/// A vector turned about y by a quarter turn, exactly, unless `yaw` is 0.
fn turned(v: Vec3, yaw: f32) -> Vec3 {
    if yaw == 0.0 {
        v
    } else {
        Vec3::new(v.z, v.y, -v.x)
    }
}
