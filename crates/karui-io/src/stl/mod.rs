//! Stereolithography STL, text and binary.
//!
//! STL repeats every corner; vertices at one position are joined on reading
//! (-0 counting as 0). Normals are not kept: they follow from the corners, and
//! many files hold wrong ones. The two attribute bytes of binary facets are
//! kept as the face attribute `stl_attribute` unless all are 0.

mod ascii;
pub(crate) mod binary;
mod write;

pub(crate) use write::write;

use crate::{
    error::{Error, ErrorKind, Place, Result},
    format::is_binary_stl,
    source::Source,
};
use karui::{
    Scene, TriMesh,
    geom::Vec3,
    mesh::{Attribute, AttributeValues, PositionIds},
};

/// Name of the face attribute for the bytes after each binary facet.
pub(crate) const ATTRIBUTE: &str = "stl_attribute";

/// Bytes at the head of a file that tell text from binary.
const HEAD: usize = 1024;

/// Corners of all facets, three each.
#[derive(Default)]
struct Soup {
    name: Option<String>,
    corners: Vec<Vec3>,
    attributes: Vec<u16>,
}

pub(crate) fn read(source: &mut Source<'_>) -> Result<Scene> {
    let bytes = source.bytes;
    if bytes.is_empty() {
        let kind = ErrorKind::truncated("an STL model", "an empty file");
        return Err(Error::new(Place::File, kind));
    }
    let soup = if !is_binary_stl(bytes) && looks_like_text(bytes) {
        ascii::read(bytes, &mut source.warnings)?
    } else {
        binary::read(bytes, &mut source.warnings)?
    };
    if soup.corners.is_empty() {
        source.warnings.push("the file holds no triangles");
    }
    weld(soup)
}

pub(crate) fn looks_like_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let starts = |word: &[u8]| {
        let start = head.trim_ascii_start();
        start.len() >= word.len() && start[..word.len()].eq_ignore_ascii_case(word)
    };
    (starts(b"solid") || starts(b"facet")) && !head.contains(&0)
}

fn weld(soup: Soup) -> Result<Scene> {
    let limit = u32::MAX as usize;
    if soup.corners.len() > limit {
        let what = "vertices";
        let (found, limit) = (soup.corners.len() as u64, limit as u64);
        let kind = ErrorKind::TooLarge { what, found, limit };
        return Err(Error::new(Place::File, kind));
    }
    let ids = PositionIds::of(&soup.corners);
    let mut positions = Vec::with_capacity(ids.count);
    for (&id, &corner) in ids.of_vertex.iter().zip(&soup.corners) {
        if id as usize == positions.len() {
            positions.push(corner + Vec3::ZERO);
        }
    }
    let triangles = ids.of_vertex.as_chunks::<3>().0.to_vec();
    let mut mesh = TriMesh::new(positions, triangles);
    if soup.attributes.iter().any(|&a| a != 0) {
        mesh.face_attributes.push(Attribute {
            name: ATTRIBUTE.into(),
            components: 1,
            values: AttributeValues::U16(soup.attributes),
        });
    }
    let mut scene = Scene::from_mesh(mesh);
    scene.meshes[0].name = soup.name;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Format, read_bytes};

    fn read_text(text: &str) -> Result<crate::Loaded> {
        read_bytes(Format::Stl, text.as_bytes(), "t.stl")
    }

    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                         vertex 0 1 -0\nendloop\nendfacet\n";

    #[test]
    fn text_is_welded_and_named() {
        let text = format!("solid my part\n{FACET}{FACET}endsolid my part\n");
        let loaded = read_text(&text).unwrap();
        let mesh = &loaded.scene.meshes[0];
        assert_eq!(mesh.name.as_deref(), Some("my part"));
        assert_eq!(mesh.mesh.triangles, [[0, 1, 2], [0, 1, 2]]);
        assert_eq!(mesh.mesh.positions.len(), 3);
        assert!(mesh.mesh.positions[2].z.is_sign_positive());
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    }

    #[test]
    fn facet_of_four_is_two_triangles() {
        let text = format!("solid\n{FACET}endsolid").replace("endloop", "vertex 0 0.5 0\nendloop");
        let loaded = read_text(&text).unwrap();
        assert_eq!(loaded.scene.triangle_count(), 2);
        assert_eq!(loaded.warnings.len(), 1);
    }

    #[test]
    fn errors_name_the_line() {
        let text = format!("solid\n{FACET}{FACET}").replacen("vertex 1 0 0\n", "", 1);
        assert_eq!(
            read_text(&text).unwrap_err().to_string(),
            "t.stl: line 6: expected 3 vertices in a facet, found 2"
        );
        let text = format!("solid\n{FACET}").replace("1 0 0", "1 x 0");
        assert_eq!(
            read_text(&text).unwrap_err().to_string(),
            "t.stl: line 5: expected a number (vertex coordinate), found `x`"
        );
    }
}
