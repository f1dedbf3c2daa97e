//! Colours of vertices and faces in text formats and PLY.
//!
//! The files do not say whether their colours are sRGB or linear. Custom says
//! sRGB for bytes, but tools disagree, and converting would not survive a
//! round trip exactly; so a byte c is read as c / 255, other numbers as they
//! are, and both are written back the same way.

use crate::number::byte_of;
use karui::{
    geom::Vec4,
    mesh::{Attribute, AttributeValues},
};

/// Name of the face attribute that holds colours: 3 or 4 components, bytes of
/// 0..=255 or numbers of 0..=1.
pub(crate) const FACE_COLOR: &str = "color";

/// How colours are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    /// As bytes: every component is exactly a 255th.
    pub bytes: bool,
    /// With alpha: some are not 1.
    pub alpha: bool,
}

impl Layout {
    /// The shortest layout that loses nothing.
    pub fn of(colors: &[Vec4]) -> Self {
        let all_bytes = |c: &Vec4| c.to_array().into_iter().all(|c| byte_of(c).is_some());
        Self {
            bytes: colors.iter().all(all_bytes),
            alpha: colors.iter().any(|c| c.w != 1.0),
        }
    }

    pub fn components(self) -> usize {
        if self.alpha { 4 } else { 3 }
    }
}

/// The colours of faces, if the mesh has some.
pub(crate) fn of_faces(attributes: &[Attribute]) -> Option<&Attribute> {
    attributes.iter().find(|a| is_face_color(a))
}

/// Whether the attribute holds face colours.
pub(crate) fn is_face_color(a: &Attribute) -> bool {
    let typed = matches!(a.values, AttributeValues::U8(_) | AttributeValues::F32(_));
    a.name == FACE_COLOR && typed && matches!(a.components, 3 | 4)
}
