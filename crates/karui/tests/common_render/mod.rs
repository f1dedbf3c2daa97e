//! What the tests of pictures share: scenes, and rays in double precision.

use glam::{DVec2, DVec3};
use karui::TriMesh;
use karui::geom::{Camera, Light, Projection, Vec2, Vec3, Vec4};
use karui::mesh::{
    AlphaMode, Image, ImageData, Material, MaterialRange, NamedMesh, Node, Scene, Texture,
    TextureRef, Wrap, shapes,
};
use karui::render::{Faces, Outputs, Picture, RenderOptions, Renderer};

/// Rays from a camera through pixels, against every triangle (Möller and Trumbore,
/// "Fast, minimum storage ray-triangle intersection", 1997). Knows nothing of the
/// code it checks.
pub struct Caster {
    triangles: Vec<[DVec3; 3]>,
    eye: DVec3,
    axes: [DVec3; 3],
    projection: Projection,
    size: (f64, f64),
    depths: (f64, f64),
}

impl Caster {
    pub fn new(mesh: &TriMesh, camera: &Camera, size: (u32, u32)) -> Self {
        let eye = camera.eye.as_dvec3();
        let forward = (camera.target.as_dvec3() - eye).normalize();
        let mut up = camera.up.as_dvec3();
        if forward.cross(up).length() < 1e-6 {
            up = DVec3::Z;
        }
        let right = forward.cross(up).normalize();
        let perspective = matches!(camera.projection, Projection::Perspective { .. });
        let derived = if perspective { 1e-9 } else { f64::NEG_INFINITY };
        Self {
            triangles: (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect(),
            eye,
            axes: [right, right.cross(forward), forward],
            projection: camera.projection,
            size: (f64::from(size.0), f64::from(size.1)),
            depths: (
                camera.near.map_or(derived, f64::from),
                camera.far.map_or(f64::INFINITY, f64::from),
            ),
        }
    }

    /// Where a ray starts and what it moves by for each unit along the view.
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let [right, up, forward] = self.axes;
        let (w, h) = self.size;
        let (x, y) = ((2.0 * x - w) / h, (h - 2.0 * y) / h);
        match self.projection {
            Projection::Perspective { fov_y } => {
                let half = (0.5 * f64::from(fov_y)).tan();
                (self.eye, forward + (right * x + up * y) * half)
            }
            Projection::Orthographic { height } => {
                let half = 0.5 * f64::from(height);
                (self.eye + (right * x + up * y) * half, forward)
            }
        }
    }

    /// Distance along the view at which a ray meets a triangle.
    fn meets(&self, [a, b, c]: [DVec3; 3], (from, step): (DVec3, DVec3)) -> Option<f64> {
        let (p, q) = (b - a, c - a);
        let turned = step.cross(q);
        let determinant = p.dot(turned);
        let by = 1.0 / determinant;
        let offset = from - a;
        let u = offset.dot(turned) * by;
        let v = step.dot(offset.cross(p)) * by;
        let depth = q.dot(offset.cross(p)) * by;
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        let (near, far) = self.depths;
        (inside && depth >= near && depth <= far).then_some(depth)
    }

    /// The closest triangle and its depth.
    fn closest(&self, x: f64, y: f64) -> Option<(usize, f64)> {
        let ray = self.ray(x, y);
        let met = self.triangles.iter().enumerate();
        let met = met.filter_map(|(t, &corners)| Some((t, self.meets(corners, ray)?)));
        met.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Depth of the plane of a triangle, whether the ray is inside or not.
    fn plane_depth(&self, t: usize, x: f64, y: f64) -> f64 {
        let [a, b, c] = self.triangles[t];
        let normal = (b - a).cross(c - a);
        let (from, step) = self.ray(x, y);
        normal.dot(a - from) / normal.dot(step)
    }
}

/// Vertices are rounded by up to 1/512 of a pixel along both axes: rays that pass
/// as far beside a pixel's centre say what may be seen there.
const BESIDE: f64 = 1.0 / 350.0;

/// Checks a frame of a mesh, pixel by pixel: where all rays by the centre agree, the
/// frame must agree with them; elsewhere it must lie between them. Returns at how many
/// pixels they do not agree.
pub fn agrees_with_rays(mesh: &TriMesh, camera: &Camera, name: &str) -> usize {
    let size = (40, 30);
    let renderer = Renderer::of_mesh(mesh).expect("a sound mesh");
    let options = RenderOptions {
        width: size.0,
        height: size.1,
        outputs: Outputs::GEOMETRY,
        faces: Faces::Both,
        ..RenderOptions::default()
    };
    let frame = renderer.frame(camera, &[], &options).expect("sound");
    let view = renderer.view(camera, size.0, size.1).expect("sound");
    let mut caster = Caster::new(mesh, camera, size);
    // A near plane must be somewhere; what is closer to the eye is not seen.
    if matches!(camera.projection, Projection::Perspective { .. }) && camera.near.is_none() {
        caster.depths.0 = camera.depth_range(renderer.bounds()).expect("sound").0;
    }
    let mut unsure = 0;
    for (column, row) in (0..size.0 * size.1).map(|i| (i % size.0, i / size.0)) {
        let (x, y) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
        let at = |i: i32| f64::from(i) * BESIDE;
        let around = (0..9).map(|k| (x + at(k % 3 - 1), y + at(k / 3 - 1)));
        let rays: Vec<_> = around.clone().map(|(x, y)| caster.closest(x, y)).collect();
        let place = format!("{name}, {camera:?}, pixel {column} {row}: {rays:?}");
        let Some(hit) = frame.hit(column, row) else {
            assert!(rays.iter().any(Option::is_none), "missed: {place}");
            unsure += usize::from(rays.iter().any(Option::is_some));
            continue;
        };
        let depth = f64::from(frame.depth_at(column, row).expect("sound"));
        let slack = 2e-6 * (depth.abs() + mesh.bounds().diagonal());
        let t = hit.triangle as usize;
        let planes = around.map(|(x, y)| caster.plane_depth(t, x, y));
        let (least, most) = range(planes);
        // Seen edge on, a triangle has no depth to speak of; one without area has no
        // plane, and no depths to choose the least and most of.
        let spread = most - least;
        let steep = !spread.is_finite() || spread >= 0.02 * (1.0 + depth.abs());
        assert!(
            steep || (depth > least - slack && depth < most + slack),
            "depth {depth}, plane {least} to {most}: {place}"
        );
        let (least, most) = range(rays.iter().map(|r| r.map_or(f64::INFINITY, |r| r.1)));
        let agree = rays.iter().all(|r| r.map(|r| r.0) == rays[0].map(|r| r.0));
        unsure += usize::from(!agree || steep);
        // Between the rays there is room for what is thinner than the rounding.
        let thin = || {
            let corners = mesh.corners(t).map(|c| view.project(c.as_vec3()));
            let [Some(a), Some(b), Some(c)] = corners else {
                return false;
            };
            let [a, b, c] = [a, b, c].map(DVec3::truncate);
            let off = [(a, b), (b, c), (c, a)].map(|(p, q)| off_segment(DVec2::new(x, y), p, q));
            off.into_iter().fold(f64::INFINITY, f64::min) <= BESIDE
        };
        if rays.iter().all(Option::is_none) {
            assert!(thin(), "seen, not there: {place}");
            continue;
        }
        assert!(
            steep || (depth > least - spread - slack && depth < most + spread + slack),
            "depth {depth} by triangle {t}, rays {least} to {most}: {place}"
        );
        // Weights are of single precision.
        if agree && !steep && mesh.bounds().diagonal() < 1e4 * depth {
            let [a, b, c] = mesh.corners(t);
            let weights = hit.weights().map(f64::from);
            let point = a * weights[0] + b * weights[1] + c * weights[2];
            let seen = view.project(point.as_vec3()).expect("sound");
            let off = (seen.x - x).abs().max((seen.y - y).abs());
            assert!(off < 0.01, "weights are {off} pixels off: {place}");
        }
    }
    unsure
}

/// Distance of a point from a segment.
fn off_segment(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let along = to - from;
    let share = (point - from).dot(along) / along.length_squared();
    let share = if share.is_finite() {
        share.clamp(0.0, 1.0)
    } else {
        0.0
    };
    point.distance(from + along * share)
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
        (a.min(v), b.max(v))
    })
}

pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().expect("sound").install(work)
}

pub fn blended(base_color: Vec4) -> Material {
    Material {
        base_color,
        alpha_mode: AlphaMode::Blend,
        double_sided: true,
        ..Material::default()
    }
}

/// White with texture 0.
pub fn textured() -> Material {
    Material {
        base_color_texture: Some(TextureRef {
            texture: 0,
            uv_set: 0,
            transform: None,
        }),
        ..Material::default()
    }
}

pub fn add_texture(scene: &mut Scene, nearest: bool) {
    scene.textures.push(Texture {
        image: Some(scene.images.len() as u32),
        wrap: [Wrap::Clamp; 2],
        nearest,
    });
    scene.images.push(Image {
        name: None,
        mime: String::new(),
        data: ImageData::Missing { uri: String::new() },
    });
}

/// Every mesh in one material.
pub fn use_material(scene: &mut Scene, material: u32) {
    for named in &mut scene.meshes {
        named.mesh.ranges = vec![MaterialRange {
            count: named.mesh.triangles.len() as u32,
            material: Some(material),
            ..MaterialRange::default()
        }];
    }
}

/// A unit square at `z`, facing +z, its centre at x = y = 0, v downwards.
pub fn add_pane(scene: &mut Scene, z: f32, material: Material) {
    let corner = |x: f32, y: f32| Vec3::new(x - 0.5, y - 0.5, z);
    let positions = vec![
        corner(0.0, 0.0),
        corner(1.0, 0.0),
        corner(1.0, 1.0),
        corner(0.0, 1.0),
    ];
    let mut mesh = TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]);
    let uv = |p: &Vec3| Vec2::new(p.x + 0.5, 0.5 - p.y);
    mesh.attributes.uvs = vec![mesh.positions.iter().map(uv).collect()];
    mesh.ranges = vec![MaterialRange {
        count: 2,
        material: Some(scene.materials.len() as u32),
        ..MaterialRange::default()
    }];
    scene.materials.push(material);
    scene.roots.push(scene.nodes.len() as u32);
    scene.nodes.push(Node {
        mesh: Some(scene.meshes.len() as u32),
        ..Node::default()
    });
    scene.meshes.push(NamedMesh { name: None, mesh });
}

/// Sees panes from +z, about half the picture's height each.
pub fn facing() -> Camera {
    Camera {
        eye: Vec3::new(0.0, 0.0, 10.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        projection: Projection::Orthographic { height: 1.8 },
        near: None,
        far: None,
    }
}

pub fn some_lights(camera: &Camera) -> Vec<Light> {
    let towards = camera.target - camera.eye;
    vec![
        Light::Directional {
            direction: towards.normalize() + Vec3::new(-0.5, -0.5, 0.0),
            color: Vec3::new(0.8, 0.7, 0.6),
            intensity: 0.9,
        },
        Light::Point {
            position: camera.eye + Vec3::Y,
            color: Vec3::ONE,
            intensity: 0.8,
        },
    ]
}

/// Opaque, masked and blended shapes with textures and vertex colours.
pub fn rich_scene() -> (Scene, Vec<Option<Picture>>) {
    let mut scene = Scene::default();
    let mut masked = textured();
    masked.alpha_mode = AlphaMode::Mask(0.5);
    masked.normal_texture = masked.base_color_texture;
    add_pane(&mut scene, 0.4, masked);
    add_pane(&mut scene, 0.2, blended(Vec4::new(0.2, 0.9, 0.4, 0.5)));
    add_pane(&mut scene, -0.1, blended(Vec4::new(0.9, 0.2, 0.4, 0.3)));
    add_pane(&mut scene, -0.2, textured());
    let mut sphere = shapes::textured_sphere(24, 48);
    let colored = |p: &Vec3| (p.abs() * 0.7 + 0.2).extend(1.0);
    sphere.attributes.colors = vec![sphere.positions.iter().map(colored).collect()];
    scene.meshes[3].mesh = sphere;
    let count = scene.meshes[3].mesh.triangles.len() as u32;
    scene.meshes[3].mesh.ranges = vec![MaterialRange {
        count,
        material: Some(3),
        ..MaterialRange::default()
    }];
    add_texture(&mut scene, false);
    let pixel = |i: u32| [(i * 7) as u8, (i * 31) as u8, (i * 3) as u8, (i * 11) as u8];
    let image = Picture::new(32, 16, (0..512).map(pixel).collect()).expect("sound");
    (scene, vec![Some(image)])
}

/// Linear colour with straight alpha, by the definition of sRGB.
pub fn linear(pixel: [u8; 4]) -> Vec4 {
    let decode = |code: u8| {
        let e = f32::from(code) / 255.0;
        if e <= 0.04045 {
            e / 12.92
        } else {
            ((e + 0.055) / 1.055).powf(2.4)
        }
    };
    let [r, g, b, a] = pixel;
    Vec4::new(decode(r), decode(g), decode(b), f32::from(a) / 255.0)
}

/// Within about one code of a linear colour with straight alpha.
pub fn close(pixel: [u8; 4], expected: Vec4) {
    let found = linear(pixel);
    let encode = |x: f32| {
        if x <= 0.0031 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        }
    };
    for k in 0..3 {
        let difference = encode(found[k]) - encode(expected[k]);
        assert!(
            difference.abs() < 1.6 / 255.0,
            "{pixel:?}: {found}, expected {expected}"
        );
    }
    assert!(
        (found.w - expected.w).abs() < 1.1 / 255.0,
        "{found}, expected {expected}"
    );
}
