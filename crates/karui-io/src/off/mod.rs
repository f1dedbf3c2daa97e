//! Object File Format (Geomview), with colours, normals and texture
//! coordinates per vertex and colours per face.
//!
//! Face colours become the face attribute [`FACE_COLOR`] of four components,
//! bytes if the file gives whole numbers, else `f32`.

mod read;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;

/// What the first word of the file promises for every vertex.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Header {
    uv: bool,
    color: bool,
    normal: bool,
    four: bool,
    n_dimensional: bool,
}

/// The keyword a file starts with, e.g. `STCNOFF`, after comments.
pub(crate) fn keyword(head: &[u8]) -> Option<Header> {
    let line = head
        .split(|&b| b == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))?;
    header(line.split(u8::is_ascii_whitespace).next()?)
}

fn header(word: &[u8]) -> Option<Header> {
    let word = std::str::from_utf8(word).ok()?;
    let mut marks = word.strip_suffix("OFF")?;
    let mut take = |mark: &str| {
        let rest = marks.strip_prefix(mark);
        marks = rest.unwrap_or(marks);
        rest.is_some()
    };
    let header = Header {
        uv: take("ST"),
        color: take("C"),
        normal: take("N"),
        four: take("4"),
        n_dimensional: take("n"),
    };
    marks.is_empty().then_some(header)
}

#[cfg(test)]
mod tests {
    use super::*;
    use karui::mesh::AttributeValues;

    fn load(text: &str) -> (karui::TriMesh, Vec<String>) {
        let loaded = crate::read_bytes(crate::Format::Off, text.as_bytes(), "t.off").unwrap();
        let warnings = loaded.warnings;
        (loaded.scene.into_single_mesh().unwrap(), warnings)
    }

    const CORNERS: &str = "0 0 0\n1 0 0 # a comment\n\n1 1 0\n0 1 0\n";

    #[test]
    fn colours_of_some_faces() {
        let faces = "4 0 1 2 3\n3 0 1 2 255 51 0\n3 0 1 2 1 2 3 4\n3 0 1 2 7\n";
        let (mesh, warnings) = load(&format!("OFF\n4 4 0\n{CORNERS}{faces}"));
        assert_eq!(mesh.triangles.len(), 5);
        let white = [255; 4];
        let colors = [white, white, [255, 51, 0, 255], [1, 2, 3, 4], white];
        let values = AttributeValues::U8(colors.as_flattened().to_vec());
        assert_eq!(mesh.face_attributes[0].values, values);
        assert_eq!(
            warnings,
            ["colours by number in a palette were passed over"]
        );
    }

    #[test]
    fn fractions_anywhere_mean_fractions_everywhere() {
        let vertices = "0 0 0 1 0 0\n1 0 0 0.5 0 0 1\n1 1 0 0 0 1\n";
        let (mesh, _) = load(&format!("COFF 3 1 0\n{vertices}3 0 1 2"));
        let colors = &mesh.attributes.colors[0];
        assert_eq!(colors[0], karui::geom::Vec4::new(1.0, 0.0, 0.0, 1.0));
        let bytes = vertices.replace("0.5", "51");
        let (mesh, _) = load(&format!("COFF 3 1 0\n{bytes}3 0 1 2"));
        assert_eq!(mesh.attributes.colors[0][1].x, 0.2);
    }

    #[test]
    fn the_keyword_may_be_missing() {
        let (mesh, warnings) = load(&format!("4 1 0\n{CORNERS}3 0 1 2\n3 1 2 3\n"));
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert_eq!(warnings, ["what follows the last face was passed over"]);
    }

    #[test]
    fn keywords() {
        assert_eq!(keyword(b"# c\n\n OFF 3 4"), Some(Header::default()));
        let all = header(b"STCNOFF").unwrap();
        assert!(all.uv && all.color && all.normal && !all.four);
        assert!(header(b"4OFF").unwrap().four);
        for no in [&b"OFFX"[..], b"NCOFF", b"off", b"3", b""] {
            assert_eq!(header(no), None);
        }
    }
}
