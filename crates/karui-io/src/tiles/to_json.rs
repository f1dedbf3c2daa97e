//! From the model of a tileset to its JSON, without recursion over tiles.

use super::model::{
    Asset, BoundingVolume, Content, ImplicitTiling, Refine, Region, Scheme, Shape, Tile, Tileset,
};
use serde_json::{Map, Value, json};

/// What is still to be written.
enum Step {
    Tile(u32),
    Text(&'static str),
}

/// The text of a tileset file. Tiles that are not reachable from the first are
/// left out.
pub(super) fn to_json(tileset: &Tileset) -> Vec<u8> {
    let mut out = open(document(tileset));
    if !tileset.tiles.is_empty() {
        out.extend(b",\"root\":");
        write_tiles(tileset, &mut out);
    }
    out.push(b'}');
    out
}

fn write_tiles(tileset: &Tileset, out: &mut Vec<u8>) {
    let mut steps = vec![Step::Tile(0)];
    while let Some(step) = steps.pop() {
        let tile = match step {
            Step::Text(text) => {
                out.extend(text.bytes());
                continue;
            }
            Step::Tile(tile) => &tileset.tiles[tile as usize],
        };
        out.extend(open(tile_json(tile)));
        if tile.children.is_empty() {
            out.push(b'}');
            continue;
        }
        out.extend(b",\"children\":[");
        steps.push(Step::Text("]}"));
        for (i, &child) in tile.children.iter().enumerate().rev() {
            steps.push(Step::Tile(child));
            if i > 0 {
                steps.push(Step::Text(","));
            }
        }
    }
}

/// An object, which must not be empty, without its closing brace.
fn open(json: Map<String, Value>) -> Vec<u8> {
    let mut text = Value::Object(json).to_string().into_bytes();
    text.pop();
    text
}

fn document(tileset: &Tileset) -> Map<String, Value> {
    let mut json = Map::new();
    json.insert("asset".into(), asset(&tileset.asset));
    json.insert("geometricError".into(), json!(tileset.geometric_error));
    let lists = [
        ("extensionsUsed", &tileset.extensions_used),
        ("extensionsRequired", &tileset.extensions_required),
    ];
    for (key, list) in lists {
        if !list.is_empty() {
            json.insert(key.into(), json!(list));
        }
    }
    json.extend(tileset.other.clone());
    json
}

fn asset(asset: &Asset) -> Value {
    let mut json = Map::new();
    json.insert("version".into(), json!(asset.version));
    json.extend(asset.other.clone());
    Value::Object(json)
}

fn tile_json(tile: &Tile) -> Map<String, Value> {
    let mut json = Map::new();
    let mut put = |key: &str, value: Value| drop(json.insert(key.into(), value));
    put("boundingVolume", volume(&tile.bounding_volume));
    if let Some(request) = &tile.viewer_request_volume {
        put("viewerRequestVolume", volume(request));
    }
    put("geometricError", json!(tile.geometric_error));
    match tile.refine {
        Some(Refine::Add) => put("refine", json!("ADD")),
        Some(Refine::Replace) => put("refine", json!("REPLACE")),
        None => {}
    }
    if let Some(transform) = tile.transform {
        put("transform", json!(transform.to_cols_array()));
    }
    match &tile.contents[..] {
        [one] if !tile.plural => put("content", content(one)),
        [] => {}
        many => put("contents", many.iter().map(content).collect()),
    }
    if let Some(tiling) = &tile.implicit {
        put("implicitTiling", implicit(tiling));
    }
    json.extend(tile.other.clone());
    json
}

fn content(content: &Content) -> Value {
    let mut json = Map::new();
    json.insert("uri".into(), json!(content.uri));
    if let Some(bounds) = &content.bounding_volume {
        json.insert("boundingVolume".into(), volume(bounds));
    }
    json.extend(content.other.clone());
    Value::Object(json)
}

fn implicit(tiling: &ImplicitTiling) -> Value {
    let scheme = match tiling.scheme {
        Scheme::Quadtree => "QUADTREE",
        Scheme::Octree => "OCTREE",
    };
    let mut json = Map::new();
    let mut put = |key: &str, value: Value| drop(json.insert(key.into(), value));
    put("subdivisionScheme", json!(scheme));
    put("subtreeLevels", json!(tiling.subtree_levels));
    put("availableLevels", json!(tiling.available_levels));
    put("subtrees", json!({ "uri": tiling.subtrees }));
    json.extend(tiling.other.clone());
    Value::Object(json)
}

fn volume(volume: &BoundingVolume) -> Value {
    let mut json = Map::new();
    if let Some(shape) = volume.shape {
        let (key, numbers) = numbers(shape);
        json.insert(key.into(), json!(numbers));
    }
    json.extend(volume.other.clone());
    Value::Object(json)
}

fn numbers(shape: Shape) -> (&'static str, Vec<f64>) {
    match shape {
        Shape::Box { center, half_axes } => {
            let vectors = [center, half_axes[0], half_axes[1], half_axes[2]];
            ("box", vectors.iter().flat_map(|v| v.to_array()).collect())
        }
        Shape::Sphere { center, radius } => ("sphere", vec![center.x, center.y, center.z, radius]),
        Shape::Region(Region {
            west,
            south,
            east,
            north,
            min_height,
            max_height,
        }) => (
            "region",
            vec![west, south, east, north, min_height, max_height],
        ),
    }
}
