//! Text STL.

use super::Soup;
use crate::{
    Warnings,
    error::{ErrorKind, Result},
    text::{Tokens, name, quote},
};
use karui::{PolyMesh, geom::Vec3};

/// Reads all solids into one soup.
///
/// Normals are passed over without looking, so missing, wrong and NaN ones do
/// no harm; so do `endsolid` lines that are missing or name another solid. A
/// facet of more than three corners is cut into triangles with a warning, one
/// of fewer is an error.
pub(super) fn read(bytes: &[u8], warnings: &mut Warnings) -> Result<Soup> {
    let mut soup = Soup::default();
    let mut tokens = Tokens::new(bytes);
    let mut in_solid = false;
    while let Some(word) = tokens.next() {
        match keyword(word) {
            Keyword::Solid => {
                let title = tokens.rest_of_line();
                if soup.name.is_none() && !title.is_empty() {
                    soup.name = Some(name(title));
                }
                in_solid = true;
            }
            Keyword::EndSolid => {
                tokens.rest_of_line();
                in_solid = false;
            }
            Keyword::Facet => facet(&mut tokens, &mut soup, warnings)?,
            Keyword::Other => {
                let expected = "`facet` or `endsolid`";
                return Err(tokens.fail(ErrorKind::syntax(expected, quote(word))));
            }
        }
    }
    if in_solid {
        warnings.push("`endsolid` is missing at the end");
    }
    Ok(soup)
}

enum Keyword {
    Solid,
    EndSolid,
    Facet,
    Other,
}

fn keyword(word: &[u8]) -> Keyword {
    match word.to_ascii_lowercase().as_slice() {
        b"solid" => Keyword::Solid,
        b"endsolid" => Keyword::EndSolid,
        b"facet" => Keyword::Facet,
        _ => Keyword::Other,
    }
}

fn facet(tokens: &mut Tokens<'_>, soup: &mut Soup, warnings: &mut Warnings) -> Result<()> {
    while !tokens
        .expect("`outer loop`")?
        .eq_ignore_ascii_case(b"outer")
    {}
    expect(tokens, "loop")?;
    let first = soup.corners.len();
    loop {
        let word = tokens.expect("`vertex` or `endloop`")?;
        if word.eq_ignore_ascii_case(b"endloop") {
            break;
        }
        if !word.eq_ignore_ascii_case(b"vertex") {
            let kind = ErrorKind::syntax("`vertex` or `endloop`", quote(word));
            return Err(tokens.fail(kind));
        }
        let mut number = || tokens.number("vertex coordinate");
        soup.corners
            .push(Vec3::new(number()?, number()?, number()?));
    }
    match soup.corners.len() - first {
        3 => {}
        found @ 0..3 => {
            let kind = ErrorKind::syntax("3 vertices in a facet", found.to_string());
            return Err(tokens.fail(kind));
        }
        found => {
            warnings.push(format!(
                "a facet of {found} vertices was cut into triangles"
            ));
            let polygon = soup.corners.split_off(first);
            soup.corners.extend(cut(polygon));
        }
    }
    expect(tokens, "endfacet")
}

fn expect(tokens: &mut Tokens<'_>, wanted: &str) -> Result<()> {
    let word = tokens.expect(&format!("`{wanted}`"))?;
    if word.eq_ignore_ascii_case(wanted.as_bytes()) {
        return Ok(());
    }
    Err(tokens.fail(ErrorKind::syntax(format!("`{wanted}`"), quote(word))))
}

/// The corners of the triangles of a polygon.
fn cut(polygon: Vec<Vec3>) -> impl Iterator<Item = Vec3> {
    let mut mesh = PolyMesh::default();
    mesh.push_face(&(0..polygon.len() as u32).collect::<Vec<_>>());
    mesh.positions = polygon;
    let mesh = mesh.triangulate();
    let corners = mesh.triangles.into_iter().flatten();
    corners.map(move |v| mesh.positions[v as usize])
}
