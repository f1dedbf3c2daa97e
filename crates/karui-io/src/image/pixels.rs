//! Images that were made here rather than read.

use super::{decode_image, encode_png};
use crate::error::{Error, ErrorKind, Place, Result};
use karui::{
    Scene,
    mesh::{Image, ImageData},
    render::Picture,
};
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
