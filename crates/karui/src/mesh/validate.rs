//! Whether a mesh keeps the promises of its type. What is legal but unusual
//! (holes, non-manifold edges, slivers) is `diagnose`'s business.

use super::TriMesh;
use super::attributes::{Attribute, Attributes, MorphTarget, SkinWeights};
use crate::error::{Error, Result};
use glam::Vec3;
use rayon::prelude::*;

impl TriMesh {
    /// Checks that every index exists, every attribute array has one entry per
    /// element, every value is finite and material ranges tile the triangles.
    /// Custom attributes may hold NaN: scans use it for "no data".
    ///
    /// # Errors
    /// The first fault found: [`Error::TooLarge`],
    /// [`Error::IndexOutOfRange`], [`Error::LengthMismatch`],
    /// [`Error::NotFinite`], [`Error::BadRange`] or [`Error::BadOption`] for an
    /// attribute without components.
    pub fn validate(&self) -> Result<()> {
        self.validate_indices()?;
        self.validate_lengths()?;
        self.validate_ranges()?;
        finite_vectors(|| "position".into(), &self.positions)?;
        self.attributes.validate_values()
    }

    /// Only the part of [`TriMesh::validate`] that indexing relies on.
    pub(crate) fn validate_indices(&self) -> Result<()> {
        let vertices = self.positions.len();
        fits("vertices", vertices)?;
        fits("triangles", self.triangles.len())?;
        let is_bad = |&v: &u32| v as usize >= vertices;
        match first_position(&self.triangles, |t| t.iter().any(is_bad)) {
            None => Ok(()),
            Some(face) => Err(Error::IndexOutOfRange {
                face,
                index: self.triangles[face]
                    .into_iter()
                    .find(is_bad)
                    .unwrap_or_default(),
                vertices,
            }),
        }
    }

    /// Only the part of [`TriMesh::validate`] that gathering relies on.
    pub(crate) fn validate_lengths(&self) -> Result<()> {
        let vertices = self.positions.len();
        let triangles = self.triangles.len();
        custom_lengths("attribute", &self.attributes.custom, vertices)?;
        custom_lengths("face attribute", &self.face_attributes, triangles)?;
        let mut lengths = self.attributes.lengths().into_iter();
        lengths.try_for_each(|(what, found)| expect_length(what, vertices, found))
    }

    /// Only the part of [`TriMesh::validate`] that splitting by range relies on.
    pub(crate) fn validate_ranges(&self) -> Result<()> {
        let triangles = self.triangles.len();
        let mut next = 0;
        for (i, range) in self.ranges.iter().enumerate() {
            let covered = range.triangles();
            let is_last = i + 1 == self.ranges.len();
            if covered.start != next
                || covered.end > triangles
                || is_last && covered.end != triangles
            {
                return Err(Error::BadRange {
                    range: i,
                    first: covered.start,
                    end: covered.end,
                    triangles,
                });
            }
            next = covered.end;
        }
        Ok(())
    }
}

fn fits(what: &'static str, found: usize) -> Result<()> {
    // The last index is kept free to mean "none".
    let limit = u32::MAX as usize;
    if found > limit {
        return Err(Error::TooLarge { what, found, limit });
    }
    Ok(())
}

fn expect_length(what: String, expected: usize, found: usize) -> Result<()> {
    if found != expected {
        return Err(Error::LengthMismatch {
            what,
            expected,
            found,
        });
    }
    Ok(())
}

fn custom_lengths(kind: &str, attributes: &[Attribute], elements: usize) -> Result<()> {
    for attribute in attributes {
        if attribute.components == 0 {
            return Err(Error::BadOption {
                option: "components",
                found: format!("0 in {kind} `{}`", attribute.name),
                expected: "at least 1",
            });
        }
        let what = format!("{kind} `{}`", attribute.name);
        let expected = attribute.components.saturating_mul(elements);
        expect_length(what, expected, attribute.values.len())?;
    }
    Ok(())
}

impl Attributes {
    fn validate_values(&self) -> Result<()> {
        if let Some(normals) = &self.normals {
            finite_vectors(|| "normal".into(), normals)?;
        }
        if let Some(tangents) = &self.tangents {
            all_finite(|| "tangent".into(), tangents, |t| t.is_finite())?;
        }
        for (i, set) in self.uvs.iter().enumerate() {
            all_finite(|| format!("uv set {i}"), set, |uv| uv.is_finite())?;
        }
        for (i, set) in self.colors.iter().enumerate() {
            all_finite(|| format!("colour set {i}"), set, |c| c.is_finite())?;
        }
        for (i, set) in self.skins.iter().enumerate() {
            let weights_finite = |s: &SkinWeights| s.weights.iter().all(|w| w.is_finite());
            all_finite(|| format!("skin set {i}"), set, weights_finite)?;
        }
        for (i, morph) in self.morphs.iter().enumerate() {
            morph.validate_values(i)?;
        }
        Ok(())
    }
}

impl MorphTarget {
    fn validate_values(&self, i: usize) -> Result<()> {
        let parts = [
            ("position", &self.positions),
            ("normal", &self.normals),
            ("tangent", &self.tangents),
        ];
        for (part, values) in parts {
            let name = || format!("morph target {i} {part}");
            finite_vectors(name, values.as_deref().unwrap_or_default())?;
        }
        Ok(())
    }
}

fn finite_vectors(what: impl Fn() -> String, values: &[Vec3]) -> Result<()> {
    all_finite(what, values, |v| v.is_finite())
}

/// Index of the first bad value. Chunks are looked at as a whole first, which
/// takes a tenth of the time of asking after every value whether to go on.
fn first_position<T: Sync>(values: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    const CHUNK: usize = 4096;
    let any = |chunk: &[T]| chunk.iter().fold(false, |any, v| any | is_bad(v));
    let chunk = values.par_chunks(CHUNK).position_first(any)?;
    let found = values.iter().skip(chunk * CHUNK).position(is_bad)?;
    Some(chunk * CHUNK + found)
}

fn all_finite<T: Sync>(
    what: impl Fn() -> String,
    values: &[T],
    is_finite: impl Fn(&T) -> bool + Sync,
) -> Result<()> {
    match first_position(values, |v| !is_finite(v)) {
        None => Ok(()),
        Some(index) => Err(Error::NotFinite {
            what: what(),
            index,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AttributeValues, MaterialRange, shapes};

    type Fault = fn(&mut TriMesh);

    fn broken(fault: impl FnOnce(&mut TriMesh)) -> Error {
        let mut mesh = shapes::loaded_sphere(4, 5);
        mesh.validate().unwrap();
        fault(&mut mesh);
        mesh.validate().unwrap_err()
    }

    #[test]
    fn indices_are_checked() {
        let mesh = TriMesh::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2], [0, 3, 1]]);
        let expected = Error::IndexOutOfRange {
            face: 1,
            index: 3,
            vertices: 3,
        };
        assert_eq!(mesh.validate(), Err(expected));
    }

    #[test]
    fn every_array_length_is_checked() {
        let faults: [(&str, Fault); 11] = [
            ("normals", |m| {
                m.attributes.normals.as_mut().unwrap().clear()
            }),
            ("tangents", |m| {
                m.attributes.tangents.as_mut().unwrap().clear()
            }),
            ("uv set 1", |m| m.attributes.uvs[1].clear()),
            ("colour set 0", |m| m.attributes.colors[0].clear()),
            ("skin set 0", |m| m.attributes.skins[0].clear()),
            ("morph target 0 positions", |m| {
                m.attributes.morphs[0].positions = Some(vec![])
            }),
            ("morph target 0 normals", |m| {
                m.attributes.morphs[0].normals = Some(vec![])
            }),
            ("morph target 0 tangents", |m| {
                m.attributes.morphs[0].tangents = Some(vec![])
            }),
            ("attribute `heights`", |m| {
                m.attributes.custom[0].components = 3
            }),
            ("attribute `heights`", |m| {
                let AttributeValues::F32(values) = &mut m.attributes.custom[0].values else {
                    panic!("heights are f32");
                };
                // Half an element too many must not be rounded away.
                values.push(0.0);
            }),
            ("face attribute `number`", |m| {
                m.face_attributes[0].values = AttributeValues::U8(vec![1]);
            }),
        ];
        for (name, fault) in faults {
            let Error::LengthMismatch {
                what,
                expected,
                found,
            } = broken(fault)
            else {
                panic!("{name}");
            };
            assert_eq!(what, name);
            assert_ne!(expected, found, "{name}");
        }
        let error = broken(|m| m.attributes.custom[0].components = 0);
        let message = "option `components` is 0 in attribute `heights`; it must be at least 1";
        assert_eq!(error.to_string(), message);
    }

    #[test]
    fn values_must_be_finite() {
        let faults: [(&str, Fault); 8] = [
            ("position", |m| m.positions[3].y = f32::NAN),
            ("normal", |m| {
                m.attributes.normals.as_mut().unwrap()[3].x = f32::INFINITY
            }),
            ("tangent", |m| {
                m.attributes.tangents.as_mut().unwrap()[3].w = f32::NAN
            }),
            ("uv set 1", |m| m.attributes.uvs[1][3].y = f32::NAN),
            ("colour set 0", |m| {
                m.attributes.colors[0][3].w = f32::NEG_INFINITY
            }),
            ("skin set 0", |m| {
                m.attributes.skins[0][3].weights[2] = f32::NAN
            }),
            ("morph target 0 position", |m| {
                m.attributes.morphs[0].positions.as_mut().unwrap()[3].z = f32::NAN;
            }),
            ("morph target 0 tangent", |m| {
                m.attributes.morphs[0].tangents.as_mut().unwrap()[3].z = f32::NAN;
            }),
        ];
        for (name, fault) in faults {
            let expected = Error::NotFinite {
                what: name.into(),
                index: 3,
            };
            assert_eq!(broken(fault), expected);
        }
    }

    #[test]
    fn ranges_must_tile() {
        let faults: [fn(&mut Vec<MaterialRange>); 5] = [
            |r| r[0].first = 1,
            |r| r[1].first += 1,
            |r| r[1].count += 1,
            |r| r[1].count -= 1,
            |r| (r[1].first, r[1].count) = (u32::MAX, u32::MAX),
        ];
        for fault in faults {
            let error = broken(|m| fault(&mut m.ranges));
            assert!(matches!(error, Error::BadRange { .. }), "{error}");
        }
    }
}
