//! Nodes, scenes, textures and images: reading each from its JSON object.

use super::{
    budget::Budget,
    document::{Document, companion},
    json::{self, At, ROOT},
    lod,
    uri::{self, Uri},
};
use crate::{
    error::{Error, ErrorKind, Result},
    source::Source,
};
use glam::{Mat4, Quat, Vec3};
use karui::mesh::{Image, ImageData, Node, Texture, Transform, Wrap};
use serde_json::Value;
use std::collections::HashMap;

/// Lengths of the arrays that nodes refer to.
pub(super) struct Counts {
    pub nodes: usize,
    pub meshes: usize,
    pub skins: usize,
}

/// Reads a node.
pub(super) fn read_node(raw: &Value, counts: &Counts, at: &At<'_>) -> Result<Node> {
    let index = |key, count, what| json::index(raw, key, count, what, at);
    Ok(Node {
        name: json::name(raw),
        transform: read_transform(raw, at)?,
        mesh: index("mesh", counts.meshes, "mesh")?.map(|m| m as u32),
        skin: index("skin", counts.skins, "skin")?.map(|s| s as u32),
        children: json::indices(raw, "children", counts.nodes, "node", at)?,
        lods: lod::read(raw, counts.nodes, at)?,
        ..Node::default()
    })
}

fn read_transform(raw: &Value, at: &At<'_>) -> Result<Transform> {
    if let Some(matrix) = json::floats::<16>(raw, "matrix", at)? {
        return Ok(Transform::Matrix(Mat4::from_cols_array(&matrix)));
    }
    let vector = |key| json::floats::<3>(raw, key, at);
    let rotation = json::floats::<4>(raw, "rotation", at)?;
    Ok(Transform::Trs {
        translation: vector("translation")?.map_or(Vec3::ZERO, Vec3::from_array),
        rotation: rotation.map_or(Quat::IDENTITY, Quat::from_array),
        scale: vector("scale")?.map_or(Vec3::ONE, Vec3::from_array),
    })
}

/// Checks that the nodes form trees: no node has two parents or is its own
/// ancestor.
pub(super) fn check_trees(nodes: &[Node]) -> Result<()> {
    let mut parents: Vec<Option<u32>> = vec![None; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        let at = ROOT.item("nodes", n);
        for (i, &child) in node.children.iter().enumerate() {
            let parent = &mut parents[child as usize];
            if let Some(other) = parent.replace(n as u32) {
                let at = at.item("children", i);
                return Err(bad_child(&at, n, child, other == n as u32));
            }
        }
    }
    check_acyclic(&parents)
}

fn bad_child(at: &At<'_>, node: usize, child: u32, twice: bool) -> Error {
    let problem = if twice {
        "is listed twice"
    } else {
        "has another parent already"
    };
    at.fail(ErrorKind::Geometry(karui::Error::BadReference {
        what: "node",
        index: node,
        target: "node",
        to: child as usize,
        problem,
    }))
}

/// Every node has at most one parent here, so that the nodes which cannot be
/// reached from a node without parent are those on or below a cycle.
fn check_acyclic(parents: &[Option<u32>]) -> Result<()> {
    // 0 unknown, 1 on the present path, 2 known to end at a root.
    let mut state = vec![0u8; parents.len()];
    for start in 0..parents.len() {
        let mut path = Vec::new();
        let mut current = Some(start);
        while let Some(n) = current.filter(|&n| state[n] != 2) {
            if state[n] == 1 {
                let kind = ErrorKind::Geometry(karui::Error::BadReference {
                    what: "node",
                    index: n,
                    target: "node",
                    to: n,
                    problem: "is its own ancestor",
                });
                return Err(ROOT.item("nodes", n).fail(kind));
            }
            state[n] = 1;
            path.push(n);
            current = parents[n].map(|p| p as usize);
        }
        path.into_iter().for_each(|n| state[n] = 2);
    }
    Ok(())
}

/// Index of the scene shown by default, if there are scenes.
pub(super) fn default_scene(json: &Value) -> Result<Option<usize>> {
    let scenes = json::count(json, "scenes");
    let named = json::index(json, "scene", scenes, "scene", &ROOT)?;
    Ok(named.or_else(|| (scenes > 0).then_some(0)))
}

/// Roots of the scene shown by default. A file without scenes shows all nodes
/// that have no parent and are not stand-ins of others.
pub(super) fn roots(json: &Value, nodes: &[Node]) -> Result<Vec<u32>> {
    let scenes = json::array(json, "scenes", &ROOT)?;
    for (i, scene) in scenes.iter().enumerate() {
        let at = ROOT.item("scenes", i);
        json::indices(scene, "nodes", nodes.len(), "node", &at)?;
    }
    if let Some(shown) = default_scene(json)? {
        let at = ROOT.item("scenes", shown);
        let mut roots = json::indices(&scenes[shown], "nodes", nodes.len(), "node", &at)?;
        let mut seen = vec![false; nodes.len()];
        roots.retain(|&r| !std::mem::replace(&mut seen[r as usize], true));
        return Ok(roots);
    }
    let mut root = vec![true; nodes.len()];
    for node in nodes {
        let stand_ins = node.lods.iter().flat_map(|l| &l.nodes);
        for &other in node.children.iter().chain(stand_ins) {
            root[other as usize] = false;
        }
    }
    Ok((0..nodes.len() as u32)
        .filter(|&n| root[n as usize])
        .collect())
}

/// Extensions that name an image of a media type that the core format does
/// not allow as a texture's `source`.
pub(super) const IMAGE_TYPES: [(&str, &str); 3] = [
    ("image/ktx2", "KHR_texture_basisu"),
    ("image/webp", "EXT_texture_webp"),
    ("image/vnd-ms.dds", "MSFT_texture_dds"),
];

/// Index of a texture's image: the one any viewer understands or else the one
/// an extension names.
fn image_of(raw: &Value, images: usize, at: &At<'_>) -> Result<Option<usize>> {
    if let Some(image) = json::index(raw, "source", images, "image", at)? {
        return Ok(Some(image));
    }
    let at = at.key("extensions");
    for (_, name) in IMAGE_TYPES {
        if let Some(extension) = json::extension(raw, name) {
            return json::index(extension, "source", images, "image", &at.key(name));
        }
    }
    Ok(None)
}

/// Reads a texture together with its sampler.
pub(super) fn read_texture(raw: &Value, json: &Value, at: &At<'_>) -> Result<Texture> {
    let samplers = json::array(json, "samplers", &ROOT)?;
    let sampler = json::index(raw, "sampler", samplers.len(), "sampler", at)?;
    let none = Value::Null;
    let sampler = sampler.map_or(&none, |s| &samplers[s]);
    let images = json::count(json, "images");
    let image = image_of(raw, images, at)?;
    let wrap = |key| match sampler.get(key).and_then(Value::as_u64) {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    Ok(Texture {
        image: image.map(|i| i as u32),
        wrap: [wrap("wrapS"), wrap("wrapT")],
        nearest: sampler.get("magFilter").and_then(Value::as_u64) == Some(9728),
    })
}

/// Reads images; files that several name are read once.
pub(super) struct ImageReader<'r, 's> {
    pub document: &'r Document,
    pub budget: &'r Budget,
    pub source: &'r mut Source<'s>,
    /// Files read so far, by path.
    pub known: HashMap<String, ImageData>,
}

impl ImageReader<'_, '_> {
    /// Reads an image's encoded bytes, or notes that they are missing.
    pub fn read(&mut self, raw: &Value, at: &At<'_>) -> Result<Image> {
        let mut mime = json::text(raw, "mimeType").unwrap_or_default().to_owned();
        let views = self.document.view_count();
        let data = match json::index(raw, "bufferView", views, "bufferView", at)? {
            Some(view) => {
                let bytes = self.document.view(view);
                // Many images may name one buffer view.
                self.budget.take(bytes.len(), 1, at)?;
                let (bytes, uri) = (bytes.into(), None);
                ImageData::Bytes { bytes, uri }
            }
            None => self.read_uri(raw, &mut mime, at)?,
        };
        if let ImageData::Bytes { bytes, .. } = &data
            && mime.is_empty()
        {
            mime = mime_of(bytes).to_owned();
        }
        Ok(Image {
            name: json::name(raw),
            mime,
            data,
        })
    }

    fn read_uri(&mut self, raw: &Value, mime: &mut String, at: &At<'_>) -> Result<ImageData> {
        let Some(text) = json::text(raw, "uri") else {
            // An extension may name the image in its own way.
            return Ok(ImageData::Missing { uri: String::new() });
        };
        let at = at.key("uri");
        let path = match uri::decode(text).map_err(|kind| at.fail(kind))? {
            Uri::Path(path) => path,
            Uri::Data { mime: m, bytes } => {
                if mime.is_empty() {
                    *mime = m.to_owned();
                }
                let bytes = bytes.into();
                return Ok(ImageData::Bytes { bytes, uri: None });
            }
        };
        if let Some(data) = self.known.get(&path) {
            return Ok(data.clone());
        }
        let data = self.read_file(&path, &at)?;
        self.known.insert(path, data.clone());
        Ok(data)
    }

    fn read_file(&mut self, path: &str, at: &At<'_>) -> Result<ImageData> {
        let uri = path.to_owned();
        match companion(path, self.source, at)? {
            Some(bytes) => Ok(ImageData::Bytes {
                bytes: bytes.into(),
                uri: Some(uri),
            }),
            None => {
                let warning = format!("{at}: the image `{path}` was not found");
                self.source.warnings.push(warning);
                Ok(ImageData::Missing { uri })
            }
        }
    }
}

/// Media type of an encoded image by its first bytes; empty if unknown.
pub(super) fn mime_of(bytes: &[u8]) -> &'static str {
    if bytes.starts_with(b"\x89PNG") {
        "image/png"
    } else if bytes.starts_with(&[0xff, 0xd8, 0xff]) {
        "image/jpeg"
    } else if bytes.starts_with(b"\xabKTX 20\xbb") {
        "image/ktx2"
    } else if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        "image/webp"
    } else if bytes.starts_with(b"DDS ") {
        "image/vnd-ms.dds"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn nodes(children: &[&[u32]]) -> Vec<Node> {
        let node = |c: &&[u32]| Node {
            children: c.to_vec(),
            ..Node::default()
        };
        children.iter().map(node).collect()
    }

    #[test]
    fn trees_only() {
        assert!(check_trees(&nodes(&[&[1, 2], &[3], &[], &[]])).is_ok());
        let problem = |children: &[&[u32]]| check_trees(&nodes(children)).unwrap_err().to_string();
        assert!(problem(&[&[0]]).contains("is its own ancestor"));
        assert!(problem(&[&[], &[2], &[3], &[1]]).contains("is its own ancestor"));
        assert!(problem(&[&[2], &[2], &[]]).contains("has another parent"));
        assert!(problem(&[&[1, 1], &[]]).contains("is listed twice"));
    }

    #[test]
    fn a_file_without_scenes_shows_all_roots() {
        let mut nodes = nodes(&[&[1], &[], &[], &[]]);
        nodes[0].lods = Some(karui::mesh::LodLinks {
            nodes: vec![3],
            coverage: vec![],
        });
        assert_eq!(roots(&json!({}), &nodes).unwrap(), [0, 2]);
        let json = json!({"scenes": [{"nodes": [2]}, {"nodes": [0, 2]}], "scene": 1});
        assert_eq!(roots(&json, &nodes).unwrap(), [0, 2]);
        assert!(roots(&json!({"scenes": [{"nodes": [4]}]}), &nodes).is_err());
        assert!(roots(&json!({"scenes": [{}], "scene": 1}), &nodes).is_err());
    }
}
