//! Differences of pictures, held against other programs and closed forms.

use karui::Error;
use karui::metrics::image::{
    Flip, ImageDifference, ImageOptions, PIXELS_PER_DEGREE, ViewDifferences, compare, flip, psnr,
    rmse, ssim,
};
use karui::render::Picture;

/// Printed by `tools/image_metrics.py`, 2026-11-27, with flip-evaluator 1.7
/// (NVIDIA's own FLIP) and scikit-image 0.26.0: name, width, height, pixels per
/// degree, mean FLIP, FLIP at three pixels, SSIM, RMSE.
type Oracle = (&'static str, u32, u32, f64, f64, [f32; 3], f64, f64);
#[rustfmt::skip]
const ORACLE: [Oracle; 11] = [
    ("shifted", 64, 48, 67.0206, 0.313802, [0.556316, 0.000000, 0.944655], 0.415448, 0.274039),
    ("stripes", 64, 48, 67.0206, 0.127314, [0.041258, 0.124589, 0.046802], 0.769649, 0.053850),
    ("blurred", 64, 48, 67.0206, 0.284930, [0.470037, 0.000000, 0.567987], 0.849346, 0.123032),
    ("inverted", 64, 48, 67.0206, 0.903066, [0.957026, 0.967200, 0.709934], -0.340554, 0.662271),
    ("shifted", 96, 96, 67.0206, 0.279023, [0.556316, 0.000000, 0.131917], 0.288544, 0.250998),
    ("stripes", 96, 96, 67.0206, 0.106832, [0.041258, 0.124589, 0.023911], 0.921538, 0.043402),
    ("blurred", 96, 96, 67.0206, 0.257674, [0.470037, 0.000000, 0.087527], 0.821519, 0.113630),
    ("inverted", 96, 96, 67.0206, 0.938998, [0.957026, 0.967200, 0.977014], -0.605520, 0.670027),
    ("shifted", 64, 48, 30.0, 0.333717, [0.462223, 0.000000, 0.984593], 0.415448, 0.274039),
    ("shifted", 64, 48, 150.0, 0.261317, [0.568693, 0.003982, 0.907564], 0.415448, 0.274039),
    ("dot", 64, 200, 67.0206, 0.003745, [0.000000, 0.000000, 0.161435], 0.998651, 0.029583),
];

#[test]
fn agrees_with_other_programs() {
    for (name, width, height, ppd, mean, spots, similarity, difference) in ORACLE {
        let [a, b] = pair(name, width, height);
        let found = flip(&a, &b, ppd).unwrap();
        println!("{name} {width} {ppd}: FLIP {:.6} ({mean})", found.mean);
        assert!(
            (found.mean - mean).abs() < 5e-6,
            "{name} {ppd}: {}",
            found.mean
        );
        for ((x, y), spot) in [(0, 0), (30, 25), (width - 1, height - 3)]
            .into_iter()
            .zip(spots)
        {
            let error = found.map[(y * width + x) as usize];
            // Where nothing is seen to differ, rounding to f32 is raised to a power of 0.7.
            let tolerance = if spot < 0.005 { 1e-3 } else { 2e-5 };
            assert!(
                (error - spot).abs() < tolerance,
                "{name} {ppd} {x} {y}: {error} {spot}"
            );
        }
        assert!((ssim(&a, &b).unwrap() - similarity).abs() < 2e-6, "{name}");
        assert!((rmse(&a, &b).unwrap() - difference).abs() < 1e-6, "{name}");
    }
}

#[test]
fn equal_pictures_do_not_differ() {
    for (width, height) in [(1, 1), (64, 48), (3, 40), (11, 10)] {
        let [a, _] = pair("shifted", width, height);
        let found = compare(&a, &a, &ImageOptions::default()).unwrap();
        let expected = ImageDifference {
            rmse: 0.0,
            psnr: f64::INFINITY,
            ssim: 1.0,
            flip: 0.0,
        };
        assert_eq!(found, expected);
        let map = flip(&a, &a, PIXELS_PER_DEGREE).unwrap().map;
        assert_eq!(map, vec![0.0; (width * height) as usize]);
    }
}

#[test]
fn everything_is_symmetric() {
    let [a, b] = pair("blurred", 64, 48);
    let options = ImageOptions::default();
    assert_eq!(compare(&a, &b, &options), compare(&b, &a, &options));
    assert_eq!(flip(&a, &b, 40.0), flip(&b, &a, 40.0));
}

#[test]
fn one_call_is_the_same_as_four() {
    let [a, b] = pair("shifted", 64, 48);
    let all = compare(&a, &b, &ImageOptions::default()).unwrap();
    assert_eq!(Ok(all.rmse), rmse(&a, &b));
    assert_eq!(Ok(all.psnr), psnr(&a, &b));
    assert_eq!(Ok(all.ssim), ssim(&a, &b));
    assert_eq!(all.flip, flip(&a, &b, PIXELS_PER_DEGREE).unwrap().mean);
}

#[test]
fn flat_pictures_have_closed_forms() {
    for side in [1, 2, 11, 30] {
        let [black, white, gray] =
            [0, 255, 51].map(|v| Picture::filled(side, side, [v, v, v, 255]));
        assert_eq!(rmse(&black, &white), Ok(1.0));
        assert_eq!(psnr(&black, &white), Ok(0.0));
        assert!((psnr(&black, &gray).unwrap() - 20.0 * 5f64.log10()).abs() < 1e-9);
        // Without variance only the term of the means is left.
        let c1 = (0.01f64 * 255.0).powi(2);
        let similarity = c1 / (255.0 * 255.0 + c1);
        assert!((ssim(&black, &white).unwrap() - similarity).abs() < 1e-9);
        let found = flip(&black, &white, PIXELS_PER_DEGREE).unwrap();
        assert!(found.map.iter().all(|&e| (e - found.map[0]).abs() < 1e-5));
        assert!((found.mean - BLACK_TO_WHITE).abs() < 1e-4, "{}", found.mean);
    }
}

/// Rows far from any difference are left out: that must not be seen.
#[test]
fn a_dot_is_seen_as_far_as_filters_reach() {
    let [a, b] = pair("dot", 64, 200);
    let map = flip(&a, &b, PIXELS_PER_DEGREE).unwrap().map;
    let rows: Vec<usize> = (0..200)
        .filter(|y| map[y * 64..(y + 1) * 64].iter().any(|&error| error > 0.0))
        .collect();
    // Three standard deviations of the widest filter: 10 pixels about 190..=194.
    assert_eq!(rows, (180..200).collect::<Vec<_>>());
}

/// NVIDIA's FLIP, as above, between a black and a white picture.
const BLACK_TO_WHITE: f64 = 0.967393;

#[test]
fn other_sizes_and_empty_pictures_are_errors() {
    let [small, large] = [Picture::filled(2, 3, [0; 4]), Picture::filled(3, 2, [0; 4])];
    let mismatch = Error::SizeMismatch {
        first: [2, 3],
        second: [3, 2],
    };
    assert_eq!(rmse(&small, &large), Err(mismatch.clone()));
    assert_eq!(psnr(&small, &large), Err(mismatch.clone()));
    assert_eq!(ssim(&small, &large), Err(mismatch.clone()));
    assert_eq!(flip(&small, &large, 67.0), Err(mismatch.clone()));
    assert_eq!(
        compare(&small, &large, &ImageOptions::default()),
        Err(mismatch)
    );
    for (width, height) in [(0, 0), (5, 0), (0, 5)] {
        let empty = Picture::filled(width, height, [0; 4]);
        assert_eq!(rmse(&empty, &empty), Err(Error::Empty { what: "picture" }));
        assert_eq!(ssim(&empty, &empty), Err(Error::Empty { what: "picture" }));
        assert_eq!(
            flip(&empty, &empty, 67.0),
            Err(Error::Empty { what: "picture" })
        );
    }
}

#[test]
fn pixels_per_degree_have_a_range() {
    let [a, b] = pair("shifted", 20, 20);
    for bad in [0.0, -1.0, 0.99, 10_001.0, f64::NAN, f64::INFINITY] {
        let error = flip(&a, &b, bad).unwrap_err();
        assert!(matches!(
            error,
            Error::BadOption {
                option: "pixels_per_degree",
                ..
            }
        ));
    }
    for good in [1.0, 7.0, 10_000.0] {
        let found = flip(&a, &b, good).unwrap();
        assert!(
            found.map.iter().all(|error| (0.0..=1.0).contains(error)),
            "{good}"
        );
        assert!(found.mean > 0.0);
    }
}

#[test]
fn alpha_is_laid_over_the_background() {
    let options = ImageOptions {
        background: [200, 100, 0],
        ..ImageOptions::default()
    };
    let clear = Picture::filled(12, 13, [9, 8, 7, 0]);
    let other = Picture::filled(12, 13, [250, 1, 99, 0]);
    let background = Picture::filled(12, 13, [200, 100, 0, 255]);
    for picture in [&other, &background] {
        assert_eq!(
            compare(&clear, picture, &options).unwrap().psnr,
            f64::INFINITY
        );
        assert_eq!(compare(&clear, picture, &options).unwrap().flip, 0.0);
    }
    assert_eq!(rmse(&clear, &other), Ok(0.0));
    let half = Picture::filled(12, 13, [255, 255, 255, 51]);
    let mixed = Picture::filled(12, 13, [51, 51, 51, 255]);
    assert_eq!(rmse(&half, &mixed), Ok(0.0));
}

#[test]
fn threads_do_not_matter() {
    let [a, b] = pair("shifted", 96, 96);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let all = compare(&a, &b, &ImageOptions::default()).unwrap();
            (all, flip(&a, &b, PIXELS_PER_DEGREE).unwrap())
        })
    };
    let one = run(1);
    for threads in [2, 8] {
        assert_eq!(run(threads), one);
    }
}

#[test]
fn views_are_averaged() {
    let difference = |rmse, ssim, flip| ImageDifference {
        rmse,
        psnr: 0.0,
        ssim,
        flip,
    };
    let [mut first, mut second] = [ViewDifferences::default(); 2];
    assert_eq!(first.mean(), None);
    first.add(&difference(0.0, 1.0, 0.0));
    second.add(&difference(0.2, 0.5, 0.25));
    first.merge(&second);
    let mean = first.mean().unwrap();
    assert_eq!(first.views(), 2);
    assert_eq!((mean.rmse, mean.ssim, mean.flip), (0.1, 0.75, 0.125));
    assert!((mean.psnr + 10.0 * 0.02f64.log10()).abs() < 1e-9);
}

#[test]
fn maps_are_painted_with_magma() {
    let map = vec![0.0, 0.5, 1.0, 2.0, -1.0, f32::NAN];
    let mut flip = Flip {
        mean: 0.0,
        map,
        width: 3,
        height: 2,
    };
    let picture = flip.picture().unwrap();
    // As matplotlib has them.
    let (black, middle, pale) = ([0, 0, 4, 255], [183, 55, 121, 255], [252, 253, 191, 255]);
    assert_eq!(picture.pixels(), [black, middle, pale, pale, black, black]);
    flip.height = 3;
    assert!(matches!(flip.picture(), Err(Error::LengthMismatch { .. })));
}

/// The pictures of `tools/image_metrics.py`, by the same formulas.
fn pair(name: &str, width: u32, height: u32) -> [Picture; 2] {
    let mut pictures = [(); 2].map(|()| Picture::filled(width, height, [0; 4]));
    for i in 0..(width * height) as usize {
        let (x, y) = (i as u32 % width, i as u32 / width);
        let a = pattern(x, y);
        let colors = [a, changed(name, a, x, y)];
        for (picture, [r, g, b]) in pictures.iter_mut().zip(colors) {
            picture.pixels_mut()[i] = [r, g, b, 255].map(|v| v as u8);
        }
    }
    pictures
}

/// A disc, a grid and ramps.
fn pattern(x: u32, y: u32) -> [u32; 3] {
    if (x.abs_diff(30)).pow(2) + (y.abs_diff(25)).pow(2) < 300 {
        [200, 40, 30]
    } else if x % 8 < 1 || y % 12 < 1 {
        [250, 250, 240]
    } else {
        [x * 255 / 95, y * 255 / 95 % 256, (x * 3 + y * 5) % 256]
    }
}

fn changed(name: &str, a: [u32; 3], x: u32, y: u32) -> [u32; 3] {
    let (right, below) = (pattern(x + 1, y), pattern(x, y + 1));
    match name {
        "shifted" => right,
        "stripes" if x % 4 < 2 => a.map(|v| v + (255 - v) / 8),
        "dot" if x.abs_diff(60) >= 3 || y.abs_diff(192) >= 3 => a,
        "stripes" => a,
        "blurred" => [0, 1, 2].map(|c| (a[c] + right[c] + below[c]) / 3),
        _ => a.map(|v| 255 - v),
    }
}
