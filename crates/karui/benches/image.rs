//! Speed of comparing pictures: `cargo bench -p karui --bench image`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::metrics::image::{self, ImageOptions, PIXELS_PER_DEGREE};
use karui::render::Picture;

fn main() {
    divan::main();
}

/// Runs on two pictures without flat areas, `side` pixels square.
fn run<T: Send>(
    bencher: Bencher<'_, '_>,
    (threads, side): (usize, u32),
    f: impl Fn(&Picture, &Picture) -> T + Sync,
) {
    let [a, b] = [3, 5].map(|step| picture(side, step));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let Ok(pool) = pool.build() else { return };
    bencher
        .counter(ItemsCount::new(a.pixels().len()))
        .bench(|| pool.install(|| f(&a, &b)));
}

fn picture(side: u32, step: u32) -> Picture {
    let mut picture = Picture::filled(side, side, [0; 4]);
    for (i, pixel) in (0..side * side).zip(picture.pixels_mut()) {
        let (x, y) = (i % side, i / side);
        *pixel = [x * step, y * step, x ^ y, 255].map(|v| (v % 256) as u8);
    }
    picture
}

#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn rmse(bencher: Bencher<'_, '_>, size: (usize, u32)) {
    run(bencher, size, image::rmse);
}

#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn ssim(bencher: Bencher<'_, '_>, size: (usize, u32)) {
    run(bencher, size, image::ssim);
}

#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn flip(bencher: Bencher<'_, '_>, size: (usize, u32)) {
    run(bencher, size, |a, b| image::flip(a, b, PIXELS_PER_DEGREE));
}

#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn compare(bencher: Bencher<'_, '_>, size: (usize, u32)) {
    run(bencher, size, |a, b| {
        image::compare(a, b, &ImageOptions::default())
    });
}
