//! The filters of FLIP, each as factors along x and y.

use std::f64::consts::PI;

/// Weights along one axis, the middle one at the pixel itself.
pub(super) type Kernel = Vec<f32>;

/// Peak and width of the Gaussians that approximate the eye's contrast
/// sensitivity to an opponent colour (table 1 of the paper).
type Sensitivity = [(f64, f64); 2];

const RED_GREEN: f64 = 0.0053;
const LUMINANCE: f64 = 0.0047;
const BLUE_YELLOW: Sensitivity = [(34.1, 0.04), (13.5, 0.025)];

/// Width of the detectors of edges and points, in degrees.
const FEATURE: f64 = 0.082;

/// Weights below this part of the largest change no f32 sum.
const NEGLIGIBLE: f64 = 1e-9;

/// Everything that depends on pixels per degree only.
pub(super) struct Filters {
    /// Sensitivity to luminance.
    pub(super) luminance: Kernel,
    /// To red against green.
    pub(super) red_green: Kernel,
    /// To blue against yellow: two filters to be added, with their shares.
    pub(super) blue_yellow: [(f32, Kernel); 2],
    /// Across the direction of a detector.
    pub(super) across: Kernel,
    /// First derivative of a Gaussian, for edges.
    pub(super) edge: Kernel,
    /// Second derivative, for points.
    pub(super) point: Kernel,
}

impl Filters {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let widest = BLUE_YELLOW[0].1;
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil();
        let gaussian = |b: f64| {
            let scale = PI * PI / (b * pixels_per_degree * pixels_per_degree);
            sampled(radius, |x| (-scale * x * x).exp())
        };
        let sd = 0.5 * FEATURE * pixels_per_degree;
        let bell = |x: f64| (-x * x / (2.0 * sd * sd)).exp();
        let reach = (3.0 * sd).ceil();
        Self {
            luminance: unit_sum(&gaussian(LUMINANCE)),
            red_green: unit_sum(&gaussian(RED_GREEN)),
            blue_yellow: shares(BLUE_YELLOW.map(|(a, b)| (a * (PI / b).sqrt(), gaussian(b)))),
            across: unit_sum(&sampled(reach, bell)),
            edge: unit_sides(&sampled(reach, |x| -x * bell(x))),
            point: unit_sides(&sampled(reach, |x| (x * x / (sd * sd) - 1.0) * bell(x))),
        }
    }

    /// Distance in pixels beyond which no filter sees anything.
    pub(super) fn reach(&self) -> usize {
        let [(_, wide), (_, narrow)] = &self.blue_yellow;
        let colors = [&self.luminance, &self.red_green, wide, narrow];
        let features = [&self.across, &self.edge, &self.point];
        let kernels = colors.into_iter().chain(features);
        kernels.map(|k| k.len() / 2).fold(0, usize::max)
    }
}

fn sampled(radius: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i32;
    (-radius..=radius).map(|x| f(f64::from(x))).collect()
}

/// Scaled to a sum of 1, without negligible ends.
fn unit_sum(weights: &[f64]) -> Kernel {
    let sum: f64 = weights.iter().sum();
    let first = weights.iter().position(|&w| w > NEGLIGIBLE * sum);
    let first = first.unwrap_or(0);
    let kept = &weights[first..weights.len() - first];
    kept.iter().map(|w| (w / sum) as f32).collect()
}

/// Positive and negative weights scaled to sums of 1 and -1.
fn unit_sides(weights: &[f64]) -> Kernel {
    let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
    let scaled = |&w: &f64| (w / if w > 0.0 { positive } else { negative }) as f32;
    weights.iter().map(scaled).collect()
}

/// Two Gaussians with peaks in two dimensions, as parts of a sum of 1.
fn shares(gaussians: [(f64, Vec<f64>); 2]) -> [(f32, Kernel); 2] {
    let volumes = gaussians
        .each_ref()
        .map(|(peak, weights)| peak * weights.iter().sum::<f64>().powi(2));
    let all = volumes[0] + volumes[1];
    let share = |i: usize| ((volumes[i] / all) as f32, unit_sum(&gaussians[i].1));
    [share(0), share(1)]
}
