//! Colours of the members as a texture of the merged mesh.

use super::budget::Budget;
use super::charts::{Chart, charts};
use super::dilate::{Texels, dilate};
use super::group::Group;
use super::outfit::Outfit;
use super::pack::{Packed, pack};
use super::paint::Paint;
use super::plan::{Classes, Dressed};
use crate::error::Result;
use crate::geom::{DVec3, Vec2, Vec4, interpolate, normal_times_two_areas};
use crate::mesh::{Texture, TextureRef, TriMesh, Wrap};
use crate::render::{Picture, encoded};
use crate::spatial::{Bvh, Hit};
use rayon::prelude::*;

/// Texels around every chart; two charts have twice as many between them.
const GUTTER: u32 = 1;
/// A texture that does not fit is made coarser by this factor, until it does.
const COARSER: f64 = 1.12;
/// How often: texels then are three thousand times as large.
const ATTEMPTS: usize = 72;

/// Charts and where they lie in the texture.
struct Atlas {
    charts: Vec<Chart>,
    packed: Packed,
    /// Side of a texel, model units.
    texel: f64,
    coarser: bool,
}

/// Bakes what is nearest on the members' surface. `mesh` has the classes as its
/// ranges and no UVs; where it has more charts than the texture has room for, its
/// vertices are coloured instead.
pub(super) fn bake(
    nearest: &Nearest<'_>,
    mut outfit: Outfit,
    mesh: TriMesh,
    budget: &Budget,
) -> Result<Dressed> {
    let Some(atlas) = Atlas::of(&mesh, budget) else {
        let mesh = nearest.painted(mesh, budget.texel);
        let coarser = true;
        return Ok(Dressed {
            outfit,
            mesh,
            coarser,
        });
    };
    let picture = atlas.picture(&mesh, nearest)?;
    outfit.images = vec![Some(picture)];
    outfit.textures = vec![Texture {
        image: Some(0),
        wrap: [Wrap::Clamp; 2],
        nearest: false,
    }];
    for material in &mut outfit.materials {
        material.base_color_texture = Some(TextureRef {
            texture: 0,
            uv_set: 0,
            transform: None,
        });
    }
    Ok(Dressed {
        outfit,
        mesh: atlas.unwrapped(mesh),
        coarser: atlas.coarser,
    })
}

impl Atlas {
    /// `None` if there are too many charts for any size of texels.
    fn of(mesh: &TriMesh, budget: &Budget) -> Option<Self> {
        let charts = charts(mesh);
        let mut texel = budget.texel;
        for attempt in 0..ATTEMPTS {
            let sizes: Vec<[u32; 2]> = charts.iter().map(|c| texels(c, texel)).collect();
            if let Some(packed) = pack(&sizes, budget.side) {
                let coarser = attempt > 0 || budget.coarser;
                return Some(Self {
                    charts,
                    packed,
                    texel,
                    coarser,
                });
            }
            texel *= COARSER;
        }
        None
    }

    /// In texels of the whole texture.
    fn place(&self, chart: usize, p: DVec3) -> [f64; 2] {
        let [x, y] = self.packed.places[chart].map(|at| f64::from(at + GUTTER) + 0.5);
        let [u, v] = self.charts[chart].place(p).map(|along| along / self.texel);
        [x + u, y + v]
    }

    /// Vertices apart where charts are.
    fn unwrapped(&self, mesh: TriMesh) -> TriMesh {
        let mut mesh = mesh;
        let mut sources = Vec::with_capacity(mesh.positions.len());
        let mut uvs = Vec::with_capacity(mesh.positions.len());
        let mut taken = vec![(u32::MAX, u32::MAX); mesh.positions.len()];
        let by = [self.packed.width, self.packed.height].map(f64::from);
        for (c, chart) in (0u32..).zip(&self.charts) {
            for &t in &chart.triangles {
                for k in 0..3 {
                    let v = mesh.triangles[t as usize][k];
                    let known = &mut taken[v as usize];
                    if known.0 != c {
                        *known = (c, sources.len() as u32);
                        sources.push(v);
                        let place = mesh.positions[v as usize].as_dvec3();
                        let [x, y] = self.place(c as usize, place);
                        uvs.push(Vec2::new((x / by[0]) as f32, (y / by[1]) as f32));
                    }
                    mesh.triangles[t as usize][k] = known.1;
                }
            }
        }
        mesh.gather_vertices(&sources);
        mesh.attributes.uvs = vec![uvs];
        mesh
    }

    fn picture(&self, mesh: &TriMesh, nearest: &Nearest<'_>) -> Result<Picture> {
        let (width, height) = (self.packed.width as usize, self.packed.height as usize);
        let mut pixels = vec![[0; 4]; width * height];
        let mut known = vec![false; width * height];
        let range_of = mesh.range_of_triangles();
        let baked: Vec<Vec<(usize, [u8; 4])>> = (0..self.charts.len())
            .into_par_iter()
            .map(|c| self.bake_chart(c, mesh, nearest, &range_of))
            .collect();
        for (at, color) in baked.into_iter().flatten() {
            (pixels[at], known[at]) = (color, true);
        }
        dilate(&mut pixels, width, &mut known, Texels::Colors);
        Picture::new(self.packed.width, self.packed.height, pixels)
    }

    /// Texels of a chart and their colours.
    fn bake_chart(
        &self,
        c: usize,
        mesh: &TriMesh,
        nearest: &Nearest<'_>,
        range_of: &[u32],
    ) -> Vec<(usize, [u8; 4])> {
        let mut found = Vec::new();
        let mut near = None;
        for &t in &self.charts[c].triangles {
            let corners = mesh.corners(t as usize);
            let normal = normal_times_two_areas(corners).normalize_or_zero();
            let class = range_of[t as usize] as usize;
            self.visit(c, corners, |at, p| {
                // A little outside: of two sides of a thin wall, this one.
                let p = p + normal * (0.25 * self.texel);
                let color = nearest.color(class, p, self.texel, &mut near);
                found.push((at, encoded(color)));
            });
        }
        found
    }

    /// Texels whose middle a triangle covers, or the one its own middle is in.
    fn visit(&self, c: usize, corners: [DVec3; 3], mut visit: impl FnMut(usize, DVec3)) {
        let width = self.packed.width as usize;
        let [a, b, d] = corners.map(|p| self.place(c, p));
        let double = (b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]);
        let range = |k: usize| {
            let (least, most) = (a[k].min(b[k]).min(d[k]), a[k].max(b[k]).max(d[k]));
            (least - 0.5).ceil() as usize..(most + 0.5).floor() as usize
        };
        let mut none = true;
        for (y, x) in range(1).flat_map(|y| range(0).map(move |x| (y, x))) {
            let p = [x as f64 + 0.5, y as f64 + 0.5];
            let side = |from: [f64; 2], to: [f64; 2]| {
                let turn =
                    (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]);
                turn / double
            };
            let weights = [side(b, d), side(d, a), side(a, b)];
            if weights.iter().all(|w| *w >= 0.0) {
                none = false;
                visit(y * width + x, interpolate(corners, weights));
            }
        }
        if none {
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let [x, y] = self.place(c, middle);
            visit(y as usize * width + x as usize, middle);
        }
    }
}

/// Texels that a chart takes, gutters included: its corners lie in the middle of
/// texels, so that filtering takes in no others.
fn texels(chart: &Chart, texel: f64) -> [u32; 2] {
    chart
        .size
        .map(|extent| (extent / texel).ceil().min(1e6) as u32 + 1 + 2 * GUTTER)
}

/// The members' surface, class by class.
pub(super) struct Nearest<'a> {
    paint: Paint<'a>,
    trees: Vec<Option<Tree<'a>>>,
}

/// A part of the members' surface.
enum Tree<'a> {
    Whole(&'a Bvh),
    /// A tree, and what triangle of the group each of its triangles is.
    Part(Bvh, Vec<u32>),
}

impl<'a> Nearest<'a> {
    pub fn new(group: &'a Group<'a>, classes: &Classes) -> Result<Self> {
        let paint = Paint::new(group);
        let trees = match classes.materials.len() {
            1 => vec![Some(Tree::Whole(group.tree()?))],
            count => (0..count)
                .map(|class| part(group, |t| classes.of_slot[paint.slot(t)] == class))
                .collect::<Result<_>>()?,
        };
        Ok(Self { paint, trees })
    }

    fn color(&self, class: usize, p: DVec3, texel: f64, near: &mut Option<Hit>) -> Vec4 {
        let Some(tree) = &self.trees[class] else {
            return Vec4::ONE;
        };
        let bvh = match tree {
            Tree::Whole(bvh) => bvh,
            Tree::Part(bvh, _) => bvh,
        };
        let hit = match near {
            Some(near) => bvh.closest_near(p, near),
            None => bvh.closest(p),
        };
        let triangle = match tree {
            Tree::Whole(_) => hit.triangle,
            Tree::Part(_, triangles) => triangles[hit.triangle as usize],
        };
        *near = Some(hit);
        self.paint.color(triangle, hit.barycentric, texel)
    }

    /// With the colours on the vertices.
    fn painted(&self, mut mesh: TriMesh, texel: f64) -> TriMesh {
        let mut colors = vec![Vec4::ONE; mesh.positions.len()];
        for (class, range) in mesh.ranges.iter().enumerate() {
            let mut near = None;
            for &v in mesh.triangles[range.triangles()].iter().flatten() {
                let p = mesh.positions[v as usize].as_dvec3();
                colors[v as usize] = self.color(class, p, texel, &mut near);
            }
        }
        mesh.attributes.colors = vec![colors];
        mesh
    }
}

/// The triangles chosen; `None` if there are none.
fn part<'a>(group: &'a Group<'a>, chosen: impl Fn(u32) -> bool) -> Result<Option<Tree<'a>>> {
    let all = 0..group.mesh.triangles.len() as u32;
    let chosen: Vec<u32> = all.filter(|&t| chosen(t)).collect();
    if chosen.is_empty() {
        return Ok(None);
    }
    let triangles = chosen.iter().map(|&t| group.mesh.triangles[t as usize]);
    let part = TriMesh::new(group.mesh.positions.clone(), triangles.collect());
    Ok(Some(Tree::Part(Bvh::build_quick(&part)?, chosen)))
}
