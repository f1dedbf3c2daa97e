//! Writing MTL.

use crate::{
    atomic::Sink,
    number::{write_double, write_float, write_floats},
};
use karui::{
    Scene,
    mesh::{AlphaMode, Image, ImageData, Material, TextureRef, Wrap},
};
use std::{collections::BTreeMap, fs, io, path::Path};

/// Names of materials as `usemtl` uses them: one word each, all different.
pub(super) fn material_names(scene: &Scene) -> Vec<String> {
    let given = |m: &Material| m.name.clone().unwrap_or_default();
    unique(scene.materials.iter().map(given), "material")
}

/// Names without blanks at the ends and control characters, made different by
/// a number where they are not.
pub(super) fn unique(names: impl Iterator<Item = String>, empty: &str) -> Vec<String> {
    let mut uses: BTreeMap<String, usize> = BTreeMap::new();
    let mut found = Vec::new();
    for name in names {
        let printable = |c: char| if c.is_control() { '_' } else { c };
        let name: String = name.trim().chars().map(printable).collect();
        let name = if name.is_empty() {
            empty.to_owned()
        } else {
            name
        };
        let mut candidate = name.clone();
        while uses.contains_key(&candidate) {
            let n = uses.entry(name.clone()).or_default();
            *n += 1;
            candidate = format!("{name}.{n}");
        }
        uses.insert(candidate.clone(), 0);
        found.push(candidate);
    }
    found
}

/// A file to be written beside the model.
pub(super) struct Companion<'a> {
    pub name: String,
    pub bytes: &'a [u8],
}

/// The file every image is written to or found at, and those to be written.
///
/// A file of that name that holds something else is left alone, unless it is
/// named after the model.
pub(super) fn image_files<'a>(scene: &'a Scene, model: &Path) -> (Vec<String>, Vec<Companion<'a>>) {
    let stem = model_stem(model);
    let folder = model.parent().unwrap_or(Path::new(""));
    let wanted = scene.images.iter().enumerate().map(|(i, image)| {
        let (name, bytes) = wanted_name(image, &stem, i);
        match (bytes, fs::read(folder.join(&name))) {
            (Some(bytes), Ok(there)) if there != bytes => format!("{stem}-{name}"),
            _ => name,
        }
    });
    let model = model.file_name().unwrap_or_default().to_string_lossy();
    let taken = [model.into_owned(), format!("{stem}.mtl")];
    let names = unique_files(wanted, taken);
    let mut companions = Vec::new();
    for (image, name) in scene.images.iter().zip(&names) {
        if let ImageData::Bytes { bytes, .. } = &image.data {
            let name = name.clone();
            companions.push(Companion { name, bytes });
        }
    }
    (names, companions)
}

/// The names, made different from each other and from those taken.
fn unique_files(names: impl Iterator<Item = String>, taken: [String; 2]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut seen = std::collections::BTreeSet::from(taken);
    for (i, name) in names.enumerate() {
        let name = if seen.contains(&name) {
            format!("{i}-{name}")
        } else {
            name
        };
        seen.insert(name.clone());
        found.push(name);
    }
    found
}

/// The model's file name up to the first known extension.
pub(super) fn model_stem(model: &Path) -> String {
    let name = model.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    stem.to_owned()
}

fn wanted_name<'a>(image: &'a Image, stem: &str, i: usize) -> (String, Option<&'a [u8]>) {
    match &image.data {
        ImageData::Missing { uri } => (uri.clone(), None),
        // They have been encoded before.
        ImageData::Pixels { .. } => (format!("{stem}-{i}.png"), None),
        ImageData::Bytes { bytes, uri } => {
            let uri = uri.as_deref().and_then(crate::source::relative_path);
            let file = uri.as_deref().and_then(Path::file_name);
            let generated = || format!("{stem}-{i}.{}", extension(&image.mime));
            let name = file.map_or_else(generated, |f| f.to_string_lossy().into_owned());
            (name, Some(bytes))
        }
    }
}

fn extension(mime: &str) -> &str {
    match mime {
        "image/jpeg" => "jpg",
        "image/x-tga" => "tga",
        _ => match mime.rsplit_once('/') {
            Some((_, kind)) if kind.chars().all(|c| c.is_ascii_alphanumeric()) => kind,
            _ => "bin",
        },
    }
}

/// Writes all materials.
pub(super) fn write(
    sink: &mut Sink<'_>,
    scene: &Scene,
    names: &[String],
    images: &[String],
) -> io::Result<()> {
    sink.write_all(b"# written by karui\n")?;
    for (material, name) in scene.materials.iter().zip(names) {
        writeln!(sink, "\nnewmtl {name}")?;
        write_values(sink, material)?;
        write_maps(sink, scene, material, images)?;
    }
    Ok(())
}

fn write_values(sink: &mut Sink<'_>, material: &Material) -> io::Result<()> {
    sink.write_all(b"Kd")?;
    write_floats(sink, &material.base_color.truncate().to_array())?;
    // For readers that know nothing newer: the exponent whose lobe is as wide.
    let roughness = f64::from(material.roughness).max(0.01);
    sink.write_all(b"\nNs ")?;
    write_double(sink, (2.0 / (roughness * roughness) - 2.0).max(0.0).round())?;
    for (statement, value) in [("Pr", material.roughness), ("Pm", material.metallic)] {
        write!(sink, "\n{statement} ")?;
        write_float(sink, value)?;
    }
    if material.emissive != karui::geom::Vec3::ZERO {
        sink.write_all(b"\nKe")?;
        write_floats(sink, &material.emissive.to_array())?;
    }
    if material.alpha_mode != AlphaMode::Opaque {
        sink.write_all(b"\nd ")?;
        write_float(sink, material.base_color.w)?;
    }
    sink.write_all(b"\n")
}

fn write_maps(
    sink: &mut Sink<'_>,
    scene: &Scene,
    material: &Material,
    images: &[String],
) -> io::Result<()> {
    let base = material.base_color_texture;
    let alpha = base.filter(|_| material.alpha_mode != AlphaMode::Opaque);
    let maps = [
        ("map_Kd", base),
        ("map_d", alpha),
        ("map_Ke", material.emissive_texture),
        ("map_Pr", material.metallic_roughness_texture),
        ("map_Pm", material.metallic_roughness_texture),
    ];
    for (statement, texture) in maps {
        write_map(sink, scene, statement, "", texture, images)?;
    }
    let mut scale = String::new();
    if material.normal_scale != 1.0 {
        scale = format!(" -bm {}", zmij::Buffer::new().format(material.normal_scale));
    }
    write_map(sink, scene, "norm", &scale, material.normal_texture, images)
}

fn write_map(
    sink: &mut Sink<'_>,
    scene: &Scene,
    statement: &str,
    options: &str,
    texture: Option<TextureRef>,
    images: &[String],
) -> io::Result<()> {
    let Some(reference) = texture else {
        return Ok(());
    };
    let Some(texture) = scene.textures.get(reference.texture as usize) else {
        return Ok(());
    };
    let Some(file) = texture.image.and_then(|i| images.get(i as usize)) else {
        return Ok(());
    };
    write!(sink, "{statement}{options}")?;
    if texture.wrap == [Wrap::Clamp; 2] {
        sink.write_all(b" -clamp on")?;
    }
    if let Some(t) = reference.transform.filter(|t| t.rotation == 0.0) {
        let offset = [t.offset.x, 1.0 - t.offset.y - t.scale.y];
        sink.write_all(b" -o")?;
        write_floats(sink, &offset)?;
        sink.write_all(b" -s")?;
        write_floats(sink, &t.scale.to_array())?;
    }
    writeln!(sink, " {file}")
}
