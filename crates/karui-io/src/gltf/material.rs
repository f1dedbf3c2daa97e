//! Materials: the typed part of what glTF says about them.

use super::{
    encode::{short, shorts},
    json::{self, At},
};
use crate::error::Result;
use glam::{Vec2, Vec3, Vec4};
use karui::mesh::{AlphaMode, Material, TextureRef, UvTransform};
use serde_json::{Value, json};

const TRANSFORM: &str = "KHR_texture_transform";

/// Reads a material; `textures` is the number of textures of the file.
pub(super) fn read(raw: &Value, textures: usize, at: &At<'_>) -> Result<Material> {
    let plain = Material::default();
    let none = Value::Null;
    let pbr = raw.get("pbrMetallicRoughness").unwrap_or(&none);
    let at_pbr = at.key("pbrMetallicRoughness");
    let texture = |owner, key, at: &At<'_>| read_texture(owner, key, textures, at);
    let strength = |key, factor| {
        let owner = raw.get(key).unwrap_or(&none);
        Ok::<f32, crate::Error>(json::float(owner, factor, &at.key(key))?.unwrap_or(1.0))
    };
    Ok(Material {
        name: json::name(raw),
        base_color: json::floats(pbr, "baseColorFactor", &at_pbr)?
            .map_or(plain.base_color, Vec4::from_array),
        base_color_texture: texture(pbr, "baseColorTexture", &at_pbr)?,
        metallic: json::float(pbr, "metallicFactor", &at_pbr)?.unwrap_or(plain.metallic),
        roughness: json::float(pbr, "roughnessFactor", &at_pbr)?.unwrap_or(plain.roughness),
        metallic_roughness_texture: texture(pbr, "metallicRoughnessTexture", &at_pbr)?,
        normal_texture: texture(raw, "normalTexture", at)?,
        normal_scale: strength("normalTexture", "scale")?,
        occlusion_texture: texture(raw, "occlusionTexture", at)?,
        occlusion_strength: strength("occlusionTexture", "strength")?,
        emissive: json::floats(raw, "emissiveFactor", at)?.map_or(plain.emissive, Vec3::from_array),
        emissive_texture: texture(raw, "emissiveTexture", at)?,
        alpha_mode: read_alpha(raw, at)?,
        double_sided: raw.get("doubleSided").and_then(Value::as_bool) == Some(true),
    })
}

fn read_alpha(raw: &Value, at: &At<'_>) -> Result<AlphaMode> {
    let cutoff = json::float(raw, "alphaCutoff", at)?.unwrap_or(0.5);
    Ok(match json::text(raw, "alphaMode") {
        Some("MASK") => AlphaMode::Mask(cutoff),
        Some("BLEND") => AlphaMode::Blend,
        _ => AlphaMode::Opaque,
    })
}

fn read_texture(
    owner: &Value,
    key: &str,
    textures: usize,
    at: &At<'_>,
) -> Result<Option<TextureRef>> {
    let Some(info) = owner.get(key) else {
        return Ok(None);
    };
    let at = at.key(key);
    let Some(texture) = json::index(info, "index", textures, "texture", &at)? else {
        return Err(at.syntax("`index`", "none"));
    };
    let mut uv_set = json::number(info, "texCoord", &at)?.unwrap_or(0);
    let mut transform = None;
    if let Some(extension) = json::extension(info, TRANSFORM) {
        let at = at.key("extensions");
        let at = at.key(TRANSFORM);
        uv_set = json::number(extension, "texCoord", &at)?.unwrap_or(uv_set);
        transform = Some(UvTransform {
            offset: json::floats(extension, "offset", &at)?.map_or(Vec2::ZERO, Vec2::from_array),
            rotation: json::float(extension, "rotation", &at)?.unwrap_or(0.0),
            scale: json::floats(extension, "scale", &at)?.map_or(Vec2::ONE, Vec2::from_array),
        });
    }
    Ok(Some(TextureRef {
        texture: texture as u32,
        uv_set: u32::try_from(uv_set).unwrap_or(u32::MAX),
        transform,
    }))
}

/// Writes `material` over `raw`, what the file said before (or null). What is
/// not modelled stays; what is equal stays as it was.
pub(super) fn write(material: &Material, mut raw: Value) -> Value {
    if !raw.is_object() {
        raw = json!({});
    }
    let plain = Material::default();
    write_name(&mut raw, material.name.as_deref());
    let mut pbr = json::remove(&mut raw, "pbrMetallicRoughness").unwrap_or_else(|| json!({}));
    let color = material.base_color;
    set(
        &mut pbr,
        "baseColorFactor",
        shorts(&color.to_array()),
        color == plain.base_color,
    );
    set(
        &mut pbr,
        "metallicFactor",
        short(material.metallic),
        material.metallic == 1.0,
    );
    set(
        &mut pbr,
        "roughnessFactor",
        short(material.roughness),
        material.roughness == 1.0,
    );
    write_texture(
        &mut pbr,
        "baseColorTexture",
        material.base_color_texture,
        None,
    );
    let texture = material.metallic_roughness_texture;
    write_texture(&mut pbr, "metallicRoughnessTexture", texture, None);
    if pbr.as_object().is_some_and(|o| !o.is_empty()) {
        raw["pbrMetallicRoughness"] = pbr;
    }
    let scale = Some(("scale", material.normal_scale));
    write_texture(&mut raw, "normalTexture", material.normal_texture, scale);
    let strength = Some(("strength", material.occlusion_strength));
    write_texture(
        &mut raw,
        "occlusionTexture",
        material.occlusion_texture,
        strength,
    );
    write_texture(&mut raw, "emissiveTexture", material.emissive_texture, None);
    let emissive = material.emissive;
    set(
        &mut raw,
        "emissiveFactor",
        shorts(&emissive.to_array()),
        emissive == Vec3::ZERO,
    );
    write_alpha(&mut raw, material.alpha_mode);
    set(&mut raw, "doubleSided", json!(true), !material.double_sided);
    raw
}

/// Sets or removes the name of an element.
pub(super) fn write_name(raw: &mut Value, name: Option<&str>) {
    set(raw, "name", json!(name), name.is_none());
}

/// Sets `key`, or removes it if the value is the default one.
pub(super) fn set(raw: &mut Value, key: &str, value: Value, is_default: bool) {
    if is_default {
        json::remove(raw, key);
    } else {
        raw[key] = value;
    }
}

fn write_alpha(raw: &mut Value, mode: AlphaMode) {
    let (name, cutoff) = match mode {
        AlphaMode::Opaque => ("OPAQUE", 0.5),
        AlphaMode::Mask(cutoff) => ("MASK", cutoff),
        AlphaMode::Blend => ("BLEND", 0.5),
    };
    set(raw, "alphaMode", json!(name), mode == AlphaMode::Opaque);
    set(raw, "alphaCutoff", short(cutoff), cutoff == 0.5);
}

fn write_texture(
    owner: &mut Value,
    key: &str,
    texture: Option<TextureRef>,
    factor: Option<(&str, f32)>,
) {
    let Some(texture) = texture else {
        json::remove(owner, key);
        return;
    };
    let info = &mut owner[key];
    if !info.is_object() {
        *info = json!({});
    }
    info["index"] = json!(texture.texture);
    set(info, "texCoord", json!(texture.uv_set), texture.uv_set == 0);
    if let Some((name, factor)) = factor {
        set(info, name, short(factor), factor == 1.0);
    }
    match texture.transform {
        None => json::remove_extension(info, TRANSFORM),
        Some(t) => {
            let mut transform = json!({});
            set(
                &mut transform,
                "offset",
                shorts(&t.offset.to_array()),
                t.offset == Vec2::ZERO,
            );
            set(
                &mut transform,
                "rotation",
                short(t.rotation),
                t.rotation == 0.0,
            );
            set(
                &mut transform,
                "scale",
                shorts(&t.scale.to_array()),
                t.scale == Vec2::ONE,
            );
            json::set_extension(info, TRANSFORM, transform);
        }
    }
}

/// Whether a material uses `KHR_texture_transform`.
pub(super) fn has_transform(material: &Material) -> bool {
    let textures = [
        material.base_color_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
        material.occlusion_texture,
        material.emissive_texture,
    ];
    textures.iter().flatten().any(|t| t.transform.is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use json::ROOT;

    #[test]
    fn written_materials_read_back() {
        let raw = json!({
            "name": "m", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
            "emissiveFactor": [1.0, 0.5, 0.0],
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1.0, 1.0],
                "baseColorTexture": {"index": 1, "texCoord": 2, "extensions":
                    {"KHR_texture_transform": {"offset": [0.5, 0.0], "texCoord": 3}}}},
            "normalTexture": {"index": 0, "scale": 0.5},
            "extensions": {"KHR_materials_unlit": {}}
        });
        let material = read(&raw, 2, &ROOT).unwrap();
        assert_eq!(material.base_color_texture.unwrap().uv_set, 3);
        let fresh = write(&material, Value::Null);
        assert_eq!(read(&fresh, 2, &ROOT).unwrap(), material);
        let mut changed = material.clone();
        changed.metallic = 0.5;
        let merged = write(&changed, raw);
        assert_eq!(read(&merged, 2, &ROOT).unwrap(), changed);
        assert!(merged["extensions"]["KHR_materials_unlit"].is_object());
        assert_eq!(write(&Material::default(), Value::Null), json!({}));
    }

    #[test]
    fn references_are_checked() {
        let raw = json!({"emissiveTexture": {"index": 2}});
        let error = read(&raw, 2, &ROOT).unwrap_err();
        assert!(
            error.to_string().contains("/emissiveTexture/index"),
            "{error}"
        );
    }
}
