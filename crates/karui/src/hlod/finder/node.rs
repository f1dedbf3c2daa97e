//! Boxes over clusters, and how unlike anything in one is at least.
//!
//! Numbers are of single precision, in a space in which all clusters lie in the
//! unit cube; they are rounded towards the greater box, and bounds are made a
//! little smaller than computed, so that rounding hides no cluster.

use super::super::bounds::Bounds;
use super::super::omega::{OmegaOptions, Seen, Unlike};
use super::NONE;
use crate::geom::DVec3;
use glam::{Vec3, Vec3A};

/// What is left of a bound for rounding: each of some ten operations has an error
/// of at most 2^-24.
const SLACK: f64 = 1.0 - 1e-5;
/// The same for a share in 0..=1, where it is an absolute error.
const SHARE_SLACK: f32 = 4e-6;
/// Merged volumes below are not trusted: products of single precision end there.
const LEAST_VOLUME: f32 = 1e-30;

/// The space in which boxes are compared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    origin: DVec3,
    /// Of the unit cube, world units.
    size: f64,
}

impl Frame {
    pub fn around<'a>(boxes: impl Iterator<Item = &'a Bounds>) -> Self {
        let all = boxes.copied().reduce(|a, b| a.union(&b));
        let all = all.unwrap_or(Bounds::point(DVec3::ZERO));
        let size = all.size().max_element();
        Self {
            origin: all.min,
            size: if size > 1e-30 { size } else { 1.0 },
        }
    }

    fn place(&self, point: DVec3) -> Vec3A {
        ((point - self.origin) / self.size).as_vec3a()
    }

    fn volume(&self, volume: f64) -> f32 {
        (volume / self.size / self.size / self.size) as f32
    }
}

fn down(v: Vec3A) -> Vec3A {
    Vec3A::from_array(v.to_array().map(f32::next_down))
}

fn up(v: Vec3A) -> Vec3A {
    Vec3A::from_array(v.to_array().map(f32::next_up))
}

/// What is known of all clusters below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    low: Vec3A,
    high: Vec3A,
    /// Least of the greatest corners: whatever is merged with one of these reaches
    /// as far as this.
    least_high: Vec3A,
    /// Greatest of the least corners.
    greatest_low: Vec3A,
    shade_low: Vec3A,
    shade_high: Vec3A,
    /// Greatest volume.
    volume: f32,
    /// Least number of a cluster.
    pub first: u32,
}

impl Node {
    pub const EMPTY: Self = Self {
        low: Vec3A::INFINITY,
        high: Vec3A::NEG_INFINITY,
        least_high: Vec3A::INFINITY,
        greatest_low: Vec3A::NEG_INFINITY,
        shade_low: Vec3A::INFINITY,
        shade_high: Vec3A::NEG_INFINITY,
        volume: 0.0,
        first: NONE,
    };

    pub fn of(seen: &Seen, cluster: u32, frame: &Frame) -> Self {
        let query = Query::new(seen, frame);
        Self {
            low: query.low,
            high: query.high,
            least_high: query.inner_high,
            greatest_low: query.inner_low,
            shade_low: query.shade,
            shade_high: query.shade,
            volume: query.volume,
            first: cluster,
        }
    }

    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            least_high: self.least_high.min(other.least_high),
            greatest_low: self.greatest_low.max(other.greatest_low),
            shade_low: self.shade_low.min(other.shade_low),
            shade_high: self.shade_high.max(other.shade_high),
            volume: self.volume.max(other.volume),
            first: self.first.min(other.first),
        }
    }
}

/// A cluster whose partner is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Query<'a> {
    pub seen: &'a Seen,
    low: Vec3A,
    high: Vec3A,
    inner_low: Vec3A,
    inner_high: Vec3A,
    shade: Vec3A,
    volume: f32,
}

impl<'a> Query<'a> {
    pub fn new(seen: &'a Seen, frame: &Frame) -> Self {
        let low = frame.place(seen.object.bounds.min);
        let high = frame.place(seen.object.bounds.max);
        Self {
            seen,
            low: down(low),
            high: up(high),
            inner_low: up(low),
            inner_high: down(high),
            shade: Vec3::into(seen.shade),
            volume: frame.volume(seen.object.volume).next_up(),
        }
    }

    /// No cluster below `node` has a lesser Omega0 with this one.
    #[inline]
    pub fn bound(&self, node: &Node, frame: &Frame, options: &OmegaOptions) -> f64 {
        if node.first == NONE {
            return f64::INFINITY;
        }
        let apart = (node.low - self.high).max(self.low - node.high);
        let far = self.inner_high.max(node.least_high);
        let size = (far - self.inner_low.min(node.greatest_low)).max(Vec3A::ZERO);
        let color = (node.shade_low - self.shade).max(self.shade - node.shade_high);
        let unlike = Unlike {
            gap: f64::from(apart.max(Vec3A::ZERO).length()) * frame.size,
            shape: f64::from(self.least_added(size, node.volume)),
            color: f64::from(color.max(Vec3A::ZERO).length()),
            diagonal: f64::from(size.length()) * frame.size,
        };
        unlike.omega0(options) * SLACK
    }

    /// The merged volume is no less than that of a box of this size.
    #[inline]
    fn least_added(&self, size: Vec3A, volume: f32) -> f32 {
        let merged = size.x * size.y * size.z;
        if merged < LEAST_VOLUME {
            return 0.0;
        }
        (1.0 - (self.volume + volume) / merged - SHARE_SLACK).max(0.0)
    }
}
