//! The order of places: what is alike lies together.

use super::super::omega::{Lengths, OmegaOptions, Seen};
use super::{BUCKET, Place};

/// Fewer places than these are not worth another thread.
const PART: usize = 1 << 12;

/// What places are sorted by, weighted so that equal distances are about equally
/// unlike.
struct Key {
    at: [f32; 6],
    place: u32,
}

/// Number of buckets, a power of two, of at most [`BUCKET`] places each.
pub(super) fn buckets(places: usize) -> usize {
    places.div_ceil(BUCKET).next_power_of_two()
}

/// First place of a bucket.
pub(super) fn start(bucket: usize, buckets: usize, places: usize) -> usize {
    (bucket as u64 * places as u64 / buckets as u64) as usize
}

/// Orders places so that every half, quarter and so on of the buckets is apart
/// from the other in what spreads most: a k-d tree over place and colour.
pub(super) fn sort(places: &mut Vec<Place>, options: &OmegaOptions) {
    let mut keys = keys(places, options);
    let all = Part {
        first: 0,
        count: buckets(keys.len()),
        buckets: buckets(keys.len()),
        places: keys.len(),
    };
    all.split(&mut keys);
    *places = keys.iter().map(|k| places[k.place as usize]).collect();
}

fn keys(places: &[Place], options: &OmegaOptions) -> Vec<Key> {
    let diagonals = places.iter().map(|p| p.seen.object.bounds.diagonal());
    let size = diagonals.sum::<f64>() / places.len().max(1) as f64;
    let origin = places.first().map(|p| p.seen.object.bounds.center());
    let origin = origin.unwrap_or_default();
    let (by_length, by_color) = match options.lengths {
        Lengths::World => (options.shape / size.max(1e-30), options.color),
        Lengths::Pair => (options.shape + options.color, options.color * size),
    };
    let by_length = options.proximity + by_length;
    let key = |(i, place): (usize, &Place)| {
        let Seen { object, shade } = &place.seen;
        let [x, y, z] = ((object.bounds.center() - origin) * by_length).to_array();
        let [l, a, b] = (shade.as_dvec3() * by_color).to_array();
        Key {
            at: [x, y, z, l, a, b].map(|v| v as f32),
            place: i as u32,
        }
    };
    places.iter().enumerate().map(key).collect()
}

/// Consecutive buckets, out of how many, over how many places.
#[derive(Clone, Copy)]
struct Part {
    first: usize,
    count: usize,
    buckets: usize,
    places: usize,
}

impl Part {
    fn split(self, keys: &mut [Key]) {
        if self.count < 2 || keys.len() < 2 {
            return;
        }
        let half = self.count / 2;
        let begin = start(self.first, self.buckets, self.places);
        let middle = start(self.first + half, self.buckets, self.places) - begin;
        let axis = widest(keys);
        let order = |a: &Key, b: &Key| {
            a.at[axis]
                .total_cmp(&b.at[axis])
                .then(a.place.cmp(&b.place))
        };
        if (1..keys.len()).contains(&middle) {
            keys.select_nth_unstable_by(middle, order);
        }
        let (low, high) = keys.split_at_mut(middle);
        let parts = [self.first, self.first + half].map(|first| Self {
            first,
            count: half,
            ..self
        });
        if low.len() < PART {
            parts[0].split(low);
            parts[1].split(high);
        } else {
            rayon::join(|| parts[0].split(low), || parts[1].split(high));
        }
    }
}

fn widest(keys: &[Key]) -> usize {
    let mut low = [f32::INFINITY; 6];
    let mut high = [f32::NEG_INFINITY; 6];
    for key in keys {
        for k in 0..6 {
            low[k] = low[k].min(key.at[k]);
            high[k] = high[k].max(key.at[k]);
        }
    }
    let spread = |k: &usize| high[*k] - low[*k];
    (1..6).fold(
        0,
        |best, k| if spread(&k) > spread(&best) { k } else { best },
    )
}
