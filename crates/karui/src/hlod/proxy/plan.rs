//! Where the colours of a merged group go.

use super::bake::{Nearest, bake};
use super::budget::Budget;
use super::finish::Finish;
use super::group::Group;
use super::outfit::Outfit;
use super::paint::Paint;
use crate::error::Result;
use crate::geom::{Vec4, area};
use crate::mesh::{AlphaMode, Material, MaterialRange, TriMesh};

/// Largest difference between the colours of a triangle and a linear course, linear.
const ALIKE: f32 = 0.02;
/// Share of the area that may differ more.
const UNLIKE: f64 = 0.02;

/// Where the colours of a merged group go.
pub(super) enum Plan {
    /// Materials stay.
    Keep,
    /// Onto the vertices: they vary no faster than from corner to corner.
    Vertices(Classes),
    /// Into a texture.
    Texture(Classes),
}

/// Materials that are told apart only by what a renderer must know.
pub(super) struct Classes {
    pub of_slot: Vec<usize>,
    pub materials: Vec<Material>,
}

/// A mesh and what it is made of.
pub(super) struct Dressed {
    pub outfit: Outfit,
    pub mesh: TriMesh,
    pub coarser: bool,
}

impl Plan {
    pub fn of(group: &Group<'_>, most: usize, budget: &Budget) -> Self {
        let textured = group.slots.iter().any(is_textured);
        let used = (0..group.slots.len()).filter(|&s| group.mesh.ranges[s].count > 0);
        if used.count() <= most && image_pixels(group) <= budget.kept {
            return Self::Keep;
        }
        let classes = Classes::of(group);
        match textured && !is_linear(group) {
            true => Self::Texture(classes),
            false => Self::Vertices(classes),
        }
    }

    /// The mesh to simplify.
    pub fn source(&self, group: &Group<'_>) -> TriMesh {
        let mut mesh = group.mesh.clone();
        match self {
            Self::Keep => {}
            Self::Vertices(classes) => {
                mesh.attributes.colors = vec![vertex_colors(group)];
                mesh.attributes.uvs.clear();
                classes.regroup(&mut mesh);
            }
            Self::Texture(classes) => {
                mesh.attributes.colors.clear();
                mesh.attributes.uvs.clear();
                classes.regroup(&mut mesh);
            }
        }
        mesh
    }
}

/// All that simplified meshes need to be what the plan says.
pub(super) struct Wardrobe<'a> {
    group: &'a Group<'a>,
    plan: &'a Plan,
    nearest: Option<Nearest<'a>>,
}

impl<'a> Wardrobe<'a> {
    pub fn new(group: &'a Group<'a>, plan: &'a Plan) -> Result<Self> {
        let nearest = match plan {
            Plan::Texture(classes) => Some(Nearest::new(group, classes)?),
            Plan::Keep | Plan::Vertices(_) => None,
        };
        Ok(Self {
            group,
            plan,
            nearest,
        })
    }

    /// A simplified mesh, its colours where they are to be.
    pub fn dress(&self, mesh: TriMesh, budget: &Budget) -> Result<Dressed> {
        let outfit = match self.plan {
            Plan::Keep => Outfit::of(&self.group.slots),
            Plan::Vertices(classes) | Plan::Texture(classes) => Outfit {
                materials: classes.materials.clone(),
                ..Outfit::default()
            },
        };
        match &self.nearest {
            Some(nearest) => bake(nearest, outfit, mesh, budget),
            None => Ok(Dressed {
                outfit,
                mesh,
                coarser: false,
            }),
        }
    }
}

fn is_textured(slot: &super::group::Slot<'_>) -> bool {
    slot.look.colors.is_textured(slot.material)
}

/// Pixels of all images in use.
fn image_pixels(group: &Group<'_>) -> usize {
    let outfit = Outfit::of(&group.slots);
    let images = outfit.images.iter().flatten();
    images.map(|i| i.pixels().len()).sum()
}

/// Whether colours vary linearly over nearly all triangles.
fn is_linear(group: &Group<'_>) -> bool {
    let paint = Paint::new(group);
    let size = |t: usize| area(group.mesh.corners(t));
    let all = 0..group.mesh.triangles.len();
    let allowed = UNLIKE * all.clone().map(size).sum::<f64>();
    let mut unlike = 0.0;
    all.into_iter().all(|t| {
        unlike += if differs(&paint, t as u32) {
            size(t)
        } else {
            0.0
        };
        unlike <= allowed
    })
}

fn differs(paint: &Paint<'_>, t: u32) -> bool {
    const CORNERS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const BETWEEN: [[f64; 3]; 4] = [
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    ];
    let corners = CORNERS.map(|w| paint.color(t, w, 0.0));
    BETWEEN.iter().any(|w| {
        let mean = (0..3).map(|k| corners[k] * w[k] as f32).sum::<Vec4>();
        let difference = (paint.color(t, *w, 0.0) - mean).abs();
        difference.max_element() > ALIKE
    })
}

fn vertex_colors(group: &Group<'_>) -> Vec<Vec4> {
    let paint = Paint::new(group);
    let mut colors = vec![Vec4::ONE; group.mesh.positions.len()];
    for (t, triangle) in group.mesh.triangles.iter().enumerate() {
        for (k, &v) in triangle.iter().enumerate() {
            let weights = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
            colors[v as usize] = paint.color(t as u32, weights, 0.0);
        }
    }
    colors
}

impl Classes {
    fn of(group: &Group<'_>) -> Self {
        let mut kinds: Vec<(u32, bool)> = Vec::new();
        let mut of_slot = Vec::with_capacity(group.slots.len());
        for slot in &group.slots {
            let material = slot.material();
            let double_sided = material.is_none_or(|m| m.double_sided);
            let kind = (material.map_or(0, |m| rank(m.alpha_mode)), double_sided);
            let known = kinds.iter().position(|k| *k == kind);
            of_slot.push(known.unwrap_or(kinds.len()));
            if known.is_none() {
                kinds.push(kind);
            }
        }
        let material = |(class, &(alpha, double_sided)): (usize, &(u32, bool))| Material {
            alpha_mode: mode(alpha),
            double_sided,
            ..Finish::of(group, |slot| of_slot[slot] == class).material()
        };
        let materials = kinds.iter().enumerate().map(material).collect();
        Self { of_slot, materials }
    }

    /// Triangles in the order of their classes, a range each.
    fn regroup(&self, mesh: &mut TriMesh) {
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        let mut ranges = Vec::with_capacity(self.materials.len());
        for class in 0..self.materials.len() {
            let first = triangles.len() as u32;
            for (slot, range) in mesh.ranges.iter().enumerate() {
                if self.of_slot[slot] == class {
                    triangles.extend_from_slice(&mesh.triangles[range.triangles()]);
                }
            }
            ranges.push(MaterialRange {
                first,
                count: triangles.len() as u32 - first,
                material: Some(class as u32),
                source: None,
            });
        }
        (mesh.triangles, mesh.ranges) = (triangles, ranges);
    }
}

fn rank(mode: AlphaMode) -> u32 {
    match mode {
        AlphaMode::Opaque => 0,
        AlphaMode::Mask(_) => 1,
        AlphaMode::Blend => 2,
    }
}

fn mode(rank: u32) -> AlphaMode {
    match rank {
        0 => AlphaMode::Opaque,
        1 => AlphaMode::Mask(0.5),
        _ => AlphaMode::Blend,
    }
}
