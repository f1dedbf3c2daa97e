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
