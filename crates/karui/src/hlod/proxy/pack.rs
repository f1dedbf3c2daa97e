//! Rectangles side by side in a larger one.

/// Where rectangles lie, and in how large a one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Packed {
    pub width: u32,
    pub height: u32,
    /// Left and upper end of every rectangle.
    pub places: Vec<[u32; 2]>,
}

/// Puts rectangles on shelves, highest first; `None` if a square of `side` does not
/// hold them that way. The width is a power of two or `side`, the height even.
pub(super) fn pack(sizes: &[[u32; 2]], side: u32) -> Option<Packed> {
    let area: u64 = sizes
        .iter()
        .map(|s| u64::from(s[0]) * u64::from(s[1]))
        .sum();
    if area > u64::from(side) * u64::from(side) {
        return None;
    }
    let widest = sizes.iter().map(|s| s[0]).max().unwrap_or(1);
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(sizes[i]), i));
    order.sort_by_key(|&i| std::cmp::Reverse(sizes[i][1]));
    let mut width = 1u32;
    while width < widest || u64::from(width) * u64::from(width) < area {
        width *= 2;
    }
    loop {
        let width_now = width.min(side);
        if let Some(packed) = shelves(sizes, &order, width_now, side) {
            return Some(packed);
        }
        if width_now == side {
            return None;
        }
        width *= 2;
    }
}

fn shelves(sizes: &[[u32; 2]], order: &[usize], width: u32, side: u32) -> Option<Packed> {
    let mut places = vec![[0; 2]; sizes.len()];
    let (mut x, mut y, mut shelf) = (0, 0, 0);
    for &i in order {
        let [w, h] = sizes[i];
        if w > width {
            return None;
        }
        if x + w > width {
            (x, y, shelf) = (0, y + shelf, 0);
        }
        places[i] = [x, y];
        x += w;
        shelf = shelf.max(h);
    }
    let height = (y + shelf).next_multiple_of(2).max(2);
    (height <= side).then_some(Packed {
        width,
        height,
        places,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rectangles_lie_inside_and_apart(
            sizes in prop::collection::vec((1u32..20, 1u32..20), 1..60),
            side in 16u32..200,
        ) {
            let sizes: Vec<[u32; 2]> = sizes.into_iter().map(|(w, h)| [w, h]).collect();
            if let Some(packed) = pack(&sizes, side) {
                prop_assert!(packed.width <= side && packed.height <= side);
                let mut taken = vec![false; (packed.width * packed.height) as usize];
                for (&[w, h], &[x, y]) in sizes.iter().zip(&packed.places) {
                    for (i, j) in (x..x + w).flat_map(|i| (y..y + h).map(move |j| (i, j))) {
                        prop_assert!(i < packed.width && j < packed.height);
                        let texel = &mut taken[(j * packed.width + i) as usize];
                        prop_assert!(!std::mem::replace(texel, true));
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_too_much_is_refused() {
        assert!(pack(&[[20, 1]], 16).is_none());
        assert!(pack(&[[16, 16], [1, 1]], 16).is_none());
        assert_eq!(pack(&[[16, 16]], 16).unwrap().places, [[0, 0]]);
        assert!(pack(&[], 16).is_some());
    }
}
