//! Surfaces whose vertices have weights: refined in homogeneous coordinates, then projected.

use super::cage::not_finite;
use super::control_mesh::ControlMesh;
use super::limit::Limits;
use super::refinement::Refinement;
use crate::error::{Error, Result};
use glam::Vec3;

/// Positions after the last step.
///
/// # Errors
/// As [`Refinement::evaluate`]; [`Error::LengthMismatch`], [`Error::NotFinite`] or, if not
/// positive, [`Error::BadOption`] for a weight.
pub(super) fn positions(control: &ControlMesh, refinement: &Refinement) -> Result<Vec<Vec3>> {
    let Some(weights) = &control.weights else {
        let cage: Vec<[f32; 3]> = control.positions.iter().map(Vec3::to_array).collect();
        let positions = refinement.evaluate(&cage)?.into_iter();
        return Ok(positions.map(Vec3::from).collect());
    };
    check(weights, control.positions.len())?;
    let weighted = |(p, &w): (&Vec3, &f32)| (*p * w).extend(w).to_array();
    let cage: Vec<[f32; 4]> = control
        .positions
        .iter()
        .zip(weights)
        .map(weighted)
        .collect();
    let positions = refinement.evaluate(&cage)?.into_iter();
    Ok(positions
        .map(|[x, y, z, w]| Vec3::new(x, y, z) / w)
        .collect())
}

/// The surface at all vertices after the last step; tangents by the rule of quotients.
///
/// # Errors
/// As [`positions`] and [`Refinement::limits`].
pub(super) fn limits(control: &ControlMesh, refinement: &Refinement) -> Result<Limits> {
    let at = |p: &Vec3, w: f32| (*p * w).to_array();
    let Some(weights) = &control.weights else {
        let cage = control.positions.iter().map(|p| at(p, 1.0));
        return refinement.limits(&cage.collect::<Vec<_>>());
    };
    check(weights, control.positions.len())?;
    let weighted = control.positions.iter().zip(weights);
    let mut limits = refinement.limits(&weighted.map(|(p, &w)| at(p, w)).collect::<Vec<_>>())?;
    let below = refinement.limits(&weights.iter().map(|&w| [w, 0.0, 0.0]).collect::<Vec<_>>())?;
    for v in 0..limits.positions.len() {
        let weight = below.positions[v].x;
        let place = limits.positions[v] / weight;
        let [a, b] = [0, 1].map(|i| {
            let (over, under) = (limits.tangents[v][i], below.tangents[v][i].x);
            (over - place * under) / weight
        });
        // What has no tangent plane in four dimensions has none in three.
        if limits.normals[v] != Vec3::ZERO {
            let normal = a.as_dvec3().cross(b.as_dvec3());
            limits.normals[v] = normal.normalize_or_zero().as_vec3();
        }
        (limits.positions[v], limits.tangents[v]) = (place, [a, b]);
    }
    Ok(limits)
}

/// That weights are one a vertex, finite and more than 0.
pub(super) fn check(weights: &[f32], vertices: usize) -> Result<()> {
    if weights.len() != vertices {
        return Err(Error::LengthMismatch {
            what: "weights".into(),
            expected: vertices,
            found: weights.len(),
        });
    }
    if let Some(index) = weights.iter().position(|w| !w.is_finite()) {
        return Err(not_finite("weight", index));
    }
    match weights.iter().position(|&w| w <= 0.0) {
        Some(index) => Err(Error::BadOption {
            option: "weight",
            found: format!("{} at {index}", weights[index]),
            expected: "more than 0",
        }),
        None => Ok(()),
    }
}
