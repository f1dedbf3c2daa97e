//! Images and textures: embedded in a GLB, files beside a `.gltf`.

use super::{
    json::{self, ROOT},
    material::{set, write_name},
    node::{IMAGE_TYPES, mime_of, read_texture},
    pack::Packer,
    uri,
};
use crate::source::relative_path;
use karui::{
    Scene,
    mesh::{Image, ImageData, Texture, Wrap},
};
use serde_json::{Value, json};
use std::{collections::BTreeMap, path::Path, sync::Arc};

/// Files to be written beside the model, by relative path.
pub(super) type Files = BTreeMap<String, Arc<[u8]>>;

/// Where image bytes go.
pub(super) enum Place<'a> {
    /// Into the buffer of the document.
    Embedded(&'a mut Packer),
    /// Into files; the text starts the names of those that have none.
    Beside(&'a mut Files, &'a str),
}

/// Replaces `images` of the document by those of the scene.
pub(super) fn write_images(json: &mut Value, scene: &Scene, mut place: Place<'_>) {
    let mut images = Vec::with_capacity(scene.images.len());
    for (i, image) in scene.images.iter().enumerate() {
        let mut raw = json
            .pointer(&format!("/images/{i}"))
            .cloned()
            .unwrap_or_else(|| json!({}));
        write_name(&mut raw, image.name.as_deref());
        match &image.data {
            ImageData::Bytes { bytes, uri } => {
                json::remove(&mut raw, "bufferView");
                json::remove(&mut raw, "uri");
                write_bytes(&mut raw, i, image, bytes, uri.as_deref(), &mut place);
            }
            ImageData::Missing { uri } => write_missing(&mut raw, uri),
            // They have been encoded before.
            ImageData::Pixels { .. } => write_missing(&mut raw, ""),
        }
        images.push(raw);
    }
    json["images"] = Value::Array(images);
}

fn write_missing(raw: &mut Value, uri: &str) {
    if raw.get("uri").is_some() || raw.get("bufferView").is_some() {
        return;
    }
    let uri = if uri.is_empty() { "missing" } else { uri };
    raw["uri"] = json!(uri::encode_path(&uri.replace('\\', "/")));
}

fn write_bytes(
    raw: &mut Value,
    index: usize,
    image: &Image,
    bytes: &Arc<[u8]>,
    uri: Option<&str>,
    place: &mut Place<'_>,
) {
    let mime = match (image.mime.as_str(), mime_of(bytes)) {
        ("", "") => "application/octet-stream",
        ("", found) => found,
        (told, _) => told,
    };
    match place {
        Place::Embedded(packer) => {
            raw["mimeType"] = json!(mime);
            raw["bufferView"] = json!(packer.push_view(json!({}), bytes.to_vec()));
        }
        Place::Beside(files, stem) => {
            let wanted = uri.and_then(safe_name);
            let wanted =
                wanted.unwrap_or_else(|| format!("{stem}_image{index}.{}", extension_of(mime)));
            let name = free_name(files, &wanted, bytes);
            raw["uri"] = json!(uri::encode_path(&name));
            files.insert(name, Arc::clone(bytes));
        }
    }
}

/// A relative path that stays below the model's folder; only the file name of
/// one that does not.
fn safe_name(uri: &str) -> Option<String> {
    let text = |path: &Path| path.to_str().map(|s| s.replace('\\', "/"));
    if let Some(path) = relative_path(uri) {
        return text(&path);
    }
    let last = uri.rsplit(['/', '\\', ':']).next()?;
    text(&relative_path(last)?)
}

/// `wanted`, with a number if other bytes have that name already.
fn free_name(files: &Files, wanted: &str, bytes: &[u8]) -> String {
    let is_free = |name: &String| files.get(name).is_none_or(|there| **there == *bytes);
    let (stem, extension) = match wanted.rsplit_once('.') {
        Some((stem, extension)) if !extension.contains('/') => (stem, format!(".{extension}")),
        _ => (wanted, String::new()),
    };
    let numbered = (2..).map(|n| format!("{stem}_{n}{extension}"));
    let mut names = std::iter::once(wanted.to_owned()).chain(numbered);
    names.find(is_free).unwrap_or_else(|| wanted.to_owned())
}

fn extension_of(mime: &str) -> &'static str {
    match mime {
        "image/png" => "png",
        "image/jpeg" => "jpg",
        "image/ktx2" => "ktx2",
        "image/webp" => "webp",
        "image/vnd-ms.dds" => "dds",
        _ => "bin",
    }
}

/// Brings `textures` of the document in step with those of the scene. A
/// texture that is as it was read stays as it is.
pub(super) fn write_textures(json: &mut Value, scene: &Scene) {
    for (t, texture) in scene.textures.iter().enumerate() {
        let raw = json.pointer(&format!("/textures/{t}")).cloned();
        let same = raw
            .as_ref()
            .is_some_and(|raw| read_texture(raw, json, &ROOT).is_ok_and(|read| read == *texture));
        if same {
            continue;
        }
        let mut raw = raw.unwrap_or_else(|| json!({}));
        for (_, name) in IMAGE_TYPES {
            json::remove_extension(&mut raw, name);
        }
        set(
            &mut raw,
            "source",
            json!(texture.image),
            texture.image.is_none(),
        );
        write_sampler(json, &mut raw, texture);
        put(json, "textures", t, raw);
    }
}

/// Names images that are neither PNG nor JPEG by the extension for their type,
/// as the format demands; returns the extensions used.
pub(super) fn name_by_type(json: &mut Value, scene: &Scene) -> Vec<&'static str> {
    let mut used = Vec::new();
    let textures = json.get_mut("textures").and_then(Value::as_array_mut);
    for texture in textures.into_iter().flatten() {
        let image = texture.get("source").and_then(Value::as_u64);
        let Some(image) = image.and_then(|i| scene.images.get(i as usize)) else {
            continue;
        };
        let Some((_, name)) = IMAGE_TYPES.iter().find(|(mime, _)| *mime == image.mime) else {
            continue;
        };
        if let Some(source) = json::remove(texture, "source") {
            json::set_extension(texture, name, json!({ "source": source }));
            used.push(*name);
        }
    }
    used
}

/// Sets element `index` of a top-level array, which has at least that many.
pub(super) fn put(json: &mut Value, key: &str, index: usize, value: Value) {
    if !json[key].is_array() {
        json[key] = json!([]);
    }
    if let Some(items) = json[key].as_array_mut() {
        match items.get_mut(index) {
            Some(item) => *item = value,
            None => items.push(value),
        }
    }
}

fn write_sampler(json: &mut Value, raw: &mut Value, texture: &Texture) {
    let old = raw.get("sampler").and_then(Value::as_u64);
    let old = old.and_then(|s| json.pointer(&format!("/samplers/{s}")).cloned());
    if old.is_none() && texture.wrap == [Wrap::Repeat; 2] && !texture.nearest {
        return;
    }
    let mut sampler = old.unwrap_or_else(|| json!({}));
    for (key, wrap) in [("wrapS", texture.wrap[0]), ("wrapT", texture.wrap[1])] {
        let code = match wrap {
            Wrap::Repeat => 10497,
            Wrap::Mirror => 33648,
            Wrap::Clamp => 33071,
        };
        set(&mut sampler, key, json!(code), wrap == Wrap::Repeat);
    }
    sampler["magFilter"] = json!(if texture.nearest { 9728 } else { 9729 });
    let samplers = json::count(json, "samplers");
    let known = json.get("samplers").and_then(Value::as_array);
    let known = known.and_then(|all| all.iter().position(|s| *s == sampler));
    let index = known.unwrap_or(samplers);
    if known.is_none() {
        put(json, "samplers", samplers, sampler);
    }
    raw["sampler"] = json!(index);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_below_the_folder_and_apart() {
        assert_eq!(safe_name("tex/a.png").as_deref(), Some("tex/a.png"));
        assert_eq!(safe_name("C:\\x\\a.png").as_deref(), Some("a.png"));
        assert_eq!(safe_name("../../a.png").as_deref(), Some("a.png"));
        assert_eq!(safe_name("/.."), None);
        let mut files = Files::new();
        files.insert("a.png".into(), Arc::from(&b"1"[..]));
        assert_eq!(free_name(&files, "a.png", b"1"), "a.png");
        assert_eq!(free_name(&files, "a.png", b"2"), "a_2.png");
    }

    #[test]
    fn changed_textures_get_a_sampler_of_their_own() {
        let mut json = json!({"samplers": [{"wrapS": 33071, "minFilter": 9987}],
            "textures": [{"sampler": 0, "source": 0}], "images": [{}, {}]});
        let texture = |wrap| Texture {
            image: Some(1),
            wrap,
            nearest: false,
        };
        let scene = Scene {
            textures: vec![texture([Wrap::Clamp; 2]), texture([Wrap::Repeat; 2])],
            ..Scene::default()
        };
        write_textures(&mut json, &scene);
        for (t, expected) in scene.textures.iter().enumerate() {
            let raw = &json["textures"][t];
            assert_eq!(read_texture(raw, &json, &ROOT).unwrap(), *expected);
        }
        assert_eq!(json["samplers"][1]["minFilter"], json!(9987));
    }
}
