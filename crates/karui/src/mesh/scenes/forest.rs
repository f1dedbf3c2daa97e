//! A forest.

use super::build::{Places, add_mesh, add_places, add_root, material};
use super::ground::Ground;
use super::trees::{TreeKind, materials, tree_lod, tree_model};
use crate::error::{Error, Result};
use crate::mesh::{LodLinks, Node, Scene, random::Random};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Trees are this much smaller or larger than their model.
const SCALES: [f32; 2] = [0.8, 1.25];
/// Share of the cells of the grid that have a tree.
const FILLED: f64 = 0.8;

/// What a forest is like.
#[derive(Debug, Clone, PartialEq)]
pub struct ForestOptions {
    /// Number of trees. Default 1000.
    pub count: usize,
    /// Another number, another forest. Default 1.
    pub seed: u64,
    /// Kinds of trees, equally frequent. Default both.
    pub kinds: Vec<TreeKind>,
    /// Different meshes a kind and colour, at least 1. Default 4.
    pub variants: u32,
    /// Share of red trees, 0 to 1. Default 0.
    pub red: f32,
    /// Mean distance of neighbours in metres. Crowns are up to 4.75 wide; from
    /// there on none touch. Default 6.
    pub spacing: f32,
    /// Whether each tree has its simplified form as a level of detail.
    /// Default `true`.
    pub lods: bool,
    /// Whether there is ground below, as one more object. Default `true`.
    pub ground: bool,
}

impl Default for ForestOptions {
    fn default() -> Self {
        Self {
            count: 1000,
            seed: 1,
            kinds: vec![TreeKind::Broad, TreeKind::Conifer],
            variants: 4,
            red: 0.0,
            spacing: 6.0,
            lods: true,
            ground: true,
        }
    }
}

impl ForestOptions {
    fn check(&self) -> Result<()> {
        let bad = |option, found: String, expected| {
            Err(Error::BadOption {
                option,
                found,
                expected,
            })
        };
        if self.kinds.is_empty() {
            return bad("kinds", "empty".into(), "at least one kind");
        }
        if !(1..=1000).contains(&self.variants) {
            return bad("variants", self.variants.to_string(), "from 1 to 1000");
        }
        if !(0.0..=1.0).contains(&self.red) {
            return bad("red", self.red.to_string(), "from 0 to 1");
        }
        if !(self.spacing > 0.0 && self.spacing <= 1e6) {
            return bad("spacing", self.spacing.to_string(), "above 0, at most 1e6");
        }
        if self.count > u32::MAX as usize {
            return bad("count", self.count.to_string(), "below 2^32");
        }
        Ok(())
    }
}

/// Exactly [`ForestOptions::count`] trees on rolling ground around the origin,
/// one node a tree mesh.
///
/// # Errors
/// [`Error::BadOption`] for options out of range.
pub fn forest(options: &ForestOptions) -> Result<Scene> {
    options.check()?;
    let mut scene = Scene {
        materials: materials(),
        ..Scene::default()
    };
    let columns = ((options.count as f64 / FILLED).sqrt().ceil() as usize).max(1);
    let ground = Ground::new(columns as f32 * options.spacing, options.seed);
    let places = plant(options, columns, &ground);
    for (number, places) in places.into_iter().enumerate() {
        add_tree(&mut scene, options, number, places);
    }
    if options.ground {
        let green = scene.materials.len() as u32;
        scene
            .materials
            .push(material("ground", [120, 128, 84], false));
        let mesh = add_mesh(&mut scene, "ground", ground.mesh(green));
        let name = Some("ground".into());
        add_root(
            &mut scene,
            Node {
                name,
                mesh: Some(mesh),
                ..Node::default()
            },
        );
    }
    Ok(scene)
}

/// Where the trees of every mesh stand: in cells of a grid, moved within them
/// as far as no two can touch.
fn plant(options: &ForestOptions, columns: usize, ground: &Ground) -> Vec<Places> {
    let mut random = Random(options.seed);
    let models = options.kinds.len() * options.variants as usize;
    let mut places: Vec<Places> = (0..2 * models).map(|_| Places::default()).collect();
    let radii = options.kinds.iter().map(|k| k.radius());
    let radius = radii.fold(0.0, f32::max) * SCALES[1];
    let free = (options.spacing * 0.5 - radius).max(0.0);
    let cells = columns * columns;
    let mut left = options.count;
    for cell in 0..cells {
        // Of the cells to come, each has a tree with the same probability
        // (selection sampling, Knuth, TAOCP vol. 2, algorithm 3.4.2 S).
        if random.below(cells - cell) >= left {
            continue;
        }
        left -= 1;
        let corner = Vec2::new((cell % columns) as f32, (cell / columns) as f32);
        let jitter = Vec2::new(random.between(-free, free), random.between(-free, free));
        let centre = corner + 0.5 - columns as f32 * 0.5;
        let at = centre * options.spacing + jitter;
        let model = 2 * random.below(models) + usize::from(random.next() < options.red);
        let yaw = random.between(0.0, TAU);
        let scale = random.between(SCALES[0], SCALES[1]);
        let place = Vec3::new(at.x, ground.height(at), at.y);
        places[model].push(place, yaw, scale);
    }
    places
}

fn add_tree(scene: &mut Scene, options: &ForestOptions, number: usize, places: Places) {
    if places.is_empty() {
        return;
    }
    let (model, red) = (number / 2, number % 2 == 1);
    let kind = options.kinds[model / options.variants as usize];
    let variant = model % options.variants as usize;
    let colour = if red { "red " } else { "" };
    let name = format!("{colour}{} {variant}", kind.name());
    let seed = options.seed.wrapping_add(model as u64);
    let mesh = add_mesh(scene, &name, tree_model(kind, red, seed));
    let node = add_places(scene, mesh, places);
    if let (Some(node), true) = (node, options.lods) {
        let name = format!("{name} simplified");
        let mesh = add_mesh(scene, &name, tree_lod(kind, red));
        link_lod(scene, node, &name, mesh);
    }
}

/// Adds a node that stands in for `node` with a simplified mesh.
pub(super) fn link_lod(scene: &mut Scene, node: u32, name: &str, mesh: u32) {
    let shown = &scene.nodes[node as usize];
    let stand_in = Node {
        name: Some(name.into()),
        mesh: Some(mesh),
        ..shown.clone()
    };
    let index = scene.nodes.len() as u32;
    scene.nodes[node as usize].lods = Some(LodLinks {
        nodes: vec![index],
        coverage: vec![0.1, 0.0],
    });
    scene.nodes.push(stand_in);
}
