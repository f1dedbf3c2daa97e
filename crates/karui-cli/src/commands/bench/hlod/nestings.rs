//! Groups by place alone: an octree, and k-means again and again.

use karui::geom::DVec3;
use karui::hlod::{Bounds, Member, Nest, Object};

/// Groups in groups; a group weighs as much as its box is long.
pub fn nested(objects: &[Object], split: fn(&[DVec3]) -> Vec<usize>) -> Vec<Nest> {
    let mut nests = Vec::new();
    let all: Vec<u32> = (0..objects.len() as u32).collect();
    if all.len() > 1 {
        nest(objects, &all, split, &mut nests);
    }
    nests
}

fn nest(
    objects: &[Object],
    ids: &[u32],
    split: fn(&[DVec3]) -> Vec<usize>,
    nests: &mut Vec<Nest>,
) -> Member {
    if let [alone] = ids {
        return Member::Object(*alone);
    }
    let centers: Vec<DVec3> = ids.iter().map(|&i| center(objects, i)).collect();
    let parts = split(&centers);
    let count = parts.iter().max().map_or(0, |most| most + 1);
    let mut sorted = vec![Vec::new(); count];
    for (&id, part) in ids.iter().zip(parts) {
        sorted[part].push(id);
    }
    sorted.retain(|part| !part.is_empty());
    let children: Vec<Member> = match sorted.as_slice() {
        [_] => ids.iter().map(|&id| Member::Object(id)).collect(),
        parts => parts
            .iter()
            .map(|part| nest(objects, part, split, nests))
            .collect(),
    };
    let bounds = ids.iter().map(|&i| objects[i as usize].bounds);
    let around: Option<Bounds> = bounds.reduce(|a, b| a.union(&b));
    let omega0 = around.map_or(0.0, |b| b.diagonal());
    nests.push(Nest { children, omega0 });
    Member::Group(nests.len() as u32 - 1)
}

fn center(objects: &[Object], id: u32) -> DVec3 {
    objects[id as usize].bounds.center()
}

/// Which octant everything lies in, of the smallest cell of halves of halves of a cube
/// that holds all; all in one where they cannot be told apart.
pub fn octants(points: &[DVec3]) -> Vec<usize> {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let side = (high - low).max_element();
    if side <= 0.0 {
        return vec![0; points.len()];
    }
    // Cells of the first power of two that is no smaller; a border may still run
    // through what is smaller than a cell.
    let mut cell = side.log2().ceil().exp2();
    while (low / cell).floor() == (high / cell).floor() {
        cell *= 0.5;
    }
    let first = (low / cell).floor();
    let octant = |p: &DVec3| {
        let at = ((*p / cell).floor() - first).min(DVec3::ONE);
        (at.x + 2.0 * at.y + 4.0 * at.z) as usize
    };
    points.iter().map(octant).collect()
}

/// Clusters of a split.
const K: usize = 8;
/// Rounds of Lloyd's algorithm.
const ROUNDS: usize = 12;

/// k-means of 8 clusters: starts with points far from each other, then Lloyd's rounds.
pub fn clusters(points: &[DVec3]) -> Vec<usize> {
    let mut means = far_apart(points);
    let mut found = nearest(points, &means);
    for _ in 0..ROUNDS {
        let mut sums = vec![(DVec3::ZERO, 0.0); means.len()];
        for (point, &cluster) in points.iter().zip(&found) {
            sums[cluster].0 += *point;
            sums[cluster].1 += 1.0;
        }
        for (mean, (sum, count)) in means.iter_mut().zip(sums) {
            if count > 0.0 {
                *mean = sum / count;
            }
        }
        found = nearest(points, &means);
    }
    found
}

/// The first point, and again and again that farthest from those chosen.
fn far_apart(points: &[DVec3]) -> Vec<DVec3> {
    let mut chosen = vec![points[0]];
    let mut distances = vec![f64::INFINITY; points.len()];
    while chosen.len() < K.min(points.len()) {
        let last = chosen[chosen.len() - 1];
        let mut farthest = 0;
        for (i, p) in points.iter().enumerate() {
            distances[i] = distances[i].min(p.distance_squared(last));
            if distances[i] > distances[farthest] {
                farthest = i;
            }
        }
        if distances[farthest] <= 0.0 {
            break;
        }
        chosen.push(points[farthest]);
    }
    chosen
}

fn nearest(points: &[DVec3], means: &[DVec3]) -> Vec<usize> {
    let of = |p: &DVec3| {
        let distances = means.iter().map(|m| m.distance_squared(*p)).enumerate();
        let least = distances.min_by(|a, b| a.1.total_cmp(&b.1));
        least.map_or(0, |(i, _)| i)
    };
    points.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use karui::hlod::{Tree, TreeOptions};

    fn points() -> Vec<DVec3> {
        let at = |i: u32| f64::from(i * 37 % 101) * 0.7 - 30.0;
        (0..200)
            .map(|i| DVec3::new(at(i), 0.2, at(i * i)))
            .collect()
    }

    #[test]
    fn both_nest_everything_and_hold_together() {
        let object = |p: DVec3| Object {
            bounds: Bounds {
                min: p,
                max: p + 1.0,
            },
            volume: 1.0,
            area: 6.0,
            color: Vec3::ZERO,
            velocity: Vec3::ZERO,
        };
        let mut objects: Vec<Object> = points().into_iter().map(object).collect();
        objects.extend(objects[..9].to_vec());
        for split in [octants, clusters] {
            let nests = nested(&objects, split);
            let tree = Tree::of_nesting(objects.clone(), &nests, &TreeOptions::default());
            let tree = tree.unwrap();
            tree.validate().unwrap();
            assert_eq!(tree.roots().len(), 1);
        }
        assert!(nested(&objects[..1], octants).is_empty());
    }

    #[test]
    fn octants_are_those_of_a_regular_grid() {
        let [a, b, c] = [0.1, 0.4, 0.6].map(DVec3::splat);
        assert_eq!(octants(&[a, b, c]), [0, 0, 7]);
        assert_eq!(octants(&[a, a]), [0, 0]);
    }

    #[test]
    fn clusters_are_told_apart() {
        let near = |x: f64| [DVec3::X * x, DVec3::X * (x + 0.1)];
        let all: Vec<DVec3> = (0..8).flat_map(|i| near(10.0 * f64::from(i))).collect();
        let found = clusters(&all);
        assert!(found.chunks(2).all(|pair| pair[0] == pair[1]));
        assert_eq!(
            found
                .iter()
                .collect::<std::collections::BTreeSet<_>>()
                .len(),
            8
        );
    }
}
