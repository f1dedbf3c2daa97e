//! Speed of stand-ins: `cargo bench -p karui --bench hlod_proxy`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::geom::{DMat4, DVec3};
use karui::hlod::proxy::{
    BoxOptions, ChooseOptions, Group, ImpostorOptions, Look, Member, MergedOptions, Objects,
    box_proxy, choose, impostor, merged,
};
use karui::mesh::{Material, MaterialRange, Texture, TextureRef, TriMesh, Wrap, shapes};
use karui::render::Picture;
use karui::simplify::Quality;

fn main() {
    divan::main();
}

/// Members of 1,012 triangles each; two materials with a texture of 512 x 512 texels.
struct Parts {
    meshes: [TriMesh; 2],
    materials: Vec<Material>,
    textures: Vec<Texture>,
    images: Vec<Option<Picture>>,
}

impl Parts {
    fn new() -> Self {
        let mesh = |material| {
            let mut mesh = shapes::textured_sphere(23, 23);
            mesh.ranges = vec![MaterialRange {
                count: mesh.triangles.len() as u32,
                material: Some(material),
                ..MaterialRange::default()
            }];
            mesh
        };
        let material = |texture| Material {
            base_color_texture: Some(TextureRef {
                texture,
                uv_set: 0,
                transform: None,
            }),
            ..Material::default()
        };
        let texture = |image| Texture {
            image: Some(image),
            wrap: [Wrap::Repeat; 2],
            nearest: false,
        };
        let image = |shade: u32| {
            let texel = |i: u32| [(i / 512 / 2) as u8, (i % 512 / 2) as u8, shade as u8, 255];
            Picture::new(512, 512, (0..512 * 512).map(texel).collect()).ok()
        };
        Self {
            meshes: [mesh(0), mesh(1)],
            materials: vec![material(0), material(1)],
            textures: vec![texture(0), texture(1)],
            images: vec![image(0), image(255)],
        }
    }

    fn members<'a>(&'a self, look: &'a Look<'a>, count: u32) -> Vec<Member<'a>> {
        let member = |i: u32| Member {
            mesh: &self.meshes[i as usize % 2],
            world_from_mesh: DMat4::from_translation(DVec3::new(
                f64::from(i % 8) * 2.2,
                0.0,
                f64::from(i / 8) * 2.2,
            )),
            look,
            objects: Objects::One(i),
            error: 0.0,
        };
        (0..count).map(member).collect()
    }
}

fn run(bencher: Bencher<'_, '_>, work: impl Fn(&[Member<'_>]) + Sync) {
    let parts = Parts::new();
    let look = Look::new(&parts.materials, &parts.textures, &parts.images);
    let members = parts.members(&look, 50);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let Ok(pool) = pool else { return };
    bencher
        .counter(ItemsCount::new(50usize))
        .bench(|| pool.install(|| work(&members)));
}

fn merge(members: &[Member<'_>], options: &MergedOptions<'_>) {
    let group = Group::new(members);
    divan::black_box(group.and_then(|group| merged(&group, options))).ok();
}

/// 50 members of 1,012 triangles to a quarter, a texture of 256 x 256 texels; one thread.
#[divan::bench(args = [Quality::Fast, Quality::Balanced], sample_count = 10)]
fn merged_textured(bencher: Bencher<'_, '_>, quality: Quality) {
    let options = MergedOptions {
        quality,
        materials: 0,
        pixels: 160,
        side: 256,
        ..MergedOptions::default()
    };
    run(bencher, |members| merge(members, &options));
}

/// The same, materials kept.
#[divan::bench(sample_count = 10)]
fn merged_kept(bencher: Bencher<'_, '_>) {
    let options = MergedOptions {
        pixels: 2048,
        ..MergedOptions::default()
    };
    run(bencher, |members| merge(members, &options));
}

#[divan::bench(sample_count = 10)]
fn joined(bencher: Bencher<'_, '_>) {
    run(bencher, |members| {
        divan::black_box(Group::new(members)).ok();
    });
}

#[divan::bench(sample_count = 10)]
fn solid(bencher: Bencher<'_, '_>) {
    run(bencher, |members| {
        let made = Group::new(members).and_then(|g| box_proxy(&g, &BoxOptions::default()));
        divan::black_box(made).ok();
    });
}

#[divan::bench(sample_count = 10)]
fn cards(bencher: Bencher<'_, '_>) {
    run(bencher, |members| {
        let made = Group::new(members).and_then(|g| impostor(&g, &ImpostorOptions::default()));
        divan::black_box(made).ok();
    });
}

#[divan::bench(sample_count = 5)]
fn chosen(bencher: Bencher<'_, '_>) {
    run(bencher, |members| {
        let made = Group::new(members).and_then(|g| choose(&g, &ChooseOptions::default()));
        divan::black_box(made).ok();
    });
}
