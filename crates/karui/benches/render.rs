//! Speed of pictures of a mesh of 70 thousand triangles, on one core:
//! `RAYON_NUM_THREADS=1 cargo bench -p karui --bench render`

use divan::Bencher;
use karui::TriMesh;
use karui::geom::{Camera, Light, Vec3};
use karui::mesh::shapes;
use karui::render::{Faces, Outputs, RenderOptions, Renderer};

fn main() {
    divan::main();
}

/// A closed shape of 70,000 triangles that fills about a fifth of the picture, as
/// the Stanford bunny does.
fn fine() -> TriMesh {
    shapes::torus(1.0, 0.45, 250, 140)
}

fn picture(bencher: Bencher, options: &RenderOptions<'_>) {
    let mesh = fine();
    let renderer = Renderer::of_mesh(&mesh).expect("a sound mesh");
    let camera = Camera::looking_at(renderer.bounds(), Vec3::new(0.3, 0.6, 1.0), 0.6);
    let lights = Light::three_points(&camera).expect("a camera that looks somewhere");
    bencher.bench_local(|| renderer.frame(&camera, &lights, options));
}

#[divan::bench(args = [256, 512], sample_count = 30)]
fn color(bencher: Bencher, side: u32) {
    let options = RenderOptions {
        width: side,
        height: side,
        outputs: Outputs::COLOR,
        ..RenderOptions::default()
    };
    picture(bencher, &options);
}

#[divan::bench(args = [256, 512], sample_count = 30)]
fn color_of_fronts(bencher: Bencher, side: u32) {
    let options = RenderOptions {
        width: side,
        height: side,
        outputs: Outputs::COLOR,
        faces: Faces::Front,
        ..RenderOptions::default()
    };
    picture(bencher, &options);
}

#[divan::bench(args = [256, 512], sample_count = 30)]
fn depth_and_hits(bencher: Bencher, side: u32) {
    let options = RenderOptions {
        width: side,
        height: side,
        outputs: Outputs::GEOMETRY,
        ..RenderOptions::default()
    };
    picture(bencher, &options);
}

#[divan::bench(sample_count = 30)]
fn prepare(bencher: Bencher) {
    let mesh = fine();
    bencher.bench_local(|| Renderer::of_mesh(&mesh).map(|renderer| renderer.bounds()));
}
