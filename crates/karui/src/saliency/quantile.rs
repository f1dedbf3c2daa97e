//! Values that a given share of all are under.

/// The value that a share of all values is under; 0 of none. Of a share of 0 it is
/// below every value, of 1 the largest.
pub(super) fn quantile(values: &[f32], share: f32) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let place = (f64::from(share) * sorted.len() as f64).ceil() as usize;
    match place {
        0 => f32::NEG_INFINITY,
        _ => sorted.get(place - 1).copied().unwrap_or(0.0),
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
        assert_eq!(quantile(&[], 0.7), 0.0);
    }
}
