//! Cuts the triangles into blocks of about equal size.

use super::level::Level;
use glam::Vec3;

/// Triangles of a block at most: a block and its scratch then fit in a
/// second-level cache of a megabyte.
const BLOCK: usize = 8192;
/// Triangles from which on halves are cut by two threads.
const PARALLEL: usize = 1 << 16;

/// A triangle and its centre.
type Item = (Vec3, u32);

/// Triangles of every block. Cuts lie elsewhere in an odd `phase` than in an
/// even one, so that what lies between blocks in one is inside them in the
/// next.
pub(super) fn blocks(level: &Level, phase: usize) -> Vec<Vec<u32>> {
    let center = |(t, points): (usize, &[u32; 3])| {
        let [a, b, c] = points.map(|p| level.position[p as usize]);
        (a + b + c, t as u32)
    };
    let mut items: Vec<Item> = level.triangle.iter().enumerate().map(center).collect();
    cut(&mut items, phase)
}

fn cut(items: &mut [Item], phase: usize) -> Vec<Vec<u32>> {
    if items.len() <= BLOCK {
        let mut block: Vec<u32> = items.iter().map(|item| item.1).collect();
        block.sort_unstable();
        return vec![block];
    }
    let axis = longest_axis(items);
    // Whole blocks on either side; in odd phases off the middle.
    let parts = items.len().div_ceil(BLOCK);
    let share = if phase.is_multiple_of(2) { 0.5 } else { 0.36 };
    let left = ((parts as f64 * share).round().max(1.0) / parts as f64).clamp(0.25, 0.75);
    let at = if phase.is_multiple_of(2) {
        (items.len() as f64 * left) as usize
    } else {
        (items.len() as f64 * share) as usize
    };
    items.select_nth_unstable_by(at, |a, b| by_axis(axis, a, b));
    let (low, high) = items.split_at_mut(at);
    let (mut low, high) = if low.len() + high.len() > PARALLEL {
        rayon::join(|| cut(low, phase), || cut(high, phase))
    } else {
        (cut(low, phase), cut(high, phase))
    };
    low.extend(high);
    low
}

fn by_axis(axis: usize, a: &Item, b: &Item) -> std::cmp::Ordering {
    a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1))
}

fn longest_axis(items: &[Item]) -> usize {
    let first = items.first().map_or(Vec3::ZERO, |item| item.0);
    let (least, most) = items.iter().fold((first, first), |(least, most), item| {
        (least.min(item.0), most.max(item.0))
    });
    let size = most - least;
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}
