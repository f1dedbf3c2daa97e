//! How strongly a plane is oriented along four angles.

use super::plane::Plane;
use crate::geom::sin_cos;

const RADIUS: usize = 4;
const TAPS: usize = 2 * RADIUS + 1;
/// Envelope at a distance of one pixel: a Gaussian of sigma 1.75 pixels.
const FALLOFF: f64 = 0.85;
/// Pixels a wave.
const WAVELENGTH: f64 = 5.0;

type Kernel = [f32; TAPS];

/// Magnitudes of complex Gabor filters whose waves run along 0, 45, 90 and 135
/// degrees (x to the right, y down). As the envelope is round, each is a sum of
/// products of one filter along x and one along y. The even part answers 0 to an
/// even plane.
pub(super) fn orientations(plane: &Plane) -> [Plane; 4] {
    let tau = std::f64::consts::TAU;
    let [g, c, s] = kernels(tau / WAVELENGTH);
    let [_, cd, sd] = kernels(tau / WAVELENGTH * std::f64::consts::FRAC_1_SQRT_2);
    let [by_g, by_c, by_s, by_cd, by_sd] = [&g, &c, &s, &cd, &sd].map(|k| along_x(plane, k));
    let mean = |k: &Kernel| k.iter().sum::<f32>() / g.iter().sum::<f32>();
    let (straight, slanted) = (mean(&c), mean(&cd) * mean(&cd));
    let gg = along_y(&by_g, &g);
    let cc = along_y(&by_cd, &cd);
    let ss = along_y(&by_sd, &sd);
    let sc = along_y(&by_sd, &cd);
    let cs = along_y(&by_cd, &sd);
    let level = |even: &Plane, odd: &Plane, dc: f32| {
        magnitude(plane, |k| {
            (even.values[k] - dc * gg.values[k], odd.values[k])
        })
    };
    let slant = |sign: f32| {
        magnitude(plane, |k| {
            let even = cc.values[k] - sign * ss.values[k] - slanted * gg.values[k];
            (even, sc.values[k] + sign * cs.values[k])
        })
    };
    [
        level(&along_y(&by_c, &g), &along_y(&by_s, &g), straight),
        slant(1.0),
        level(&along_y(&by_g, &c), &along_y(&by_g, &s), straight),
        slant(-1.0),
    ]
}

fn magnitude(like: &Plane, at: impl Fn(usize) -> (f32, f32)) -> Plane {
    let mut out = Plane::zero(like.width, like.height);
    for (k, to) in out.values.iter_mut().enumerate() {
        let (even, odd) = at(k);
        *to = (even * even + odd * odd).sqrt();
    }
    out
}

/// Envelope of sum 1, and its products with the wave's cosine and sine.
fn kernels(frequency: f64) -> [Kernel; 3] {
    let offset = |k: usize| k as f64 - RADIUS as f64;
    let envelope: [f64; TAPS] = std::array::from_fn(|k| {
        let squared = k.abs_diff(RADIUS) * k.abs_diff(RADIUS);
        (0..squared).fold(1.0, |product, _| product * FALLOFF)
    });
    let sum: f64 = envelope.iter().sum();
    let g = envelope.map(|e| e / sum);
    let wave = |k: usize| sin_cos(frequency * offset(k));
    [
        g.map(|g| g as f32),
        std::array::from_fn(|k| (g[k] * wave(k).1) as f32),
        std::array::from_fn(|k| (g[k] * wave(k).0) as f32),
    ]
}

fn along_x(plane: &Plane, kernel: &Kernel) -> Plane {
    let w = plane.width;
    let mut out = Plane::zero(w, plane.height);
    let mut padded = vec![0.0; w + 2 * RADIUS];
    for (y, to) in out.values.chunks_exact_mut(w).enumerate() {
        let row = plane.row(y);
        padded[..RADIUS].fill(row[0]);
        padded[RADIUS..RADIUS + w].copy_from_slice(row);
        padded[RADIUS + w..].fill(row[w - 1]);
        for (k, weight) in kernel.iter().enumerate() {
            accumulate(to, &padded[k..k + w], *weight);
        }
    }
    out
}

fn along_y(plane: &Plane, kernel: &Kernel) -> Plane {
    let mut out = Plane::zero(plane.width, plane.height);
    for (y, to) in out.values.chunks_exact_mut(plane.width).enumerate() {
        for (k, weight) in kernel.iter().enumerate() {
            let from = (y + k).saturating_sub(RADIUS).min(plane.height - 1);
            accumulate(to, plane.row(from), *weight);
        }
    }
    out
}

#[inline]
fn accumulate(to: &mut [f32], from: &[f32], weight: f32) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += weight * f);
}
