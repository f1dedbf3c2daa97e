//! Images that were made here rather than read.

use super::{decode_image, encode_png};
use crate::error::{Error, ErrorKind, Place, Result};
use karui::{
    Scene,
    mesh::{Image, ImageData},
    render::Picture,
};
use rayon::prelude::*;
use std::{borrow::Cow, sync::Arc};

/// The picture of an image: decoded, or the pixels it was made of. `None` for one
/// that was not found when its model was read.
///
/// # Errors
/// Those of [`decode_image`]; [`ErrorKind::Geometry`] for pixels that do not fill
/// their rows.
pub fn picture_of(image: &Image) -> Result<Option<Picture>> {
    match &image.data {
        ImageData::Bytes { bytes, .. } => decode_image(bytes).map(Some),
        ImageData::Missing { .. } => Ok(None),
        ImageData::Pixels { width, pixels } => {
            let height = pixels.len() as u64 / u64::from(*width).max(1);
            let picture = Picture::new(*width, height as u32, pixels.to_vec());
            let fail = |error: karui::Error| Error::new(Place::File, ErrorKind::from(error));
            picture.map(Some).map_err(fail)
        }
    }
}

/// The pictures of a scene's images by their index, and of those that cannot be decoded a
/// line each that says why. Of files that were not found the reader has told.
#[must_use]
pub fn pictures_of(scene: &Scene) -> (Vec<Option<Picture>>, Vec<String>) {
    let decoded: Vec<_> = scene.images.par_iter().map(picture_of).collect();
    let mut warnings = Vec::new();
    let each = (0..).zip(&scene.images).zip(decoded);
    let pictures = each.map(|((i, image), picture)| {
        let warn = |error| {
            let name = name_of(image, i);
            warnings.push(format!("{name}: {error}; drawn without it"));
        };
        picture.map_err(warn).ok().flatten()
    });
    (pictures.collect(), warnings)
}

fn name_of(image: &Image, index: usize) -> String {
    let uri = match &image.data {
        ImageData::Bytes { uri, .. } => uri.as_deref(),
        ImageData::Missing { uri } => Some(&**uri),
        ImageData::Pixels { .. } => None,
    };
    let name = uri.or(image.name.as_deref());
    name.map_or_else(|| format!("image {index}"), str::to_owned)
}

/// The scene with all its images encoded: pixels become PNGs.
pub(crate) fn encoded(scene: &Scene) -> Result<Cow<'_, Scene>> {
    let is_raw = |image: &Image| matches!(image.data, ImageData::Pixels { .. });
    if !scene.images.iter().any(is_raw) {
        return Ok(Cow::Borrowed(scene));
    }
    let mut scene = scene.clone();
    for image in scene.images.iter_mut().filter(|image| is_raw(image)) {
        if let Some(picture) = picture_of(image)? {
            let bytes: Arc<[u8]> = encode_png(&picture)?.into();
            image.data = ImageData::Bytes { bytes, uri: None };
            image.mime = "image/png".into();
        }
    }
    Ok(Cow::Owned(scene))
}
