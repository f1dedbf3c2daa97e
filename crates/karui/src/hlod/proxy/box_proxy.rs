//! A box of the members' mean colour.

use super::distance::distance;
use super::finish::Finish;
use super::group::Group;
use super::join::{ids_of, make_one};
use super::outfit::Outfit;
use super::proxy::{NO_OBJECT, Proxy, ProxyKind};
use super::silhouette::{Sitter, Window};
use crate::error::Result;
use crate::geom::{Aabb, Vec2, Vec3, Vec4};
use crate::mesh::{AlphaMode, TriMesh, shapes};
use crate::render::{Picture, linear_of_codes};

/// Side of the pictures that colours are taken from, texels.
const TEXELS: u32 = 32;

/// How a box is made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BoxOptions {
    /// Whether the box is as transparent as the members leave of its sides, as in
    /// the paper. Default: no.
    pub blended: bool,
}

/// The axis-aligned box around the members, 12 triangles, in the mean colour of
/// what is seen of them along the axes (Kato et al. 1998). It has the id of an
/// object only if all of the group is that object.
///
/// `None` if the members have no more than 12 triangles or nothing is seen of them.
///
/// # Errors
/// Those of [`Renderer::of_model`](crate::render::Renderer::of_model).
pub fn box_proxy(group: &Group<'_>, options: &BoxOptions) -> Result<Option<Proxy>> {
    if group.is_empty() || group.triangles() <= 12 {
        return Ok(None);
    }
    let outfit = Outfit::of(&group.slots);
    let Some(color) = seen_color(group, &outfit)? else {
        return Ok(None);
    };
    let mesh = box_mesh(group);
    let error = group.error + distance(group, &mesh)?;
    let mut material = Finish::of(group, |_| true).material();
    // What is seen already has what shines by itself.
    material.emissive = Vec3::ZERO;
    material.base_color = color.truncate().extend(1.0);
    if options.blended {
        material.base_color.w = color.w;
        material.alpha_mode = AlphaMode::Blend;
    }
    let outfit = Outfit {
        materials: vec![material],
        ..Outfit::default()
    };
    let scene = outfit.scene(mesh);
    Ok(Some(Proxy::new(ProxyKind::Box, group.origin, scene, error)))
}

/// What the error of a box cannot be less than: from a few places of its sides to the
/// members, and from their vertices to its sides.
pub(super) fn least_error(group: &Group<'_>) -> Result<f64> {
    if group.is_empty() {
        return Ok(0.0);
    }
    let bounds = group.bounds();
    let inside = |p: &Vec3| (*p - bounds.min).min(bounds.max - *p).min_element();
    let inside = group.mesh.positions.iter().map(inside).fold(0.0, f32::max);
    let mut most = f64::from(inside);
    for place in 0..27 {
        let third = |by: i32| (place / by % 3) as f32 - 1.0;
        let offset = Vec3::new(third(1), third(3), third(9));
        if offset != Vec3::ZERO {
            let p = bounds.center() + bounds.size() * 0.5 * offset;
            let hit = group.tree()?.closest(p.as_dvec3());
            most = most.max(hit.distance_squared.sqrt());
        }
    }
    Ok(group.error + most)
}

fn box_mesh(group: &Group<'_>) -> TriMesh {
    let bounds = group.bounds();
    let mut mesh = shapes::cube(1);
    for p in &mut mesh.positions {
        *p = Vec3::select(p.cmpgt(Vec3::ZERO), bounds.max, bounds.min);
    }
    mesh.attributes.uvs.clear();
    make_one(&mut mesh, only_object(group));
    mesh
}

/// The object that all of the group is.
pub(super) fn only_object(group: &Group<'_>) -> u32 {
    let ids = ids_of(&group.mesh.attributes).unwrap_or_default();
    match ids {
        [first, rest @ ..] if rest.iter().all(|id| id == first) => *first,
        _ => NO_OBJECT,
    }
}

/// Mean linear colour over the six sides of the box, and how much of them is
/// covered. `None` if nothing is.
fn seen_color(group: &Group<'_>, outfit: &Outfit) -> Result<Option<Vec4>> {
    let sitter = Sitter::new(group, outfit)?;
    let (mut sum, mut sides) = (Vec4::ZERO, 0.0);
    for (window, side) in sides_of(group.bounds()) {
        if side > 0.0 {
            let square = window.size.x * window.size.y;
            sum += mean(&sitter.picture(&window, [TEXELS; 2])?) * square;
            sides += side;
        }
    }
    if sum.w <= 0.0 {
        return Ok(None);
    }
    let (color, covered) = (sum.truncate() / sum.w, sum.w / sides);
    Ok(Some(color.min(Vec3::ONE).extend(covered.min(1.0))))
}

/// The sides of a box and their areas, each in a square window.
fn sides_of(bounds: Aabb) -> Vec<(Window, f32)> {
    let (center, size) = (bounds.center(), bounds.size());
    let side = |(towards, up): (Vec3, Vec3)| {
        let right = up.cross(towards).abs();
        let (width, height) = (size.dot(right), size.dot(up.abs()));
        let window = Window {
            center,
            towards,
            up,
            size: Vec2::splat(width.max(height)),
        };
        (window, width * height)
    };
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    [(x, y), (-x, y), (y, z), (-y, z), (z, y), (-z, y)]
        .map(side)
        .to_vec()
}

/// Premultiplied mean.
fn mean(picture: &Picture) -> Vec4 {
    let linear = linear_of_codes();
    let mut sum = Vec4::ZERO;
    for &[r, g, b, a] in picture.pixels() {
        let light = [r, g, b].map(|code| linear[usize::from(code)]);
        let alpha = f32::from(a) / 255.0;
        sum += (Vec3::from_array(light) * alpha).extend(alpha);
    }
    sum / picture.pixels().len() as f32
}
