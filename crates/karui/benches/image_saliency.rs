//! Speed of image saliency of a picture of 512 x 512, on one core.

use divan::Bencher;
use karui::render::Picture;
use karui::saliency::{ImageSaliency, ImageSaliencyOptions};

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 50)]
fn map_of_512(bencher: Bencher) {
    let color = |k: u32| [(k % 251) as u8, (k / 700) as u8, (k % 13) as u8, 255];
    let picture = Picture::new(512, 512, (0..512 * 512).map(color).collect()).expect("pixels");
    let mut judge = ImageSaliency::new(&ImageSaliencyOptions::default()).expect("options");
    bencher.bench_local(|| judge.map(&picture));
}
