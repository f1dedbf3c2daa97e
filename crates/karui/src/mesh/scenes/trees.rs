//! Trees with the triangle counts of Kato, Kanoh and Nishihara 1998, table 2.

use super::build::{Painter, around, material};
use crate::mesh::{Material, TriMesh, random::Random};
use glam::Vec3;

/// Which tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TreeKind {
    /// The paper's tree A, 6 m high with a round crown: 20 triangles of trunk
    /// and 700 of leaves; simplified 6 and 12.
    Broad,
    /// The paper's tree B, a conifer 7 m high: 105 triangles; simplified 12.
    Conifer,
}

/// Materials of a scene of trees, by index.
pub(super) const BARK: u32 = 0;
pub(super) const RED: u32 = 3;

/// Bark, leaves of both kinds, red leaves.
pub(super) fn materials() -> Vec<Material> {
    vec![
        material("bark", [104, 76, 52], true),
        material("leaves", [98, 146, 58], true),
        material("needles", [52, 104, 66], true),
        material("red leaves", [188, 58, 38], true),
    ]
}

impl TreeKind {
    /// Radius of the crown in metres.
    pub(super) fn radius(self) -> f32 {
        match self {
            Self::Broad => 1.9,
            Self::Conifer => 1.6,
        }
    }

    /// Material of its leaves.
    pub(super) fn leaves(self, red: bool) -> u32 {
        match self {
            _ if red => RED,
            Self::Broad => 1,
            Self::Conifer => 2,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Broad => "broad",
            Self::Conifer => "conifer",
        }
    }
}

/// A tree that stands on the origin, different for every `seed`: trunk first,
/// material 0, then leaves, material 1 (broad), 2 (conifer) or 3 (red).
#[must_use]
pub fn tree_model(kind: TreeKind, red: bool, seed: u64) -> TriMesh {
    let mut tree = Painter::default();
    trunk(&mut tree, kind);
    tree.paint(BARK);
    crown(&mut tree, kind, seed);
    tree.paint(kind.leaves(red));
    tree.finish()
}

/// The simplified tree: 6 triangles of trunk and 12 of leaves for
/// [`TreeKind::Broad`], 12 in all for [`TreeKind::Conifer`].
#[must_use]
pub fn tree_lod(kind: TreeKind, red: bool) -> TriMesh {
    let mut tree = Painter::default();
    trunk_lod(&mut tree, kind);
    tree.paint(BARK);
    crown_lod(&mut tree, kind);
    tree.paint(kind.leaves(red));
    tree.finish()
}

pub(super) fn trunk(tree: &mut Painter, kind: TreeKind) {
    match kind {
        TreeKind::Broad => tube(tree, 10, [0.28, 0.14], [-0.3, 3.2]),
        TreeKind::Conifer => tube(tree, 5, [0.22, 0.16], [-0.3, 1.4]),
    }
}

pub(super) fn trunk_lod(tree: &mut Painter, kind: TreeKind) {
    match kind {
        TreeKind::Broad => tube(tree, 3, [0.3, 0.15], [-0.3, 3.2]),
        TreeKind::Conifer => cone(tree, 3, [0.3, -0.3, 1.6], |_| 1.0),
    }
}

pub(super) fn crown(tree: &mut Painter, kind: TreeKind, seed: u64) {
    let mut random = Random(seed);
    match kind {
        TreeKind::Broad => (0..350).for_each(|_| leaf(tree, &mut random)),
        TreeKind::Conifer => tiers(tree, &mut random),
    }
}

pub(super) fn crown_lod(tree: &mut Painter, kind: TreeKind) {
    match kind {
        TreeKind::Broad => octahedral(tree),
        TreeKind::Conifer => cone(tree, 9, [1.5, 1.0, 7.0], |_| 1.0),
    }
}

/// Two triangles a side.
fn tube(tree: &mut Painter, sides: u32, [low, high]: [f32; 2], [bottom, top]: [f32; 2]) {
    let corner = |i: u32, radius: f32, y: f32| {
        let out = around(i, sides) * radius;
        Vec3::new(out.x, y, out.y)
    };
    for i in 0..sides {
        let [a, b] = [i, i + 1].map(|i| corner(i, low, bottom));
        let [d, c] = [i, i + 1].map(|i| corner(i, high, top));
        tree.polygon(&[a, b, c, d], None);
    }
}

/// One triangle a side, open below. `reach` is a factor for each corner.
fn cone(tree: &mut Painter, sides: u32, size: [f32; 3], reach: impl Fn(u32) -> f32) {
    let [radius, bottom, top] = size;
    let corner = |i: u32| {
        let out = around(i, sides) * radius * reach(i % sides);
        Vec3::new(out.x, bottom, out.y)
    };
    for i in 0..sides {
        tree.polygon(&[corner(i), corner(i + 1), Vec3::Y * top], None);
    }
}

/// Five cones of 19 sides with ragged rims.
fn tiers(tree: &mut Painter, random: &mut Random) {
    for tier in 0..5 {
        let t = tier as f32;
        let reach: Vec<f32> = (0..19).map(|_| random.between(0.8, 1.05)).collect();
        let size = [1.5 - 0.24 * t, 0.9 + 1.1 * t, 3.0 + t];
        cone(tree, 19, size, |i| reach[i as usize]);
    }
}

const CROWN: Vec3 = Vec3::new(0.0, 4.2, 0.0);
const CROWN_RADII: Vec3 = Vec3::new(1.6, 1.55, 1.6);

/// A leafy twig, two triangles near the crown's surface, shaded like that.
fn leaf(tree: &mut Painter, random: &mut Random) {
    let out = random.in_ball().try_normalize().unwrap_or(Vec3::Y);
    let depth = random.between(0.7, 1.0);
    let centre = CROWN + out * CROWN_RADII * depth;
    let facing = (out + random.in_ball() * 0.9).normalize_or(out);
    let (right, up) = facing.any_orthonormal_pair();
    let size = random.between(0.22, 0.34);
    let corners = [-right - up, right - up, right + up, up - right];
    tree.polygon(&corners.map(|c| centre + c * size), Some(out));
}

/// A blunt double pyramid of six sides.
fn octahedral(tree: &mut Painter) {
    let rim = |i: u32| {
        let out = around(i, 6) * 1.75;
        CROWN + Vec3::new(out.x, 0.0, out.y)
    };
    let [top, bottom] = [1.75, -1.75].map(|y| CROWN + Vec3::Y * y);
    for i in 0..6 {
        tree.polygon(&[rim(i), rim(i + 1), top], None);
        tree.polygon(&[rim(i + 1), rim(i), bottom], None);
    }
}
