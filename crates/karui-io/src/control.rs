//! Reading control meshes.

use crate::{
    Format, ReadOptions,
    error::Result,
    obj,
    read::poly_of,
    source::{Source, inflated, load},
};
use karui::{Scene, TriMesh, subdiv::ControlMesh};
use std::path::Path;

/// A control mesh and what belongs to it.
#[derive(Debug, Clone)]
pub struct LoadedControl {
    /// Faces of any size, positions, tags.
    pub mesh: ControlMesh,
    /// The materials, and an empty mesh for the surface to take its place.
    pub scene: Scene,
    /// What was passed over.
    pub warnings: Vec<String>,
}

/// Reads a model as a control mesh for subdivision. OBJ keeps vertices whole at seams of
/// texture coordinates and knows the tags `t crease`, `t corner`, `t hole`,
/// `t interpolateboundary`, `t facevaryinginterpolateboundary`, `t creasemethod` and
/// `t smoothtriangles`; a fourth number of a vertex is its weight. In other formats vertices at one position are joined if they have
/// texture coordinates or normals.
///
/// # Errors
/// As [`read()`](crate::read()); also for a face of fewer than 3 corners in OBJ, since tags
/// count faces.
pub fn read_control(path: impl AsRef<Path>) -> Result<LoadedControl> {
    let path = path.as_ref();
    let bytes = load(path, &ReadOptions::default())?;
    let format = Format::detect(path, &bytes)?;
    control(format, &mut Source::of_file(path, &bytes))
}

/// [`read_control`] of a model that lies in memory, not compressed.
///
/// # Errors
/// As [`read_control`].
pub fn read_control_bytes(
    format: Format,
    bytes: &[u8],
    name: impl AsRef<Path>,
) -> Result<LoadedControl> {
    control(format, &mut Source::in_memory(name.as_ref(), bytes))
}

/// [`read_control`] of the bytes of a file that need not lie on this machine, as
/// [`read_sent`](crate::read_sent) takes them.
///
/// # Errors
/// As [`read_control`].
pub fn read_control_sent(
    name: impl AsRef<Path>,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<LoadedControl> {
    let name = name.as_ref();
    let bytes = inflated(name, bytes, options)?;
    let format = Format::detect(name, &bytes)?;
    control(format, &mut Source::in_memory(name, &bytes))
}

fn control(format: Format, source: &mut Source<'_>) -> Result<LoadedControl> {
    let name = source.name;
    let (mesh, scene) = parts(format, source).map_err(|e| e.in_file(name))?;
    let warnings = std::mem::take(&mut source.warnings).into_messages();
    Ok(LoadedControl {
        mesh,
        scene,
        warnings,
    })
}

fn parts(format: Format, source: &mut Source<'_>) -> Result<(ControlMesh, Scene)> {
    if format == Format::Obj {
        return Ok(obj::read_control(source)?.into_parts());
    }
    let mesh = ControlMesh::of_poly_mesh(&poly_of(format, source)?);
    Ok((mesh, Scene::from_mesh(TriMesh::default())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fourth_number_is_a_weight() {
        let obj = b"v 0 0 0\nv 1 0 0 2.5\nv 1 1 0 1\nv 0 1 0\nf 1 2 3 4\n";
        let control = read_control_bytes(Format::Obj, obj, "a.obj").unwrap().mesh;
        assert_eq!(control.weights, Some(vec![1.0, 2.5, 1.0, 1.0]));
        let obj = b"v 0 0 0 1\nv 1 0 0 1\nv 1 1 0 1\nf 1 2 3\n";
        let control = read_control_bytes(Format::Obj, obj, "a.obj").unwrap().mesh;
        assert_eq!(control.weights, None);
    }
}
