//! Values of vertices, evened out over the surface around them.

use super::gauss::Tree;
use super::stars::Stars;
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use glam::DVec3;

/// Width that suits hybrid saliency before it steers simplification
/// (`karui bench saliency`).
pub const SMOOTHING: f64 = 0.02;

/// Makes every value the mean of those around it, weighted by a Gaussian of
/// `width`, a part of the diagonal of the bounding box, and cut off at twice
/// that, as [`mesh_saliency`](super::mesh_saliency) has its neighbourhoods: a
/// triangle that is left of many covers them all, so that a vertex that matters
/// alone cannot be given any.
///
/// Vertices at one position are one point, with the mean of their values; those
/// of no triangle keep theirs. 0 smooths nothing. Same bits for any number of
/// threads.
///
/// # Errors
/// [`Error::BadOption`] for a width that is not 0 to 1 or below 1e-5 but not 0,
/// [`Error::LengthMismatch`] if there is not one value a vertex,
/// [`Error::NotFinite`] for a value or a position that is not,
/// [`Error::IndexOutOfRange`], [`Error::TooLarge`].
pub fn smooth(mesh: &TriMesh, values: &[f32], width: f64) -> Result<Vec<f32>> {
    check(mesh, values, width)?;
    if width == 0.0 {
        return Ok(values.to_vec());
    }
    let stars = Stars::of(mesh)?;
    let has_triangle = |&p: &u32| !stars.around(p as usize).is_empty();
    let of_points: Vec<u32> = (0..stars.points.len() as u32)
        .filter(has_triangle)
        .collect();
    let known = means(&stars, values);
    let places: Vec<DVec3> = of_points
        .iter()
        .map(|&p| stars.points[p as usize])
        .collect();
    let own: Vec<f64> = of_points.iter().map(|&p| known[p as usize]).collect();
    let low = places.iter().copied().reduce(DVec3::min);
    let high = places.iter().copied().reduce(DVec3::max);
    let (Some(low), Some(high)) = (low, high) else {
        return Ok(values.to_vec());
    };
    let diagonal = low.distance(high);
    let found = Tree::new(&places, &own, diagonal).means(width * diagonal);
    let mut all: Vec<Option<f32>> = vec![None; stars.points.len()];
    for (&p, value) in of_points.iter().zip(found) {
        all[p as usize] = Some(value as f32);
    }
    let smoothed = stars.spread(&all).into_iter().zip(values);
    Ok(smoothed.map(|(s, &own)| s.unwrap_or(own)).collect())
}

/// Of the vertices at every point.
fn means(stars: &Stars, values: &[f32]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0u32); stars.points.len()];
    for (&p, &value) in stars.ids.of_vertex.iter().zip(values) {
        let (sum, count) = &mut sums[p as usize];
        *sum += f64::from(value);
        *count += 1;
    }
    let mean = |(sum, count): (f64, u32)| sum / f64::from(count.max(1));
    sums.into_iter().map(mean).collect()
}

fn check(mesh: &TriMesh, values: &[f32], width: f64) -> Result<()> {
    if width != 0.0 && !(1e-5..=1.0).contains(&width) {
        return Err(Error::BadOption {
            option: "width",
            found: width.to_string(),
            expected: "0, or 1e-5 to 1",
        });
    }
    let (expected, found) = (mesh.positions.len(), values.len());
    if expected != found {
        let what = "values".into();
        return Err(Error::LengthMismatch {
            what,
            expected,
            found,
        });
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(Error::NotFinite {
            what: "value".into(),
            index,
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    /// The definition, over all pairs of points.
    fn plain(points: &[DVec3], values: &[f32], width: f64) -> Vec<f64> {
        let mean = |v: &DVec3| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (p, value) in points.iter().zip(values) {
                let square = p.distance_squared(*v) / (width * width);
                if square < 4.0 {
                    let weight = (-0.5 * square).exp();
                    sum += weight * f64::from(*value);
                    weights += weight;
                }
            }
            sum / weights
        };
        points.iter().map(mean).collect()
    }

    #[test]
    fn means_are_those_of_the_definition() {
        let mesh = shapes::icosphere(4);
        let points: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
        let values: Vec<f32> = (0..points.len()).map(|i| ((i * 37) % 101) as f32).collect();
        let diagonal = 12f64.sqrt();
        for width in [0.02, 0.05] {
            let found = smooth(&mesh, &values, width).unwrap();
            let expected = plain(&points, &values, width * diagonal);
            let off = |(f, e): (&f32, f64)| (f64::from(*f) - e).abs();
            let worst = found.iter().zip(expected).map(off).fold(0.0, f64::max);
            assert!(worst < 1.0, "{width}: {worst}");
        }
    }

    #[test]
    fn even_values_stay_and_seams_do_not_tear() {
        let mesh = shapes::cube(3);
        let even = vec![0.25; mesh.positions.len()];
        for value in smooth(&mesh, &even, 0.1).unwrap() {
            assert!((value - 0.25).abs() < 1e-6);
        }
        let odd: Vec<f32> = (0..mesh.positions.len()).map(|i| i as f32).collect();
        let found = smooth(&mesh, &odd, 0.1).unwrap();
        for (i, p) in mesh.positions.iter().enumerate() {
            let twin = mesh.positions.iter().position(|q| q == p);
            assert_eq!(twin.map(|t| found[t]), Some(found[i]));
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let mesh = shapes::icosphere(1);
        let values = vec![0.0; mesh.positions.len()];
        assert_eq!(smooth(&mesh, &values, 0.0), Ok(values.clone()));
        assert!(smooth(&mesh, &values, -0.1).is_err());
        assert!(smooth(&mesh, &values, f64::NAN).is_err());
        assert!(smooth(&mesh, &values[1..], 0.1).is_err());
        let mut bad = values;
        bad[3] = f32::NAN;
        assert!(smooth(&mesh, &bad, 0.1).is_err());
        assert_eq!(smooth(&TriMesh::default(), &[], 0.1), Ok(Vec::new()));
    }
}
