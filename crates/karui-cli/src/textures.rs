//! The images of a scene, decoded.

use crate::console::Console;
use crate::input::Input;
use karui::mesh::{Image, ImageData};
use karui::render::Picture;
use rayon::prelude::*;

/// All images of a model that can be decoded, by their index; warns of the others.
pub fn decode(input: &Input, console: &Console) -> Vec<Option<Picture>> {
    let images = &input.scene.images;
    let decoded: Vec<_> = images.par_iter().map(decode_one).collect();
    let named = (0..).zip(images).zip(decoded);
    named
        .map(|((i, image), picture)| {
            let warn = |why: Option<String>| {
                // The reader has warned of files that are not there.
                let Some(why) = why else { return };
                let (path, name) = (input.path.display(), name_of(image, i));
                console.warn(&format!("{path}: {name}: {why}; drawn without it"));
            };
            picture.map_err(warn).ok()
        })
        .collect()
}

/// The image, or what is wrong with it if that is news.
fn decode_one(image: &Image) -> Result<Picture, Option<String>> {
    let picture = karui_io::picture_of(image).map_err(|error| Some(error.to_string()))?;
    picture.ok_or(None)
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
