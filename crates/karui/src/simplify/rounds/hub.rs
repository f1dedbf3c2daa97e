//! Points at which very many triangles meet.

use super::block::Block;

/// Triangles at a point from which on it is a hub: it stays where it is and
/// none of its edges is a candidate until collapses around it have left it
/// fewer. Each collapse of such an edge would look at all of its triangles, and
/// so would each refusal, once for every edge: the square of their number in
/// every round. What lies between the spokes goes on being simplified, so that
/// hubs, which are rare, hold back next to nothing.
const MANY: u32 = 1024;

impl Block {
    /// Whether a point is a hub.
    #[inline(always)]
    pub fn is_hub(&self, p: u32) -> bool {
        self.span[p as usize].len > MANY
    }
}

/// The place of a number in a list that may be very long: by eights, which are
/// compared at once.
#[inline(always)]
pub(super) fn place_of(number: u32, list: &[u32]) -> Option<usize> {
    let (eights, _) = list.as_chunks::<8>();
    let has_it = |eight: &[u32; 8]| eight.iter().fold(false, |any, &n| any | (n == number));
    let first = 8 * eights.iter().position(has_it).unwrap_or(eights.len());
    let at = list[first..].iter().position(|&n| n == number);
    at.map(|at| first + at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_anywhere() {
        for len in 0..40u32 {
            let list: Vec<u32> = (0..len).map(|i| 3 * i % 17).collect();
            for number in 0..20 {
                let plain = list.iter().position(|&n| n == number);
                assert_eq!(place_of(number, &list), plain, "{number} in {len}");
            }
        }
    }
}
