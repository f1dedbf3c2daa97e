//! The operator N, which favours maps with one peak over maps with many.

use super::plane::Plane;

/// Below this range a map says nothing but rounding; channels lie in 0..=1.
const EVEN: f32 = 1e-5;

/// N of Itti, Koch and Niebur (1998): scaled to 0..=1, then multiplied by
/// (M - m)^2, where M = 1 is the largest value and m the mean of the other local
/// maxima (0 if there are none). An even map becomes 0.
pub(super) fn normalise(map: &mut Plane) {
    let (low, high) = ends(&map.values);
    let range = high - low;
    if range.is_nan() || range <= EVEN {
        return map.values.fill(0.0);
    }
    map.values.iter_mut().for_each(|v| *v = (*v - low) / range);
    let others = mean_of_other_maxima(map);
    let factor = (1.0 - others) * (1.0 - others);
    map.values.iter_mut().for_each(|v| *v *= factor);
}

/// Smallest and largest of all values that are numbers. In lanes, as each fold
/// of one waits for the step before.
fn ends(values: &[f32]) -> (f32, f32) {
    const LANES: usize = 16;
    let (mut low, mut high) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
    let mut take = |values: &[f32]| {
        for ((low, high), &v) in low.iter_mut().zip(&mut high).zip(values) {
            *low = if v < *low { v } else { *low };
            *high = if v > *high { v } else { *high };
        }
    };
    let chunks = values.chunks_exact(LANES);
    let rest = chunks.remainder();
    chunks.for_each(&mut take);
    take(rest);
    let all = |ends: [f32; LANES], of: fn(f32, f32) -> f32| ends.into_iter().fold(ends[0], of);
    (all(low, f32::min), all(high, f32::max))
}

/// One of the largest values is the global maximum, all else are others.
fn mean_of_other_maxima(map: &Plane) -> f32 {
    let (mut sum, mut count) = (-1.0f64, -1i64);
    let mut peaks = vec![0; map.width];
    for y in 0..map.height {
        find_peaks(map, y, &mut peaks);
        for (_, &value) in peaks.iter().zip(map.row(y)).filter(|p| *p.0 != 0) {
            sum += f64::from(value);
            count += 1;
        }
    }
    if count > 0 {
        (sum / count as f64) as f32
    } else {
        0.0
    }
}

/// All ones for those of a row that are above 0, above what comes before them
/// among their eight neighbours and not below what comes after, so that of two
/// equal ones one is a peak; 0 for others. One neighbour after the other for
/// the whole row, without branches.
fn find_peaks(map: &Plane, y: usize, peaks: &mut [u32]) {
    let (row, w) = (map.row(y), map.width);
    let before = |a: f32, b: f32| a > b;
    let after = |a: f32, b: f32| a >= b;
    peaks.fill(u32::MAX);
    keep(peaks, row, row, |a, _| a > 0.0);
    keep(&mut peaks[1..], &row[1..], &row[..w - 1], before);
    keep(&mut peaks[..w - 1], &row[..w - 1], &row[1..], after);
    if y > 0 {
        keep_above_three(peaks, row, map.row(y - 1), before);
    }
    if y + 1 < map.height {
        keep_above_three(peaks, row, map.row(y + 1), after);
    }
}

/// Against the row above or below.
#[inline]
fn keep_above_three(
    peaks: &mut [u32],
    row: &[f32],
    other: &[f32],
    is: impl Fn(f32, f32) -> bool + Copy,
) {
    let w = row.len();
    keep(peaks, row, other, is);
    keep(&mut peaks[1..], &row[1..], &other[..w - 1], is);
    keep(&mut peaks[..w - 1], &row[..w - 1], &other[1..], is);
}

#[inline]
fn keep(peaks: &mut [u32], row: &[f32], other: &[f32], is: impl Fn(f32, f32) -> bool) {
    for ((peak, &a), &b) in peaks.iter_mut().zip(row).zip(other) {
        *peak &= u32::from(is(a, b)).wrapping_neg();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition, one value after the other.
    fn is_peak(map: &Plane, x: usize, y: usize) -> bool {
        let value = map.row(y)[x];
        let (left, right) = (x.saturating_sub(1), (x + 2).min(map.width));
        let above = y == 0 || map.row(y - 1)[left..right].iter().all(|&v| v < value);
        let row = map.row(y);
        value > 0.0
            && above
            && row[left..x].iter().all(|&v| v < value)
            && row[x..right].iter().all(|&v| v <= value)
            && (y + 1 == map.height || map.row(y + 1)[left..right].iter().all(|&v| v <= value))
    }

    /// Few values, so that many are equal.
    fn plane(width: usize, height: usize) -> Plane {
        let value = |i: usize| ((i * i * 31 + i * 17) % 23 % 7) as f32;
        Plane {
            width,
            height,
            values: (0..width * height).map(value).collect(),
        }
    }

    #[test]
    fn rows_have_the_peaks_of_the_definition() {
        let mut all = 0;
        for (width, height) in [(1, 1), (1, 9), (9, 1), (2, 2), (37, 23)] {
            let map = plane(width, height);
            let mut peaks = vec![0; width];
            for y in 0..height {
                find_peaks(&map, y, &mut peaks);
                let found: Vec<bool> = peaks.iter().map(|&p| p != 0).collect();
                let expected: Vec<bool> = (0..width).map(|x| is_peak(&map, x, y)).collect();
                assert_eq!(found, expected, "{width} x {height}, row {y}");
                all += found.iter().filter(|f| **f).count();
            }
        }
        assert!(all > 20, "{all}");
    }

    #[test]
    fn ends_are_the_least_and_the_most() {
        for n in [1, 15, 16, 17, 100] {
            let values = plane(n, 1).values;
            let fold = |start, of: fn(f32, f32) -> f32| values.iter().copied().fold(start, of);
            let expected = (
                fold(f32::INFINITY, f32::min),
                fold(f32::NEG_INFINITY, f32::max),
            );
            assert_eq!(ends(&values), expected);
        }
        assert_eq!(ends(&[f32::NAN, 2.0, 1.0]), (1.0, 2.0));
    }
}
