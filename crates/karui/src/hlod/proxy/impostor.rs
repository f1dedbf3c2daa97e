//! Pictures of the members on cards.

use super::box_proxy::only_object;
use super::budget::{LONGEST, check};
use super::dilate::{Texels, dilate};
use super::finish::Finish;
use super::group::Group;
use super::join::make_one;
use super::normal_map::NormalMap;
use super::outfit::Outfit;
use super::pack::{Packed, pack};
use super::proxy::{Proxy, ProxyKind};
use super::silhouette::{Sitter, Window};
use crate::error::{Error, Result};
use crate::geom::{Aabb, DVec3, Vec2, Vec3, sin_cos};
use crate::mesh::{AlphaMode, Texture, TextureRef, TriMesh, Wrap};
use crate::render::Picture;

/// How pictures stand for a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpostorOptions {
    /// Upright cards that cross in the middle, each with a picture of either side:
    /// 1 to 8; 2 by default.
    pub cards: u32,
    /// Whether a level card shows the group from above and below. Default: yes.
    pub top: bool,
    /// Whether a normal map lets light fall on the cards as on the members; without
    /// it, texture and bytes are half. Default: yes.
    pub normals: bool,
    /// What is up; +y by default.
    pub up: Vec3,
    /// Pixels that the diagonal of the group covers on the screen when it is switched
    /// in; pictures have as many texels along the same way. 1 or more, 128 by default.
    pub pixels: u32,
    /// Longest side of the texture, texels: 32 to 4096; 1024 by default. A texture
    /// that would be larger is made coarser ([`Proxy::coarser`]).
    pub side: u32,
}

impl Default for ImpostorOptions {
    fn default() -> Self {
        Self {
            cards: 2,
            top: true,
            normals: true,
            up: Vec3::Y,
            pixels: 128,
            side: 1024,
        }
    }
}

/// Coverage from which on a texel is drawn.
const CUTOFF: f32 = 0.5;
/// Transparent texels around every picture.
const GUTTER: u32 = 1;
/// As for merged members.
const COARSER: f64 = 1.12;

/// The members' colours without light, rendered along parallel rays onto crossed cards
/// with masks: four triangles a card, a picture for each of its sides. It has the id of
/// an object only if all of the group is that object.
///
/// The error is how far the members reach from the planes of the cards, and a texel: as
/// far may what is drawn be from where it is.
///
/// `None` if the members have no more triangles or nothing is seen of them.
///
/// # Errors
/// [`Error::BadOption`] for options out of range and those of
/// [`Renderer::of_model`](crate::render::Renderer::of_model).
pub fn impostor(group: &Group<'_>, options: &ImpostorOptions) -> Result<Option<Proxy>> {
    let up = checked(options)?;
    if group.is_empty() {
        return Ok(None);
    }
    let windows = windows(group, options, up);
    if 2 * windows.len() >= group.triangles() {
        return Ok(None);
    }
    let atlas = Atlas::new(&windows, group, options);
    let Some(pictures) = atlas.pictures(group, options.normals)? else {
        return Ok(None);
    };
    let mesh = atlas.mesh(only_object(group));
    let error = group.error + depth(group, &windows) + atlas.texel;
    let scene = outfit(group, pictures).scene(mesh);
    let proxy = Proxy::new(ProxyKind::Impostor, group.origin, scene, error);
    Ok(Some(Proxy {
        coarser: atlas.coarser,
        ..proxy
    }))
}

/// What the error of such cards cannot be less than.
pub(super) fn least_error(group: &Group<'_>, options: &ImpostorOptions) -> Result<f64> {
    let up = checked(options)?;
    Ok(group.error + depth(group, &windows(group, options, up)))
}

/// The upward direction, of length 1.
fn checked(options: &ImpostorOptions) -> Result<Vec3> {
    check(options.pixels, options.side)?;
    let wrong = |option, found: String, expected| Error::BadOption {
        option,
        found,
        expected,
    };
    if !(1..=8).contains(&options.cards) {
        return Err(wrong("cards", options.cards.to_string(), "1 to 8"));
    }
    let up = options.up.as_dvec3().try_normalize();
    up.map(DVec3::as_vec3)
        .ok_or_else(|| wrong("up", options.up.to_string(), "finite, and not zero"))
}

/// Both sides of every card.
fn windows(group: &Group<'_>, options: &ImpostorOptions, up: Vec3) -> Vec<Window> {
    // For +y, the first card faces +z.
    let front = up.cross(if up.x.abs() < 0.9 { Vec3::X } else { Vec3::Y });
    let front = -front.normalize();
    let aside = up.cross(front);
    let mut windows = Vec::new();
    let mut both = |towards: Vec3, up: Vec3| {
        for towards in [towards, -towards] {
            windows.push(window(group, towards, up));
        }
    };
    for card in 0..options.cards {
        let turn = std::f64::consts::PI * f64::from(card) / f64::from(options.cards);
        let (s, c) = sin_cos(turn);
        both(front * c as f32 + aside * s as f32, up);
    }
    if options.top {
        both(up, -front);
    }
    windows
}

/// As large as the members, seen from there.
fn window(group: &Group<'_>, towards: Vec3, up: Vec3) -> Window {
    let axes = [up.cross(towards), up, towards];
    let seen = |p: &Vec3| Vec3::from_array(axes.map(|axis| p.dot(axis)));
    let extent = Aabb::of(group.mesh.positions.iter().map(seen));
    let center = extent.center();
    Window {
        center: axes[0] * center.x + axes[1] * center.y + axes[2] * center.z,
        towards,
        up,
        size: extent.size().truncate(),
    }
}

/// How far the members reach from the planes of the cards, model units.
fn depth(group: &Group<'_>, windows: &[Window]) -> f64 {
    let from = |w: &Window| {
        let normal = w.towards.as_dvec3();
        let reach = |p: &Vec3| (p.as_dvec3() - w.center.as_dvec3()).dot(normal).abs();
        group.mesh.positions.iter().map(reach).fold(0.0, f64::max)
    };
    windows.iter().map(from).fold(0.0, f64::max)
}

fn outfit(group: &Group<'_>, pictures: Vec<Picture>) -> Outfit {
    let used = |texture| TextureRef {
        texture,
        uv_set: 0,
        transform: None,
    };
    let mut material = Finish::of(group, |_| true).material();
    // What shines by itself is in the picture.
    material.emissive = Vec3::ZERO;
    material.base_color_texture = Some(used(0));
    material.normal_texture = (pictures.len() > 1).then(|| used(1));
    material.alpha_mode = AlphaMode::Mask(CUTOFF);
    let texture = |image| Texture {
        image: Some(image),
        wrap: [Wrap::Clamp; 2],
        nearest: false,
    };
    Outfit {
        materials: vec![material],
        textures: (0..pictures.len() as u32).map(texture).collect(),
        images: pictures.into_iter().map(Some).collect(),
    }
}

/// Windows in whole texels, and where their pictures lie.
struct Atlas {
    windows: Vec<Window>,
    texels: Vec<[u32; 2]>,
    packed: Packed,
    texel: f64,
    coarser: bool,
}

impl Atlas {
    fn new(windows: &[Window], group: &Group<'_>, options: &ImpostorOptions) -> Self {
        let pixels = options.pixels.min(LONGEST);
        let mut texel = group.bounds().diagonal() / f64::from(pixels);
        let mut coarser = pixels < options.pixels;
        loop {
            let texels: Vec<[u32; 2]> = windows.iter().map(|w| texels(w, texel)).collect();
            let sizes: Vec<[u32; 2]> = texels.iter().map(|t| t.map(|n| n + 2 * GUTTER)).collect();
            // At the latest when all pictures are of one texel, there is room.
            if let Some(packed) = pack(&sizes, options.side) {
                let whole = |(w, t): (&Window, &[u32; 2])| Window {
                    size: Vec2::new(t[0] as f32, t[1] as f32) * texel as f32,
                    ..*w
                };
                return Self {
                    windows: windows.iter().zip(&texels).map(whole).collect(),
                    texels,
                    packed,
                    texel,
                    coarser,
                };
            }
            (texel, coarser) = (texel * COARSER, true);
        }
    }

    /// Colours and, if wanted, normals; `None` if nothing is seen.
    fn pictures(&self, group: &Group<'_>, normals: bool) -> Result<Option<Vec<Picture>>> {
        let members = Outfit::of(&group.slots);
        let sitter = Sitter::new(group, &members)?;
        let color = |window: &Window, texels| {
            let picture = sitter.picture(window, texels)?;
            Ok(picture.pixels().to_vec())
        };
        let Some(colors) = self.picture(Texels::Covered, color)? else {
            return Ok(None);
        };
        let mut pictures = vec![colors];
        if normals {
            let map = NormalMap::new(group)?;
            let normal = |window: &Window, texels| {
                let hits = sitter.hits(window, texels)?;
                Ok(hits.iter().map(|hit| map.texel(hit, window)).collect())
            };
            pictures.extend(self.picture(Texels::Numbers, normal)?);
        }
        Ok(Some(pictures))
    }

    /// All windows, `seen` row by row, those with alpha 0 filled up; `None` if all are.
    fn picture(
        &self,
        kind: Texels,
        seen: impl Fn(&Window, [u32; 2]) -> Result<Vec<[u8; 4]>>,
    ) -> Result<Option<Picture>> {
        let (width, height) = (self.packed.width as usize, self.packed.height as usize);
        let mut pixels = vec![[0; 4]; width * height];
        let windows = self.windows.iter().zip(&self.texels);
        for ((window, &texels), &[x, y]) in windows.zip(&self.packed.places) {
            let seen = seen(window, texels)?;
            for (row, seen) in (y + GUTTER..).zip(seen.chunks(texels[0] as usize)) {
                let first = row as usize * width + (x + GUTTER) as usize;
                pixels[first..first + seen.len()].copy_from_slice(seen);
            }
        }
        let mut known: Vec<bool> = pixels.iter().map(|p| p[3] > 0).collect();
        if !known.contains(&true) {
            return Ok(None);
        }
        dilate(&mut pixels, width, &mut known, kind);
        Picture::new(self.packed.width, self.packed.height, pixels).map(Some)
    }

    fn mesh(&self, id: u32) -> TriMesh {
        let mut mesh = TriMesh::default();
        let (mut normals, mut uvs) = (Vec::new(), Vec::new());
        for ((window, texels), place) in self
            .windows
            .iter()
            .zip(&self.texels)
            .zip(&self.packed.places)
        {
            let first = mesh.positions.len() as u32;
            let (right, up) = (
                window.right() * window.size.x * 0.5,
                window.up * window.size.y * 0.5,
            );
            for (x, y) in [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)] {
                let sides = right * (2.0 * x - 1.0) - up * (2.0 * y - 1.0);
                mesh.positions.push(window.center + sides);
                normals.push(window.towards);
                let at =
                    |k: usize, along: f32| (place[k] + GUTTER) as f32 + along * texels[k] as f32;
                let whole = Vec2::new(self.packed.width as f32, self.packed.height as f32);
                uvs.push(Vec2::new(at(0, x), at(1, y)) / whole);
            }
            mesh.triangles.push([first, first + 1, first + 2]);
            mesh.triangles.push([first, first + 2, first + 3]);
        }
        mesh.attributes.normals = Some(normals);
        mesh.attributes.uvs = vec![uvs];
        make_one(&mut mesh, id);
        mesh
    }
}

fn texels(window: &Window, texel: f64) -> [u32; 2] {
    let along = |extent: f32| (f64::from(extent) / texel).ceil().clamp(1.0, 1e6) as u32;
    [along(window.size.x), along(window.size.y)]
}
