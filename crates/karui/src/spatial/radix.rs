//! Parallel radix sort of keys that carry their index.

use rayon::prelude::*;

/// Bits of a key that are its index; the rest is what to sort by.
pub(super) const INDEX_BITS: u32 = 31;
/// Bits sorted by in a pass. Three passes make up for all that [`INDEX_BITS`]
/// leave.
const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 1 << DIGIT_BITS;
/// Fewer keys than these are not worth another thread.
const PART: usize = 1 << 15;
/// Fewer keys than these are not worth a pass over all digits.
const FEW: usize = 1 << 11;

/// Sorts keys whose indices ascend.
pub(super) fn sort(mut keys: Vec<u64>) -> Vec<u64> {
    if keys.len() < FEW {
        keys.sort_unstable();
        return keys;
    }
    let parts = rayon::current_num_threads().min(keys.len().div_ceil(PART));
    let size = keys.len().div_ceil(parts);
    let mut spare = vec![0; keys.len()];
    for shift in (INDEX_BITS..u64::BITS).step_by(DIGIT_BITS as usize) {
        pass(&keys, &mut spare, shift, size);
        std::mem::swap(&mut keys, &mut spare);
    }
    keys
}

/// Copies the keys by one digit, those of equal digits in order; one task
/// takes `size` of them.
fn pass(from: &[u64], to: &mut [u64], shift: u32, size: usize) {
    let digit = |key: u64| (key >> shift) as usize & (DIGITS - 1);
    let count = |part: &[u64]| {
        let mut counts = vec![0u32; DIGITS];
        part.iter().for_each(|&key| counts[digit(key)] += 1);
        counts
    };
    let counts: Vec<Vec<u32>> = from.par_chunks(size).map(count).collect();
    let mut places: Vec<Vec<_>> = counts.iter().map(|_| Vec::with_capacity(DIGITS)).collect();
    let mut rest = to;
    for digit in 0..DIGITS {
        for (places, counts) in places.iter_mut().zip(&counts) {
            let (own, after) = rest.split_at_mut(counts[digit] as usize);
            places.push(own.iter_mut());
            rest = after;
        }
    }
    let parts = from.par_chunks(size).zip(places);
    parts.for_each(|(part, mut places)| {
        for &key in part {
            if let Some(place) = places[digit(key)].next() {
                *place = key;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_sorted_by_all_bits() {
        for count in [0, 1, 100, 5000, 200_000] {
            let mixed = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (i % 40);
            let keyed = |i: u64| mixed(i) << INDEX_BITS | i;
            let keys: Vec<u64> = (0..count).map(keyed).collect();
            let mut expected = keys.clone();
            expected.sort_unstable();
            assert_eq!(sort(keys), expected);
        }
    }
}
