//! Reading OFF.

use super::Header;
use crate::{
    Warnings,
    color::FACE_COLOR,
    error::{ErrorKind, Result},
    source::Source,
    text::{Tokens, Words, float, integer, quote, turned_v},
};
use karui::{
    PolyMesh,
    geom::{Vec2, Vec3, Vec4},
    mesh::{Attribute, AttributeValues},
};

/// Reads the polygons. Extra numbers after a vertex are passed over with a
/// warning; the number of edges is not looked at.
pub(crate) fn read(source: &mut Source<'_>) -> Result<PolyMesh> {
    let mut tokens = Tokens::new(source.bytes);
    let (header, vertices) = start(&mut tokens)?;
    let faces = tokens.whole("the number of faces")?;
    tokens.rest_of_line();
    let mut mesh = PolyMesh::default();
    read_vertices(&mut tokens, header, vertices, &mut mesh, source)?;
    read_faces(&mut tokens, faces, &mut mesh, &mut source.warnings)?;
    end(&mut tokens, &mesh, &mut source.warnings)?;
    Ok(mesh)
}

/// The keyword, which may be missing, and the number of vertices.
fn start(tokens: &mut Tokens<'_>) -> Result<(Header, usize)> {
    let first = tokens.expect("`OFF`")?;
    if let Some(vertices) = integer(first).and_then(|n| usize::try_from(n).ok()) {
        return Ok((Header::default(), vertices));
    }
    let Some(header) = super::header(first) else {
        return Err(tokens.fail(ErrorKind::syntax("`OFF`", quote(first))));
    };
    if header.four || header.n_dimensional {
        return Err(tokens.fail(ErrorKind::unsupported("OFF of other than 3 dimensions")));
    }
    if let Some(word) = tokens.same_line() {
        if word.eq_ignore_ascii_case(b"binary") {
            return Err(tokens.fail(ErrorKind::unsupported("binary OFF")));
        }
        return match integer(word).and_then(|n| usize::try_from(n).ok()) {
            Some(vertices) => Ok((header, vertices)),
            None => Err(tokens.fail(ErrorKind::syntax("the number of vertices", quote(word)))),
        };
    }
    let vertices = tokens.whole("the number of vertices")?;
    Ok((header, vertices))
}

fn read_vertices(
    tokens: &mut Tokens<'_>,
    header: Header,
    vertices: usize,
    mesh: &mut PolyMesh,
    source: &mut Source<'_>,
) -> Result<()> {
    // A coordinate takes a digit and a separator.
    enough(tokens, vertices, 6, "vertices")?;
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    let mut colors = Colors::default();
    for _ in 0..vertices {
        mesh.positions.push(vector(tokens, "vertex coordinate")?);
        if header.normal {
            normals.push(vector(tokens, "normal")?);
        }
        let mut rest = Words::new(tokens.rest_of_line());
        let words = rest.clone().count();
        let for_uv = if header.uv { 2 } else { 0 };
        if header.color {
            let take = words.saturating_sub(for_uv).min(4);
            let color: Vec<_> = rest.by_ref().take(take).collect();
            colors.push(&color).map_err(|kind| tokens.fail(kind))?;
        }
        if header.uv {
            let uv = texture_coordinate(&mut rest).map_err(|kind| tokens.fail(kind))?;
            uvs.push(uv);
        }
        if rest.next().is_some() {
            let message = "numbers after a vertex that the keyword does not announce";
            source.warnings.push(format!("{message} were passed over"));
        }
    }
    mesh.attributes.normals = header.normal.then_some(normals);
    if header.uv {
        mesh.attributes.uvs.push(uvs);
    }
    if header.color {
        mesh.attributes.colors.push(colors.into_vertex_colors());
    }
    Ok(())
}

/// What follows the last face is passed over, unless there was nothing before
/// it: then the counts are wrong.
fn end(tokens: &mut Tokens<'_>, mesh: &PolyMesh, warnings: &mut Warnings) -> Result<()> {
    let Some(word) = tokens.next() else {
        return Ok(());
    };
    if mesh.positions.is_empty() {
        let expected = "the number of vertices and faces that follow";
        return Err(tokens.fail(ErrorKind::syntax(
            expected,
            format!("0, then {}", quote(word)),
        )));
    }
    warnings.push("what follows the last face was passed over");
    Ok(())
}

fn vector(tokens: &mut Tokens<'_>, what: &'static str) -> Result<Vec3> {
    let mut number = || tokens.number(what);
    Ok(Vec3::new(number()?, number()?, number()?))
}

fn texture_coordinate(words: &mut Words<'_>) -> Result<Vec2, ErrorKind> {
    const WHAT: &str = "texture coordinate";
    let mut number = || {
        let missing = || ErrorKind::syntax("2 texture coordinates", "fewer");
        words.next().ok_or_else(missing)
    };
    let (s, t) = (number()?, number()?);
    Ok(Vec2::new(float(s, WHAT)?, turned_v(t)?))
}

fn read_faces(
    tokens: &mut Tokens<'_>,
    faces: usize,
    mesh: &mut PolyMesh,
    warnings: &mut Warnings,
) -> Result<()> {
    enough(tokens, faces, 2, "faces")?;
    let mut colors = Colors::default();
    let mut corners = Vec::new();
    for _ in 0..faces {
        read_corners(tokens, mesh.positions.len(), &mut corners)?;
        let words: Vec<_> = Words::new(tokens.rest_of_line()).collect();
        if corners.len() < 3 {
            warnings.push("faces of fewer than 3 corners were passed over");
            continue;
        }
        crate::read::push_face(mesh, &corners).map_err(|kind| tokens.fail(kind))?;
        match words.len() {
            0 => {}
            1 => warnings.push("colours by number in a palette were passed over"),
            _ => {
                colors.fill(mesh.face_count() - 1);
                colors.push(&words).map_err(|kind| tokens.fail(kind))?;
            }
        }
    }
    if !colors.values.is_empty() {
        colors.fill(mesh.face_count());
        mesh.face_attributes.push(colors.into_face_attribute());
    }
    Ok(())
}

fn read_corners(tokens: &mut Tokens<'_>, vertices: usize, corners: &mut Vec<u32>) -> Result<()> {
    corners.clear();
    let count = tokens.whole("the number of corners of a face")?;
    for _ in 0..count {
        let word = tokens.expect("a vertex index")?;
        let Some(index) = integer(word) else {
            return Err(tokens.fail(ErrorKind::syntax("a vertex index", quote(word))));
        };
        match u32::try_from(index) {
            Ok(v) if (v as usize) < vertices => corners.push(v),
            _ => {
                let kind = ErrorKind::IndexOutOfRange {
                    what: "vertex",
                    index,
                    count: vertices,
                };
                return Err(tokens.fail(kind));
            }
        }
    }
    Ok(())
}

/// Whether what is left of the file can hold `count` elements at all.
fn enough(tokens: &Tokens<'_>, count: usize, least: usize, what: &'static str) -> Result<()> {
    let left = tokens.bytes_left();
    if count.saturating_mul(least) > left.saturating_add(least) {
        let found = format!("{left} bytes");
        return Err(tokens.fail(ErrorKind::truncated(format!("{count} {what}"), found)));
    }
    Ok(())
}

/// Colours whose scale, 0..=1 or 0..=255, is known at the end only: they are
/// bytes if the whole file has no fraction among them.
#[derive(Default)]
struct Colors {
    values: Vec<Vec4>,
    fractions: bool,
}

impl Colors {
    fn push(&mut self, words: &[&[u8]]) -> Result<(), ErrorKind> {
        if words.len() < 3 {
            let found = words.len().to_string();
            return Err(ErrorKind::syntax("a colour of 3 or 4 numbers", found));
        }
        let mut color = [f32::NAN; 4];
        for (component, word) in color.iter_mut().zip(words) {
            self.fractions |= integer(word).is_none();
            *component = float(word, "colour")?;
        }
        self.values.push(color.into());
        Ok(())
    }

    /// NaN, which becomes white on either scale, up to element `len`.
    fn fill(&mut self, len: usize) {
        self.values.resize(len, Vec4::NAN);
    }

    fn is_bytes(&self) -> bool {
        let fits = |c: f32| c.is_nan() || (0.0..=255.0).contains(&c);
        !self.fractions
            && self
                .values
                .iter()
                .all(|v| v.to_array().into_iter().all(fits))
    }

    fn into_vertex_colors(self) -> Vec<Vec4> {
        let scale = if self.is_bytes() { 255.0 } else { 1.0 };
        let component = |c: f32| if c.is_nan() { 1.0 } else { c / scale };
        let color = |v: &Vec4| Vec4::from_array(v.to_array().map(component));
        self.values.iter().map(color).collect()
    }

    fn into_face_attribute(self) -> Attribute {
        let values = if self.is_bytes() {
            let component = |c: f32| if c.is_nan() { 255 } else { c as u8 };
            let bytes = self.values.iter().flat_map(|v| v.to_array().map(component));
            AttributeValues::U8(bytes.collect())
        } else {
            let component = |c: f32| if c.is_nan() { 1.0 } else { c };
            let floats = self.values.iter().flat_map(|v| v.to_array().map(component));
            AttributeValues::F32(floats.collect())
        };
        Attribute {
            name: FACE_COLOR.into(),
            components: 4,
            values,
        }
    }
}
