//! Sharpness from level to level, and which rule it makes a vertex follow.
//!
//! DeRose, Kass and Truong, "Subdivision surfaces in character animation", 1998: a vertex
//! follows the rule of its sharpness before the step, blended with that after it where a
//! sharpness ends within the step.

use super::cage::INFINITELY_SHARP;
use super::options::CreaseMethod;
use smallvec::SmallVec;

/// What a vertex is, by the sharp edges around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// No sharp edge, or one: a dart ends here, and nothing is different.
    Smooth,
    /// Two sharp edges: a curve.
    Crease,
    /// More, or itself sharp: fixed.
    Corner,
}

/// Sharpness of the edges around a vertex, in ring order.
pub(super) type Around = SmallVec<[f32; 8]>;

/// The rule before a step and after it, and the share of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// The rule of the level refined.
    pub before: Rule,
    /// The rule of the next level.
    pub after: Rule,
    /// Share of `before`, 0 to 1.
    pub share: f32,
}

impl Rule {
    /// The rule at a vertex of this sharpness.
    pub(super) fn of(vertex: f32, edges: &[f32]) -> Self {
        if vertex > 0.0 {
            return Self::Corner;
        }
        match edges.iter().filter(|&&s| s > 0.0).count() {
            0 | 1 => Self::Smooth,
            2 => Self::Crease,
            _ => Self::Corner,
        }
    }
}

/// Sharpness one level later.
pub(super) fn decayed(sharpness: f32) -> f32 {
    if sharpness >= INFINITELY_SHARP {
        return INFINITELY_SHARP;
    }
    (sharpness - 1.0).max(0.0)
}

/// Sharpness one level later of all edges around a vertex, the halves at that vertex.
pub(super) fn decayed_around(edges: &[f32], method: CreaseMethod) -> Around {
    let semi_sharp = |s: &&f32| **s > 0.0 && **s < INFINITELY_SHARP;
    let count = edges.iter().filter(semi_sharp).count();
    if method == CreaseMethod::Uniform || count < 2 {
        return edges.iter().map(|&s| decayed(s)).collect();
    }
    let sum: f32 = edges.iter().filter(semi_sharp).sum();
    let chaikin = |s: f32| {
        let others = (sum - s) / (count - 1) as f32;
        (0.75 * s + 0.25 * others - 1.0).max(0.0)
    };
    let next = |s: &f32| match *s {
        s if s <= 0.0 => 0.0,
        s if s >= INFINITELY_SHARP => INFINITELY_SHARP,
        s => chaikin(s),
    };
    edges.iter().map(next).collect()
}

/// How a vertex goes through one step. `edges` are those around it, `vertex` its own
/// sharpness.
pub(super) fn blend(vertex: f32, edges: &[f32], method: CreaseMethod) -> Blend {
    let before = Rule::of(vertex, edges);
    let same = Blend {
        before,
        after: before,
        share: 1.0,
    };
    if before == Rule::Smooth {
        return same;
    }
    let next_edges = decayed_around(edges, method);
    let next_vertex = decayed(vertex);
    let after = Rule::of(next_vertex, &next_edges);
    if after == before {
        return same;
    }
    let share = share(vertex, edges, &next_edges, method);
    Blend {
        before,
        after,
        share,
    }
}

/// Mean of the sharpness that ends in this step, at most 1.
pub(super) fn share(vertex: f32, edges: &[f32], next: &[f32], method: CreaseMethod) -> f32 {
    let (mut sum, mut count) = (0.0, 0);
    if vertex > 0.0 && decayed(vertex) <= 0.0 {
        (sum, count) = (vertex, 1);
    }
    for (&s, &n) in edges.iter().zip(next) {
        let ends = match method {
            CreaseMethod::Uniform => s > 0.0 && s <= 1.0,
            CreaseMethod::Chaikin => s > 0.0 && n <= 0.0,
        };
        if ends {
            sum += s;
            count += 1;
        }
    }
    if count == 0 {
        0.0
    } else {
        (sum / count as f32).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sharpness_decays_by_one_or_never() {
        assert_eq!(decayed(2.5), 1.5);
        assert_eq!(decayed(0.5), 0.0);
        assert_eq!(decayed(10.0), 10.0);
        let around = decayed_around(&[3.0, 1.0, 0.0, 12.0], CreaseMethod::Chaikin);
        assert_eq!(around.as_slice(), [1.5, 0.5, 0.0, 10.0]);
    }

    #[test]
    fn rules_and_shares() {
        let b = blend(0.0, &[0.25, 0.75, 0.0], CreaseMethod::Uniform);
        assert_eq!(
            (b.before, b.after, b.share),
            (Rule::Crease, Rule::Smooth, 0.5)
        );
        let b = blend(0.0, &[2.0, 2.0, 0.5], CreaseMethod::Uniform);
        assert_eq!(
            (b.before, b.after, b.share),
            (Rule::Corner, Rule::Crease, 0.5)
        );
        let b = blend(1.0, &[0.0; 3], CreaseMethod::Uniform);
        assert_eq!(
            (b.before, b.after, b.share),
            (Rule::Corner, Rule::Smooth, 1.0)
        );
        assert_eq!(Rule::of(0.0, &[3.0]), Rule::Smooth);
    }
}
