//! Reading OBJ.

use super::{
    Control, Library, Model,
    corners::{Corners, NONE},
    mtl_read,
    tags::Tags,
};
use crate::{
    error::{Error, ErrorKind, Place, Result},
    source::Source,
    text::{Lines, Words, float, integer, name, quote, turned_v},
};
use karui::geom::{Vec2, Vec3, Vec4};
use std::{borrow::Cow, collections::HashMap};

/// Reads the polygons with texture coordinates, normals, colours and
/// materials. Libraries and textures that cannot be found are replaced with a
/// warning.
pub(crate) fn read(source: &mut Source<'_>) -> Result<Model> {
    let mut state = State::default();
    state.lines(source.bytes)?;
    state.finish(source)
}

/// Reads the polygons as a control mesh, with the tags that say what is sharp.
pub(crate) fn read_control(source: &mut Source<'_>) -> Result<Control> {
    let mut state = State {
        tags: Some(Tags::default()),
        ..State::default()
    };
    state.lines(source.bytes)?;
    state.finish_control(source)
}

impl State {
    /// Reads the statements one after the other.
    fn lines(&mut self, bytes: &[u8]) -> Result<()> {
        if bytes.is_empty() {
            let kind = ErrorKind::truncated("an OBJ model", "an empty file");
            return Err(Error::new(Place::File, kind));
        }
        let mut lines = Lines::new(bytes);
        while let Some(line) = lines.next() {
            let first = lines.line;
            let line = joined(line, &mut lines);
            let result = self.line(&line, first);
            result.map_err(|kind| Error::new(Place::Line(first), kind))?;
        }
        Ok(())
    }
}

/// A line with those it goes on in after a final `\`.
pub(crate) fn joined<'a>(line: &'a [u8], lines: &mut Lines<'a>) -> Cow<'a, [u8]> {
    let Some(start) = line.strip_suffix(b"\\") else {
        return Cow::Borrowed(line);
    };
    let mut whole = start.to_vec();
    for next in lines.by_ref() {
        whole.push(b' ');
        match next.strip_suffix(b"\\") {
            Some(part) => whole.extend_from_slice(part),
            None => {
                whole.extend_from_slice(next);
                break;
            }
        }
    }
    Cow::Owned(whole)
}

/// Material libraries read; real files name one.
const MOST_LIBRARIES: usize = 1000;

/// What has been read so far.
#[derive(Default)]
struct State {
    positions: Vec<Vec3>,
    /// As long as `positions` once a vertex had a colour; NaN where it has none.
    colors: Vec<Vec4>,
    /// Fewer than `positions` if the rest are 1.
    weights: Vec<f32>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    corners: Corners,
    /// Indices that named an element not yet read: the largest one of each
    /// kind, with its line.
    ahead: [Option<(i64, u64)>; 3],
    name: Option<String>,
    libraries: Vec<String>,
    /// Names after `usemtl`, each once.
    materials: Vec<String>,
    material_ids: HashMap<Vec<u8>, u32>,
    material: Option<u32>,
    warnings: Vec<&'static str>,
    /// The first statement that was not understood, with its line.
    unknown: Option<(String, u64)>,
    /// Statements `t`, if they are wanted.
    tags: Option<Tags>,
}

/// Names of the kinds of `State::ahead`.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

impl State {
    fn line(&mut self, line: &[u8], number: u64) -> Result<(), ErrorKind> {
        let mut words = Words::new(line);
        match words.next() {
            Some(b"v") => self.position(words),
            Some(b"vt") => self.uv(words),
            Some(b"vn") => self.normal(words),
            Some(b"f" | b"fo") => self.face(words, number),
            Some(b"usemtl") => self.use_material(words.rest()),
            Some(b"mtllib") => {
                self.add_library(name(words.rest()));
                Ok(())
            }
            Some(b"o") => {
                let title = words.rest();
                if self.name.is_none() && !title.is_empty() {
                    self.name = Some(name(title));
                }
                Ok(())
            }
            Some(b"l" | b"p") => {
                self.warn("lines and points were passed over");
                Ok(())
            }
            Some(b"curv" | b"curv2" | b"surf" | b"cstype") => {
                self.warn("free-form curves and surfaces were passed over");
                Ok(())
            }
            Some(b"t") if self.tags.is_some() => {
                self.tags.as_mut().map_or(Ok(()), |tags| tags.read(words))
            }
            // Groups, smoothing and tags of subdivision carry no geometry.
            None | Some(b"g" | b"s" | b"t" | b"mg" | b"lod" | b"vp") => Ok(()),
            Some(word) if word.starts_with(b"#") => Ok(()),
            Some(word) => {
                if self.unknown.is_none() {
                    self.unknown = Some((quote(word), number));
                }
                Ok(())
            }
        }
    }

    fn warn(&mut self, message: &'static str) {
        if !self.warnings.contains(&message) {
            self.warnings.push(message);
        }
    }

    fn position(&mut self, words: Words<'_>) -> Result<(), ErrorKind> {
        const WHAT: &str = "vertex coordinate";
        let mut values = [f32::NAN; 7];
        let found = numbers(words, &mut values, WHAT)?;
        at_least(3, found)?;
        let [x, y, z, a, b, c, d] = values;
        self.positions.push(Vec3::new(x, y, z));
        let color = match found {
            6 => Vec4::new(a, b, c, 1.0),
            7 => Vec4::new(a, b, c, d),
            _ => Vec4::NAN,
        };
        // A fourth number alone is the weight in a rational surface.
        if found == 4 && a != 1.0 && self.tags.is_some() {
            self.weights.resize(self.positions.len() - 1, 1.0);
            self.weights.push(a);
        }
        if found >= 6 || !self.colors.is_empty() {
            self.colors.resize(self.positions.len() - 1, Vec4::NAN);
            self.colors.push(color);
        }
        Ok(())
    }

    fn uv(&mut self, mut words: Words<'_>) -> Result<(), ErrorKind> {
        const WHAT: &str = "texture coordinate";
        let u = words.next().ok_or_else(|| missing(1, 0))?;
        let v = words.next().map_or(Ok(1.0), turned_v)?;
        self.uvs.push(Vec2::new(float(u, WHAT)?, v));
        Ok(())
    }

    fn normal(&mut self, words: Words<'_>) -> Result<(), ErrorKind> {
        let mut values = [0.0; 3];
        at_least(3, numbers(words, &mut values, "normal")?)?;
        self.normals.push(values.into());
        Ok(())
    }

    fn face(&mut self, words: Words<'_>, line: u64) -> Result<(), ErrorKind> {
        let before = self.corners.len();
        for word in words {
            // Comments may follow on the same line.
            if word.starts_with(b"#") {
                break;
            }
            let corner = self.corner(word, line)?;
            self.corners.push(corner);
        }
        let found = self.corners.len() - before;
        if found < 3 && self.tags.is_some() {
            // Tags count faces, so that none may be passed over.
            return Err(ErrorKind::syntax(
                "3 corners of a face or more",
                found.to_string(),
            ));
        }
        if found < 3 {
            self.corners.truncate(before);
            self.warn("faces of fewer than 3 corners were passed over");
            return Ok(());
        }
        crate::read::check_corners(self.corners.len())?;
        self.corners.end_face(self.material);
        Ok(())
    }

    /// Indices of `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[inline]
    fn corner(&mut self, word: &[u8], line: u64) -> Result<[u32; 3], ErrorKind> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [NONE; 3];
        let mut parts = word.split(|&b| b == b'/');
        for kind in 0..3 {
            let Some(part) = parts.next() else {
                break;
            };
            if part.is_empty() && kind > 0 {
                continue;
            }
            let Some(index) = integer(part) else {
                return Err(ErrorKind::syntax("a vertex index", quote(word)));
            };
            corner[kind] = self.resolve(index, kind, counts[kind], line)?;
        }
        if parts.next().is_some() {
            return Err(ErrorKind::syntax("at most v/vt/vn", quote(word)));
        }
        Ok(corner)
    }

    /// From 1 upwards counted from the start, from -1 downwards from the end.
    #[inline]
    fn resolve(
        &mut self,
        index: i64,
        kind: usize,
        count: usize,
        line: u64,
    ) -> Result<u32, ErrorKind> {
        let absolute = if index < 0 {
            count as i64 + index
        } else {
            index - 1
        };
        match u32::try_from(absolute) {
            Ok(found) if found < NONE => {
                if found as usize >= count && self.ahead[kind].is_none_or(|(i, _)| i < index) {
                    self.ahead[kind] = Some((index, line));
                }
                Ok(found)
            }
            _ => Err(out_of_range(kind, index, count)),
        }
    }

    fn add_library(&mut self, uri: String) {
        if self.libraries.contains(&uri) {
            return;
        }
        if self.libraries.len() < MOST_LIBRARIES {
            self.libraries.push(uri);
        } else {
            self.warn("material libraries beyond the first thousand were passed over");
        }
    }

    fn use_material(&mut self, title: &[u8]) -> Result<(), ErrorKind> {
        if let Some(&id) = self.material_ids.get(title) {
            self.material = Some(id);
            return Ok(());
        }
        let id = self.materials.len() as u32;
        self.materials.push(name(title));
        self.material_ids.insert(title.to_vec(), id);
        self.material = Some(id);
        Ok(())
    }

    /// Unknown statements are passed over, unless nothing else is there: then
    /// this is no OBJ file.
    fn check_unknown(&mut self, source: &mut Source<'_>) -> Result<()> {
        let Some((word, line)) = self.unknown.take() else {
            return Ok(());
        };
        if self.positions.is_empty() {
            let kind = ErrorKind::syntax("an OBJ statement", word);
            return Err(Error::new(Place::Line(line), kind));
        }
        let message = format!("statements such as {word} (line {line}) were passed over");
        source.warnings.push(message);
        Ok(())
    }

    fn finish(mut self, source: &mut Source<'_>) -> Result<Model> {
        let (library, materials) = self.check(source)?;
        let colors = scaled(std::mem::take(&mut self.colors), self.positions.len());
        let mut mesh = self
            .corners
            .into_mesh(self.positions, self.uvs, self.normals, colors);
        for material in mesh.face_materials.iter_mut().flatten() {
            *material = materials[*material as usize];
        }
        Ok(Model {
            mesh,
            name: self.name,
            library,
        })
    }

    fn finish_control(mut self, source: &mut Source<'_>) -> Result<Control> {
        let (library, materials) = self.check(source)?;
        let colors = scaled(std::mem::take(&mut self.colors), self.positions.len());
        let mut mesh = self
            .corners
            .into_control(self.positions, self.weights, self.uvs, colors);
        for material in mesh.face_materials.iter_mut().flatten() {
            *material = materials[*material as usize];
        }
        let tags = self.tags.take().unwrap_or_default();
        if let Some(name) = tags.unknown {
            let message = format!("tags such as {name} were passed over");
            source.warnings.push(message);
        }
        (mesh.cage.creases, mesh.cage.corners) = (tags.creases, tags.corners);
        (mesh.cage.holes, mesh.rules) = (tags.holes, tags.rules);
        Ok(Control {
            mesh,
            name: self.name,
            library,
        })
    }

    /// Checks that what was named is there, and reads the materials.
    fn check(&mut self, source: &mut Source<'_>) -> Result<(Library, Vec<u32>)> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        for (kind, &ahead) in self.ahead.iter().enumerate() {
            if let Some((index, line)) = ahead.filter(|&(i, _)| i > counts[kind] as i64) {
                let kind = out_of_range(kind, index, counts[kind]);
                return Err(Error::new(Place::Line(line), kind));
            }
        }
        self.check_unknown(source)?;
        let warnings = std::mem::take(&mut self.warnings);
        warnings.into_iter().for_each(|w| source.warnings.push(w));
        if self.corners.len() == 0 {
            source.warnings.push("the file holds no faces");
        }
        let mut library = Library::default();
        for uri in &self.libraries {
            mtl_read::read_libraries(uri, source, &mut library)?;
        }
        let materials = mtl_read::resolve(&self.materials, source, &mut library);
        Ok((library, materials))
    }
}

/// Numbers up to the end of the line; how many were there. More than asked
/// for are not looked at.
#[inline]
pub(crate) fn numbers(
    words: Words<'_>,
    values: &mut [f32],
    what: &'static str,
) -> Result<usize, ErrorKind> {
    let mut found = 0;
    for (value, word) in values.iter_mut().zip(words) {
        if word.starts_with(b"#") {
            break;
        }
        *value = float(word, what)?;
        found += 1;
    }
    Ok(found)
}

pub(crate) fn at_least(wanted: usize, found: usize) -> Result<(), ErrorKind> {
    if found < wanted {
        return Err(missing(wanted, found));
    }
    Ok(())
}

fn missing(wanted: usize, found: usize) -> ErrorKind {
    let s = if wanted == 1 { "" } else { "s" };
    ErrorKind::syntax(format!("{wanted} number{s}"), found.to_string())
}

pub(crate) fn out_of_range(kind: usize, index: i64, count: usize) -> ErrorKind {
    let what = KINDS[kind];
    ErrorKind::IndexOutOfRange { what, index, count }
}

/// Colours as 0..=1: some files write 0..=255. White where there is none.
fn scaled(mut colors: Vec<Vec4>, vertices: usize) -> Option<Vec<Vec4>> {
    if colors.is_empty() {
        return None;
    }
    colors.resize(vertices, Vec4::NAN);
    let most = colors.iter().map(|c| c.truncate().max_element());
    let scale = scale(most.fold(0.0, f32::max));
    for color in &mut colors {
        if color.is_nan() {
            *color = Vec4::ONE;
        } else {
            *color = (color.truncate() / scale).extend(color.w);
        }
    }
    Some(colors)
}

/// What colours are divided by if the largest number in one is `brightest`.
pub(crate) fn scale(brightest: f32) -> f32 {
    if brightest > 1.0 { 255.0 } else { 1.0 }
}
