//! Reading MTL.
//!
//! Classic (`Kd Ns d map_Kd`) and physically based statements (`Pr Pm norm`,
//! by Exocortex) become a metallic-roughness material. Without `Pr` roughness
//! follows from the Phong exponent as sqrt(2 / (Ns + 2)). Colours are taken as
//! linear, as they are.

use super::Library;
use crate::{
    error::{ErrorKind, Result},
    source::{Source, relative_path},
    text::{Lines, Words, float, name, parse},
};
use karui::{
    geom::{Vec2, Vec3},
    mesh::{AlphaMode, Image, ImageData, Material, Texture, TextureRef, UvTransform, Wrap},
};
use std::{collections::HashMap, path::PathBuf};

/// Materials accepted from one library.
const MOST: usize = 1 << 20;

/// Adds the materials of the libraries named by one `mtllib` statement: one
/// file whose name may hold blanks, or else several names. Warns of what is
/// not there or not understood; the geometry needs none of it.
pub(super) fn read_libraries(uri: &str, source: &mut Source<'_>, to: &mut Library) -> Result<()> {
    if read_library(uri, source, to)? {
        return Ok(());
    }
    let words: Vec<&str> = uri.split_whitespace().collect();
    if words.len() > 1 {
        let mut found = false;
        for word in words {
            found |= read_library(word, source, to)?;
        }
        if found {
            return Ok(());
        }
    }
    let message = format!("material library `{uri}` was not found");
    source.warnings.push(message);
    Ok(())
}

/// Adds the materials of the library `uri`; `false` if there is no such file.
fn read_library(uri: &str, source: &mut Source<'_>, to: &mut Library) -> Result<bool> {
    let bytes = match source.companion(uri) {
        Ok(Some(bytes)) => bytes,
        Ok(None) => return Ok(false),
        Err(error) => {
            source.warnings.push(error.to_string());
            return Ok(true);
        }
    };
    let mut reader = Reader {
        source,
        to,
        uri,
        images: HashMap::new(),
        has_roughness: false,
    };
    let mut lines = Lines::new(&bytes);
    while let Some(line) = lines.next() {
        if let Err(kind) = reader.line(line) {
            let error = lines.fail(kind).in_file(uri);
            reader.source.warnings.push(error.to_string());
        }
        reader.limit().map_err(|k| lines.fail(k).in_file(uri))?;
    }
    Ok(true)
}

/// Index in the library of every name in use; materials that no library holds
/// are added as plain ones.
pub(super) fn resolve(
    names: &[String],
    source: &mut Source<'_>,
    library: &mut Library,
) -> Vec<u32> {
    let mut index_of: HashMap<String, u32> = HashMap::new();
    for (i, material) in library.materials.iter().enumerate() {
        let name = material.name.clone().unwrap_or_default();
        index_of.entry(name).or_insert(i as u32);
    }
    let has_library = !library.materials.is_empty();
    let mut resolved = Vec::with_capacity(names.len());
    for name in names {
        let index = *index_of.entry(name.clone()).or_insert_with(|| {
            if has_library {
                let message = format!("material `{name}` is in no library");
                source.warnings.push(message);
            }
            library.materials.push(plain(name.clone()));
            library.materials.len() as u32 - 1
        });
        resolved.push(index);
    }
    resolved
}

fn plain(name: String) -> Material {
    Material {
        name: Some(name),
        metallic: 0.0,
        ..Material::default()
    }
}

struct Reader<'a, 'b> {
    source: &'a mut Source<'b>,
    to: &'a mut Library,
    uri: &'a str,
    /// Image of every file met.
    images: HashMap<PathBuf, u32>,
    /// Whether the current material has said `Pr`.
    has_roughness: bool,
}

/// What a texture statement says besides the file.
struct Map {
    texture: TextureRef,
    file: String,
    bump: f32,
}

impl Reader<'_, '_> {
    fn line(&mut self, line: &[u8]) -> Result<(), ErrorKind> {
        let mut words = Words::new(line);
        let Some(word) = words.next() else {
            return Ok(());
        };
        if word == b"newmtl" {
            self.has_roughness = false;
            self.to.materials.push(plain(name(words.rest())));
            return Ok(());
        }
        if self.to.materials.is_empty() {
            return Ok(());
        }
        let word = word.to_ascii_lowercase();
        match word.as_slice() {
            b"map_kd" | b"map_ke" | b"map_bump" | b"bump" | b"norm" | b"map_pr" | b"map_pm"
            | b"map_d" | b"map_ks" | b"map_ns" => self.texture(&word, words),
            _ => self.value(&word, words),
        }
    }

    fn limit(&self) -> Result<(), ErrorKind> {
        let found = self.to.materials.len();
        if found <= MOST {
            return Ok(());
        }
        let (found, limit) = (found as u64, MOST as u64);
        let what = "materials";
        Err(ErrorKind::TooLarge { what, found, limit })
    }

    fn value(&mut self, word: &[u8], words: Words<'_>) -> Result<(), ErrorKind> {
        let has_roughness = self.has_roughness;
        let Some(material) = self.to.materials.last_mut() else {
            return Ok(());
        };
        match word {
            b"kd" => {
                let color = color(words)?;
                material.base_color = color.extend(material.base_color.w);
            }
            b"ke" => material.emissive = color(words)?,
            b"ns" if !has_roughness => {
                let shininess = number(words)?.max(0.0);
                material.roughness = (2.0 / (shininess + 2.0)).sqrt();
            }
            b"pr" => {
                material.roughness = number(words)?.clamp(0.0, 1.0);
                self.has_roughness = true;
            }
            b"pm" => material.metallic = number(words)?.clamp(0.0, 1.0),
            b"d" => {
                let mut words = words;
                if words.clone().next() == Some(b"-halo") {
                    words.next();
                }
                set_alpha(material, number(words)?);
            }
            b"tr" => set_alpha(material, 1.0 - number(words)?),
            _ => {}
        }
        Ok(())
    }

    fn texture(&mut self, word: &[u8], words: Words<'_>) -> Result<(), ErrorKind> {
        let Some(map) = self.map(words)? else {
            return Ok(());
        };
        let image_of = |to: &Library, t: TextureRef| to.textures[t.texture as usize].image;
        let image = image_of(self.to, map.texture);
        let Some(material) = self.to.materials.last() else {
            return Ok(());
        };
        let same = |t: Option<TextureRef>| t.is_some_and(|t| image_of(self.to, t) == image);
        let same_as_base = same(material.base_color_texture);
        let other_half = material.metallic_roughness_texture;
        let same_as_other_half = other_half.is_none() || same(other_half);
        let Some(material) = self.to.materials.last_mut() else {
            return Ok(());
        };
        match word {
            b"map_kd" => material.base_color_texture = Some(map.texture),
            b"map_ke" => material.emissive_texture = Some(map.texture),
            b"norm" => {
                material.normal_texture = Some(map.texture);
                material.normal_scale = map.bump;
            }
            b"map_bump" | b"bump" if material.normal_texture.is_none() => {
                material.normal_texture = Some(map.texture);
                material.normal_scale = map.bump;
            }
            b"map_pr" | b"map_pm" if same_as_other_half => {
                material.metallic_roughness_texture = Some(map.texture);
            }
            b"map_d" if same_as_base => material.alpha_mode = AlphaMode::Blend,
            _ => {
                let statement = name(word);
                let message = format!("`{statement} {}` was passed over", map.file);
                self.source.warnings.push(message);
            }
        }
        Ok(())
    }

    /// Options and file of a texture statement; `None` without a file.
    fn map(&mut self, mut words: Words<'_>) -> Result<Option<Map>, ErrorKind> {
        let mut wrap = [Wrap::Repeat; 2];
        let (mut offset, mut scale) = (Vec2::ZERO, Vec2::ONE);
        let mut bump = 1.0;
        loop {
            let mut ahead = words.clone();
            let Some(option) = ahead.next() else {
                return Ok(None);
            };
            match option {
                b"-o" | b"-s" | b"-t" => {
                    let pair = up_to_three(&mut ahead);
                    match option {
                        b"-o" => offset = pair_or(&pair, Vec2::ZERO),
                        b"-s" => scale = pair_or(&pair, Vec2::ONE),
                        _ => {}
                    }
                }
                b"-mm" => drop((ahead.next(), ahead.next())),
                b"-bm" => bump = number_of(&mut ahead)?,
                b"-clamp" => {
                    if ahead.next() == Some(b"on") {
                        wrap = [Wrap::Clamp; 2];
                    }
                }
                b"-blendu" | b"-blendv" | b"-cc" | b"-texres" | b"-imfchan" | b"-boost"
                | b"-type" | b"-colorspace" => drop(ahead.next()),
                _ => break,
            }
            words = ahead;
        }
        let file = name(words.rest());
        let image = self.image(&file);
        let texture = self.add_texture(image, wrap);
        let texture = TextureRef {
            texture,
            uv_set: 0,
            transform: uv_transform(offset, scale),
        };
        Ok(Some(Map {
            texture,
            file,
            bump,
        }))
    }

    fn add_texture(&mut self, image: u32, wrap: [Wrap; 2]) -> u32 {
        let texture = Texture {
            image: Some(image),
            wrap,
            nearest: false,
        };
        let textures = &mut self.to.textures;
        // Only the last few are looked through, so that a file of very many
        // textures is not quadratic.
        let recent = textures.len().saturating_sub(16);
        if let Some(at) = textures[recent..].iter().position(|t| *t == texture) {
            return (recent + at) as u32;
        }
        textures.push(texture);
        textures.len() as u32 - 1
    }

    fn image(&mut self, file: &str) -> u32 {
        let uri = beside(self.uri, file);
        // However a path is spelt, the file is read once.
        let key = relative_path(&uri).unwrap_or_else(|| uri.clone().into());
        if let Some(&image) = self.images.get(&key) {
            return image;
        }
        let data = match self.source.companion(&uri) {
            Ok(Some(bytes)) => ImageData::Bytes {
                bytes: bytes.into(),
                uri: Some(uri),
            },
            Ok(None) => {
                let message = format!("texture `{file}` was not found");
                self.source.warnings.push(message);
                ImageData::Missing { uri: file.into() }
            }
            Err(error) => {
                self.source.warnings.push(error.to_string());
                ImageData::Missing { uri: file.into() }
            }
        };
        let image = self.to.images.len() as u32;
        self.to.images.push(Image {
            name: None,
            mime: mime(file).into(),
            data,
        });
        self.images.insert(key, image);
        image
    }
}

/// A path in a library, from the model's folder.
fn beside(library: &str, file: &str) -> String {
    let library = library.replace('\\', "/");
    match library.rsplit_once('/') {
        Some((folder, _)) if relative_path(file).is_some() => {
            format!("{folder}/{file}")
        }
        _ => file.to_owned(),
    }
}

fn mime(file: &str) -> &'static str {
    let extension = file.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase());
    match extension.as_deref() {
        Some("png") => "image/png",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("webp") => "image/webp",
        Some("ktx2") => "image/ktx2",
        Some("bmp") => "image/bmp",
        Some("tga") => "image/x-tga",
        _ => "",
    }
}

fn set_alpha(material: &mut Material, alpha: f32) {
    material.base_color.w = alpha.clamp(0.0, 1.0);
    if material.base_color.w < 1.0 {
        material.alpha_mode = AlphaMode::Blend;
    }
}

/// `-o` and `-s` count v from below. v' = o + s v there means
/// v' = (1 - o - s) + s v counted from above.
fn uv_transform(offset: Vec2, scale: Vec2) -> Option<UvTransform> {
    if (offset, scale) == (Vec2::ZERO, Vec2::ONE) {
        return None;
    }
    let offset = Vec2::new(offset.x, 1.0 - offset.y - scale.y);
    offset.is_finite().then_some(UvTransform {
        offset,
        rotation: 0.0,
        scale,
    })
}

/// The numbers that follow, at most three.
fn up_to_three(words: &mut Words<'_>) -> Vec<f32> {
    let mut values = Vec::new();
    while values.len() < 3 {
        let mut ahead = words.clone();
        match ahead.next().and_then(parse::<f32>) {
            Some(value) if value.is_finite() => values.push(value),
            _ => break,
        }
        *words = ahead;
    }
    values
}

fn pair_or(values: &[f32], default: Vec2) -> Vec2 {
    let value = |i: usize| values.get(i).copied().unwrap_or(default[i]);
    Vec2::new(value(0), value(1))
}

fn number(mut words: Words<'_>) -> Result<f32, ErrorKind> {
    number_of(&mut words)
}

fn number_of(words: &mut Words<'_>) -> Result<f32, ErrorKind> {
    let missing = || ErrorKind::syntax("a number", "the end of the line");
    float(words.next().ok_or_else(missing)?, "material value")
}

/// Three numbers, or one for all three. Spectral curves are not modelled.
fn color(mut words: Words<'_>) -> Result<Vec3, ErrorKind> {
    let mut ahead = words.clone();
    match ahead.next() {
        Some(b"spectral") => return Ok(Vec3::ONE),
        Some(b"xyz") => words = ahead,
        _ => {}
    }
    let red = number_of(&mut words)?;
    let rest: Vec<&[u8]> = words.take(2).collect();
    if let [green, blue] = rest[..] {
        let what = "material value";
        return Ok(Vec3::new(red, float(green, what)?, float(blue, what)?));
    }
    Ok(Vec3::splat(red))
}
