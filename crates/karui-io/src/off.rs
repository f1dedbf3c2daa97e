//! Object File Format (Geomview), with colours, normals and texture
//! coordinates per vertex and colours per face.

/// The keyword a file starts with, e.g. `STCNOFF`, after comments.
pub(crate) fn keyword(head: &[u8]) -> Option<&str> {
    let line = head
        .split(|&b| b == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))?;
    let word = line.split(u8::is_ascii_whitespace).next()?;
    let word = std::str::from_utf8(word).ok()?;
    let prefix = word.strip_suffix("OFF")?;
    ["ST", "C", "N", "4", "n"]
        .iter()
        .fold(prefix, |rest, mark| rest.strip_prefix(mark).unwrap_or(rest))
        .is_empty()
        .then_some(word)
}
