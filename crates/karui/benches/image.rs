//! Speed of comparing pictures: `cargo bench -p karui --bench image`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::metrics::image::{self, ImageOptions, PIXELS_PER_DEGREE};
use karui::render::Picture;

fn main() {
    divan::main();
}

fn run<T: Send>(
    bencher: Bencher<'_, '_>,
    threads: usize,
    [a, b]: [Picture; 2],
    f: impl Fn(&Picture, &Picture) -> T + Sync,
) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let Ok(pool) = pool.build() else { return };
    bencher
        .counter(ItemsCount::new(a.pixels().len()))
        .bench(|| pool.install(|| f(&a, &b)));
}

/// A quarter of the picture differs, as where a model stands before a background.
#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn flip_of_a_quarter(bencher: Bencher<'_, '_>, (threads, side): (usize, u32)) {
    let a = picture(side, 3);
    let mut b = a.clone();
    for (i, pixel) in (0..side * side).zip(b.pixels_mut()) {
        if [i % side, i / side]
            .iter()
            .all(|v| (side / 4..side * 3 / 4).contains(v))
        {
            pixel[0] ^= 32;
        }
    }
    run(bencher, threads, [a, b], |a, b| {
        image::flip(a, b, PIXELS_PER_DEGREE)
    });
}

/// Two pictures without flat areas.
fn two(side: u32) -> [Picture; 2] {
    [3, 5].map(|step| picture(side, step))
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
fn rmse(bencher: Bencher<'_, '_>, (threads, side): (usize, u32)) {
    run(bencher, threads, two(side), image::rmse);
}

#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn ssim(bencher: Bencher<'_, '_>, (threads, side): (usize, u32)) {
    run(bencher, threads, two(side), image::ssim);
}

#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn flip(bencher: Bencher<'_, '_>, (threads, side): (usize, u32)) {
    run(bencher, threads, two(side), |a, b| {
        image::flip(a, b, PIXELS_PER_DEGREE)
    });
}

#[divan::bench(args = [(1, 256), (1, 512), (2, 512)], sample_count = 20)]
fn compare(bencher: Bencher<'_, '_>, (threads, side): (usize, u32)) {
    run(bencher, threads, two(side), |a, b| {
        image::compare(a, b, &ImageOptions::default())
    });
}
