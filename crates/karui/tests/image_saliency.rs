//! Image saliency against pictures whose odd one out is known.

use karui::render::Picture;
use karui::saliency::{ImageSaliencyOptions, Opponency, SaliencyMap, image_saliency};

fn drawn(w: u32, h: u32, color: impl Fn(f32, f32) -> [u8; 4]) -> Picture {
    let at = |k: u32| color((k % w) as f32 + 0.5, (k / w) as f32 + 0.5);
    Picture::new(w, h, (0..w * h).map(at).collect()).expect("all pixels")
}

fn map_of(picture: &Picture) -> SaliencyMap {
    let map = image_saliency(picture, &ImageSaliencyOptions::default()).expect("options");
    assert_eq!(map.values.len(), (map.width * map.height) as usize);
    assert!(map.values.iter().all(|v| (0.0..=1.0).contains(v)));
    map
}

/// Place of the largest value, in pixels of the picture.
fn peak(map: &SaliencyMap) -> (f32, f32) {
    let best = (0..map.values.len()).max_by(|&a, &b| map.values[a].total_cmp(&map.values[b]));
    let k = best.expect("a map") as u32;
    let pixel = |k: u32| (k * 16 + 8) as f32;
    (pixel(k % map.width), pixel(k / map.width))
}

/// Cell of a grid of 5 x 5 and the place in it from its middle.
fn cell(x: f32, y: f32) -> ((u32, u32), f32, f32) {
    let side = 512.0 / 5.0;
    let (i, j) = ((x / side) as u32, (y / side) as u32);
    let from = |at: f32, k: u32| at - (k as f32 + 0.5) * side;
    ((i, j), from(x, i), from(y, j))
}

const ODD: [(u32, u32); 3] = [(3, 1), (2, 2), (1, 3)];

fn assert_odd_one_out(odd: (u32, u32), color: impl Fn(bool, f32, f32) -> [u8; 4], name: &str) {
    let picture = drawn(512, 512, |x, y| {
        let (at, dx, dy) = cell(x, y);
        color(at == odd, dx, dy)
    });
    let (x, y) = peak(&map_of(&picture));
    assert_eq!(cell(x, y).0, odd, "{name}: peak at {x}, {y}");
}

#[test]
fn red_among_green() {
    for odd in ODD {
        let color = |odd, dx: f32, dy: f32| match (dx.hypot(dy) < 25.0, odd) {
            (false, _) => [0, 0, 0, 255],
            (_, true) => [200, 0, 0, 255],
            (_, false) => [0, 200, 0, 255],
        };
        assert_odd_one_out(odd, color, "red disc");
    }
}

/// Why the printed rule is not the default.
#[test]
fn the_printed_rule_misses_red_among_green() {
    let options = ImageSaliencyOptions {
        opponency: Opponency::Printed,
        ..ImageSaliencyOptions::default()
    };
    for odd in ODD {
        let picture = drawn(512, 512, |x, y| {
            let (at, dx, dy) = cell(x, y);
            match (dx.hypot(dy) < 25.0, at == odd) {
                (false, _) => [0, 0, 0, 255],
                (_, true) => [200, 0, 0, 255],
                (_, false) => [0, 200, 0, 255],
            }
        });
        let (x, y) = peak(&image_saliency(&picture, &options).expect("options"));
        assert_ne!(cell(x, y).0, odd);
    }
}

#[test]
fn tilted_among_upright() {
    for odd in ODD {
        let color = |odd: bool, dx: f32, dy: f32| {
            let h = std::f32::consts::FRAC_1_SQRT_2;
            let (u, v) = if odd {
                ((dx - dy) * h, (dx + dy) * h)
            } else {
                (dx, dy)
            };
            let bar = u.abs() < 6.0 && v.abs() < 30.0;
            if bar { [255; 4] } else { [0, 0, 0, 255] }
        };
        assert_odd_one_out(odd, color, "tilted bar");
    }
}

#[test]
fn one_bright_spot() {
    let color = |odd, dx: f32, dy: f32| {
        let spot = odd && dx.hypot(dy) < 15.0;
        if spot { [255; 4] } else { [40, 40, 40, 255] }
    };
    for odd in ODD {
        assert_odd_one_out(odd, color, "bright spot");
    }
}

#[test]
fn even_pictures_are_zero() {
    for (w, h) in [(512, 512), (1, 1), (3, 700), (700, 3), (2, 2), (513, 511)] {
        for color in [[0; 4], [255; 4], [200, 10, 60, 255], [7, 90, 200, 100]] {
            let map = map_of(&Picture::filled(w, h, color));
            assert!(map.values.iter().all(|&v| v == 0.0), "{w} x {h} {color:?}");
            assert_eq!((map.width, map.height), (w.div_ceil(16), h.div_ceil(16)));
        }
    }
    assert_eq!(map_of(&Picture::default()), SaliencyMap::default());
}

#[test]
fn narrow_pictures_have_a_map() {
    let picture = drawn(3, 700, |_, y| {
        if (y - 300.0).abs() < 8.0 {
            [255; 4]
        } else {
            [0; 4]
        }
    });
    let map = map_of(&picture);
    assert!((peak(&map).1 - 300.0).abs() < 24.0, "{:?}", peak(&map));
    assert!(map.sample(1.5, 300.0) > 0.5 && map.sample(-1e9, 1e9).is_finite());
}

#[test]
fn a_mirrored_picture_has_the_mirrored_map() {
    // No even regions: where values are equal, rounding decides what is a peak.
    let color = |x: f32, y: f32| {
        let code = |k: u32| {
            ((x as u32 / 7 * 7919 + y as u32 / 5 * 104_729 + k).wrapping_mul(2_654_435_761) >> 24)
                as u8
        };
        [code(1), code(2), code(3), 255]
    };
    let map = map_of(&drawn(512, 512, color));
    let mirrored = map_of(&drawn(512, 512, |x, y| color(512.0 - x, y)));
    for (a, b) in map.values.chunks(32).zip(mirrored.values.chunks(32)) {
        for (a, b) in a.iter().zip(b.iter().rev()) {
            assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
    }
}

#[test]
fn bad_factors_are_refused() {
    let options = ImageSaliencyOptions {
        color: -1.0,
        ..ImageSaliencyOptions::default()
    };
    assert!(image_saliency(&Picture::default(), &options).is_err());
}

/// Values by row and column.
type Rows = Vec<Vec<f64>>;

/// The next level by its definition: every pixel of it is a sum over all pixels, each
/// counted as often as the taps 1 3 3 1 along both axes fall on it, borders repeated.
fn next_level(from: &Rows) -> Rows {
    let count = |to: usize, at: usize, size: usize| -> f64 {
        let taps = [(-1, 1.0), (0, 3.0), (1, 3.0), (2, 1.0)];
        let place = |k: i64| (2 * to as i64 + k).clamp(0, size as i64 - 1) as usize;
        let hits = taps.iter().filter(|(k, _)| place(*k) == at);
        hits.map(|(_, weight)| weight / 8.0).sum()
    };
    let (height, width) = (from.len(), from[0].len());
    let pixel = |y: usize, x: usize| -> f64 {
        let all = (0..height).flat_map(|v| (0..width).map(move |u| (v, u)));
        let part = |(v, u): (usize, usize)| count(y, v, height) * count(x, u, width) * from[v][u];
        all.map(part).sum()
    };
    let row = |y| (0..width.div_ceil(2)).map(|x| pixel(y, x)).collect();
    (0..height.div_ceil(2)).map(row).collect()
}

/// Bilinear between centres of a level that is `shift` coarser.
fn between_centres(level: &Rows, shift: usize, y: usize, x: usize) -> f64 {
    let place = |at: usize, size: usize| {
        let at = (at as f64 + 0.5) / (1 << shift) as f64 - 0.5;
        at.clamp(0.0, size as f64 - 1.0)
    };
    let (v, u) = (place(y, level.len()), place(x, level[0].len()));
    let mut sum = 0.0;
    for (j, row) in level.iter().enumerate() {
        for (i, value) in row.iter().enumerate() {
            let tent = |d: f64| (1.0 - d.abs()).max(0.0);
            sum += tent(v - j as f64) * tent(u - i as f64) * value;
        }
    }
    sum
}

fn plain_n(map: &mut Rows) {
    let all = || map.iter().flatten().copied();
    let (low, high) = (
        all().fold(f64::MAX, f64::min),
        all().fold(f64::MIN, f64::max),
    );
    let share = |v: f64| (v - low) / (high - low);
    let scaled: Rows = map
        .iter()
        .map(|r| r.iter().map(|v| share(*v)).collect())
        .collect();
    let (mut sum, mut count) = (0.0, 0.0);
    for (y, row) in scaled.iter().enumerate() {
        for (x, value) in row.iter().enumerate() {
            let near = |v: usize, u: usize| v.abs_diff(y) <= 1 && u.abs_diff(x) <= 1;
            let above = scaled.iter().enumerate().all(|(v, r)| {
                let mut others = r.iter().enumerate();
                others.all(|(u, o)| !near(v, u) || (v, u) == (y, x) || o < value)
            });
            if above && *value < 1.0 {
                sum += value;
                count += 1.0;
            }
        }
    }
    let m: f64 = if count > 0.0 { sum / count } else { 0.0 };
    *map = scaled;
    map.iter_mut()
        .flatten()
        .for_each(|v| *v *= (1.0 - m).powi(2));
}

/// Sum of N of all centre-surround differences, at level 4.
fn plain_map(channel: &Rows) -> Rows {
    let mut levels = vec![channel.clone()];
    for s in 0..8 {
        levels.push(next_level(&levels[s]));
    }
    let mut total = vec![vec![0.0; levels[4][0].len()]; levels[4].len()];
    for (c, s) in [(2, 5), (2, 6), (3, 6), (3, 7), (4, 7), (4, 8)] {
        let mut map = levels[c].clone();
        for (y, row) in map.iter_mut().enumerate() {
            for (x, value) in row.iter_mut().enumerate() {
                *value = (*value - between_centres(&levels[s], s - c, y, x)).abs();
            }
        }
        plain_n(&mut map);
        for _ in c..4 {
            map = next_level(&map);
        }
        let pairs = total.iter_mut().flatten().zip(map.iter().flatten());
        pairs.for_each(|(t, m)| *t += m);
    }
    total
}

#[test]
fn intensity_is_that_of_the_plain_definition() {
    let grey = |x: f32, y: f32| {
        let code = (x as u32 / 3 * 7919 + y as u32 / 2 * 104_729).wrapping_mul(2_654_435_761) >> 25;
        let spot = (x - 40.0).hypot(y - 20.0) < 6.0;
        code as u8 + if spot { 120 } else { 0 }
    };
    let picture = drawn(64, 64, |x, y| [grey(x, y), grey(x, y), grey(x, y), 255]);
    let value = |y: usize, x: usize| f64::from(grey(x as f32 + 0.5, y as f32 + 0.5)) / 255.0;
    let channel = (0..64)
        .map(|y| (0..64).map(|x| value(y, x)).collect())
        .collect();
    let mut expected = plain_map(&channel);
    plain_n(&mut expected);
    let most = expected.iter().flatten().copied().fold(0.0, f64::max);
    let options = ImageSaliencyOptions {
        color: 0.0,
        orientation: 0.0,
        ..ImageSaliencyOptions::default()
    };
    let found = image_saliency(&picture, &options).expect("options");
    assert_eq!(found.values.len(), 16);
    for (a, b) in found.values.iter().zip(expected.iter().flatten()) {
        assert!((f64::from(*a) - b / most).abs() < 1e-3, "{a}, {}", b / most);
    }
}
