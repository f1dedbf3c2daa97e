//! What tells a block that has been put from one that has changed since.

const MIX: u64 = 0x9e37_79b9_7f4a_7c15;

/// Hash of some bytes, the same on every machine. A flipped bit always changes it: each
/// step is a bijection of what was before.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u64 {
    // Four lanes, so that one multiplication need not wait for the last.
    let mut lanes = [1, 2, 3, 4].map(|lane: u64| lane.wrapping_mul(MIX) ^ bytes.len() as u64);
    let (blocks, rest) = bytes.as_chunks::<32>();
    for block in blocks {
        let (words, _) = block.as_chunks::<8>();
        for (lane, word) in lanes.iter_mut().zip(words) {
            *lane = mixed(*lane, u64::from_le_bytes(*word));
        }
    }
    let joined = lanes.into_iter().fold(0, mixed);
    rest.iter().fold(joined, |hash, &b| mixed(hash, b.into()))
}

/// A hash that has taken in one more word.
pub(super) fn mixed(hash: u64, word: u64) -> u64 {
    let product = (hash ^ word).wrapping_mul(MIX);
    product ^ product >> 29
}

#[cfg(test)]
mod tests {
    use super::checksum;

    #[test]
    fn any_flipped_bit_and_any_cut_changes_it() {
        let bytes: Vec<u8> = (0..101u8).map(|i| i.wrapping_mul(37)).collect();
        let whole = checksum(&bytes);
        for bit in 0..8 * bytes.len() {
            let mut other = bytes.clone();
            other[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(checksum(&other), whole, "{bit}");
        }
        assert!((0..bytes.len()).all(|end| checksum(&bytes[..end]) != whole));
    }
}
