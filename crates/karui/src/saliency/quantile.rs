//! Values that a given share of all are under.

/// The value that a share of all values is at or under: as many as come closest to the
/// share, for 0.2 in `f32` is a little more than a fifth. Of a share of 0, and of no
/// values, it is below every value; of 1 it is the largest.
pub(super) fn quantile(values: &[f32], share: f32) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let place = (f64::from(share) * sorted.len() as f64).round() as usize;
    match place {
        0 => f32::NEG_INFINITY,
        _ => sorted[place.min(sorted.len()) - 1],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_parts_values() {
        let values = [3.0, 1.0, 2.0, 4.0];
        assert_eq!(quantile(&values, 0.5), 2.0);
        assert_eq!(quantile(&values, 1.0), 4.0);
        assert_eq!(quantile(&values, 0.0), f32::NEG_INFINITY);
        assert_eq!(quantile(&[], 0.7), f32::NEG_INFINITY);
        let ten: Vec<f32> = (0..10).map(|i| i as f32).collect();
        assert_eq!(quantile(&ten, 0.2), 1.0);
    }
}
