//! Bounding volumes out of JSON, and the rules for their numbers.

use super::{
    at::At,
    findings::Notes,
    model::{BoundingVolume, Region, Shape},
    parse::{into_object, numbers, wrong},
};
use glam::DVec3;
use serde_json::{Map, Value};
use std::f64::consts::{FRAC_PI_2, PI};

/// Cosine of the angle between two half axes from which on they are told not
/// to be at right angles.
const SKEW: f64 = 1e-2;
/// Radians by which an angle may be out of its range: text is rounded.
const ANGLE: f64 = 1e-9;

/// Reads a bounding volume; the shape is `None` where it is wrong.
pub(super) fn volume(value: Value, at: &At<'_>, notes: &mut Notes<'_>) -> BoundingVolume {
    let Some(mut json) = into_object(value, at, notes) else {
        return BoundingVolume::default();
    };
    let kinds = ["box", "region", "sphere"];
    let Some(kind) = kinds.into_iter().find(|k| json.contains_key(*k)) else {
        if !json.contains_key("extensions") {
            notes.error(at, "volume-shape", "`box`, `region` or `sphere`", "none");
        }
        return BoundingVolume {
            shape: None,
            other: json,
        };
    };
    let numbers = take(&mut json, kind, at, notes);
    let at = at.key(kind);
    let shape = numbers.and_then(|n| match kind {
        "box" => oriented_box(&n, &at, notes),
        "region" => region(&n, &at, notes),
        _ => sphere(&n, &at, notes),
    });
    BoundingVolume { shape, other: json }
}

/// The numbers of a shape, in the count that it has.
fn take(
    json: &mut Map<String, Value>,
    kind: &str,
    at: &At<'_>,
    notes: &mut Notes<'_>,
) -> Option<Vec<f64>> {
    let value = json.shift_remove(kind)?;
    let at = at.key(kind);
    let found = numbers(&value, &at, notes)?;
    let expected = match kind {
        "box" => 12,
        "region" => 6,
        _ => 4,
    };
    if found.len() != expected {
        wrong(&at, &format!("{expected} numbers"), &value, notes);
        return None;
    }
    Some(found)
}

fn oriented_box(n: &[f64], at: &At<'_>, notes: &mut Notes<'_>) -> Option<Shape> {
    let half_axes = [3, 6, 9].map(|i| DVec3::from_slice(&n[i..]));
    if half_axes.iter().all(|a| *a == DVec3::ZERO) {
        notes.error(
            at,
            "box-degenerate",
            "a half axis that is not 0",
            "three of 0",
        );
        return None;
    }
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let cosine = half_axes[i]
            .normalize_or_zero()
            .dot(half_axes[j].normalize_or_zero());
        if cosine.abs() > SKEW {
            let found = format!("a cosine of {cosine:.3} between {i} and {j}");
            notes.warn(at, "box-skewed", "half axes at right angles", found);
        }
    }
    Some(Shape::Box {
        center: DVec3::from_slice(n),
        half_axes,
    })
}

fn sphere(n: &[f64], at: &At<'_>, notes: &mut Notes<'_>) -> Option<Shape> {
    if n[3] < 0.0 {
        notes.error(
            at,
            "sphere-radius",
            "a radius of at least 0",
            n[3].to_string(),
        );
        return None;
    }
    Some(Shape::Sphere {
        center: DVec3::from_slice(n),
        radius: n[3],
    })
}

fn region(n: &[f64], at: &At<'_>, notes: &mut Notes<'_>) -> Option<Shape> {
    let limits = [PI, FRAC_PI_2, PI, FRAC_PI_2];
    for (i, limit) in limits.into_iter().enumerate() {
        if n[i].abs() > limit + ANGLE {
            let expected = format!("radians from -{limit} to {limit}");
            notes.error(at.index(i), "region-range", expected, n[i].to_string());
            return None;
        }
    }
    for (low, high, what) in [(1, 3, "south"), (4, 5, "minimum height")] {
        if n[low] > n[high] {
            let expected = format!("a {what} of at most {}", n[high]);
            notes.error(at, "region-order", expected, n[low].to_string());
            return None;
        }
    }
    Some(Shape::Region(Region {
        west: n[0],
        south: n[1],
        east: n[2],
        north: n[3],
        min_height: n[4],
        max_height: n[5],
    }))
}
