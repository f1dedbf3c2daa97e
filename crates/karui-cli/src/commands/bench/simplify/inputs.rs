//! Models, made ready so that every tool gets the same.

use anyhow::{Result, bail};
use karui::TriMesh;
use karui::mesh::{Attributes, WeldOptions, shapes, weld};
use std::path::{Path, PathBuf};

/// What a comparison is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// The surface alone.
    Geometry,
    /// The surface with normals and texture coordinates.
    Attributes,
}

/// A model, ready to be simplified.
pub struct Model {
    /// What tables call it.
    pub name: String,
    /// Where it can be read again.
    pub source: PathBuf,
    /// Vertices at one place joined, without attributes.
    pub geometry: TriMesh,
    /// Equal vertices joined, with normals and the first texture coordinates
    /// as far as the model has them; `None` if it has neither.
    pub attributes: Option<TriMesh>,
}

impl Model {
    /// Reads a file, or makes the land that `land:N` stands for. Names are
    /// relative to `folder`.
    pub fn read(source: &Path, folder: &Path) -> Result<Self> {
        let name = source.strip_prefix(folder).unwrap_or(source);
        let whole = match land_of(source) {
            Some(triangles) => land(triangles),
            None => karui_io::read(source)?.into_single_mesh()?,
        };
        whole.validate()?;
        Ok(Self {
            name: name.display().to_string(),
            source: source.to_owned(),
            attributes: with_attributes(&whole)?,
            geometry: geometry_only(whole)?,
        })
    }

    /// The mesh that a comparison of this kind is about.
    pub fn mesh(&self, kind: Kind) -> Result<&TriMesh> {
        match (kind, &self.attributes) {
            (Kind::Geometry, _) => Ok(&self.geometry),
            (Kind::Attributes, Some(mesh)) => Ok(mesh),
            (Kind::Attributes, None) => bail!("{}: no attributes", self.name),
        }
    }
}

/// The name of [`land`] of about so many triangles.
pub fn land_name(triangles: usize) -> PathBuf {
    format!("land:{triangles}").into()
}

fn land_of(source: &Path) -> Option<usize> {
    source.to_str()?.strip_prefix("land:")?.parse().ok()
}

/// Made-up land twice as wide as deep, of about `triangles` triangles:
/// 16,777,216 make 4097 x 2049 vertices.
fn land(triangles: usize) -> TriMesh {
    let rows = (triangles as f64 / 4.0).sqrt().round() as u32;
    shapes::landscape(2 * rows, rows, 7)
}

fn geometry_only(mesh: TriMesh) -> Result<TriMesh> {
    tidy(TriMesh::new(mesh.positions, mesh.triangles), true)
}

fn with_attributes(mesh: &TriMesh) -> Result<Option<TriMesh>> {
    let attributes = &mesh.attributes;
    if attributes.normals.is_none() && attributes.uvs.is_empty() {
        return Ok(None);
    }
    let mut bare = TriMesh::new(mesh.positions.clone(), mesh.triangles.clone());
    bare.attributes = Attributes {
        normals: attributes.normals.clone(),
        uvs: attributes.uvs.iter().take(1).cloned().collect(),
        ..Attributes::default()
    };
    tidy(bare, false).map(Some)
}

/// Joins vertices, then leaves out triangles without three different corners
/// and vertices without a triangle.
fn tidy(mesh: TriMesh, ignore_attributes: bool) -> Result<TriMesh> {
    let options = WeldOptions {
        ignore_attributes,
        ..WeldOptions::default()
    };
    let mut mesh = weld(&mesh, &options)?.mesh;
    let triangles = mesh.triangles.clone();
    mesh.retain_triangles(|t| {
        let [a, b, c] = triangles[t];
        a != b && b != c && c != a
    });
    mesh.remove_unreferenced_vertices();
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn land_has_about_the_triangles_asked_for() {
        for triangles in [1000, 69_000] {
            let found = land(triangles).triangles.len() as f64 / triangles as f64;
            assert!((found - 1.0).abs() < 0.05, "{triangles} {found}");
        }
    }

    #[test]
    fn seams_are_joined_without_attributes_only() {
        let whole = shapes::textured_sphere(8, 12);
        let with = with_attributes(&whole).unwrap().unwrap();
        assert_eq!(with.attributes.uvs, whole.attributes.uvs);
        let without = geometry_only(whole.clone()).unwrap();
        assert!(without.positions.len() < with.positions.len());
        assert_eq!(without.attributes, Attributes::default());
        assert!(with_attributes(&without).unwrap().is_none());
    }
}
