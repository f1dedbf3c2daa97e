//! The operator N, which favours maps with one peak over maps with many.

use super::plane::Plane;

/// Below this range a map says nothing but rounding; channels lie in 0..=1.
const EVEN: f32 = 1e-5;

/// N of Itti, Koch and Niebur (1998): scaled to 0..=1, then multiplied by
/// (M - m)^2, where M = 1 is the largest value and m the mean of the other local
/// maxima (0 if there are none). An even map becomes 0.
pub(super) fn normalise(map: &mut Plane) {
    let low = map.values.iter().copied().fold(f32::INFINITY, f32::min);
    let high = map.values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let range = high - low;
    if range.is_nan() || range <= EVEN {
        return map.values.fill(0.0);
    }
    map.values.iter_mut().for_each(|v| *v = (*v - low) / range);
    let others = mean_of_other_maxima(map);
    let factor = (1.0 - others) * (1.0 - others);
    map.values.iter_mut().for_each(|v| *v *= factor);
}

/// One of the largest values is the global maximum, all else are others.
fn mean_of_other_maxima(map: &Plane) -> f32 {
    let (mut sum, mut count) = (-1.0f64, -1i64);
    for y in 0..map.height {
        for x in 0..map.width {
            if is_peak(map, x, y) {
                sum += f64::from(map.row(y)[x]);
                count += 1;
            }
        }
    }
    if count > 0 {
        (sum / count as f64) as f32
    } else {
        0.0
    }
}

/// Above what comes before it among its eight neighbours and not below what
/// comes after, so that of two equal ones one is a peak.
fn is_peak(map: &Plane, x: usize, y: usize) -> bool {
    let value = map.row(y)[x];
    if value <= 0.0 {
        return false;
    }
    let (left, right) = (x.saturating_sub(1), (x + 2).min(map.width));
    let above = y == 0 || map.row(y - 1)[left..right].iter().all(|&v| v < value);
    let row = map.row(y);
    above
        && row[left..x].iter().all(|&v| v < value)
        && row[x..right].iter().all(|&v| v <= value)
        && (y + 1 == map.height || map.row(y + 1)[left..right].iter().all(|&v| v <= value))
}
