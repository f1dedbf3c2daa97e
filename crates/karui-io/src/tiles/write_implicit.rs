//! Cells of a regular grid written as an implicit tileset.

use super::{
    extent::Extent,
    implicit::{Cell, MAX_LEVEL, cells, offset},
    model::{BoundingVolume, Content, ImplicitTiling, Scheme, Tile, Tileset},
    publish::Draft,
    tree::{CellTree, TileContents, TilesOptions, TilesWritten, VolumeKind},
    write::{REACH, asset, check_place, z_up, z_up_extent},
    write_content::{Order, Stored, write_contents},
};
use crate::error::{Error, Result};
use glam::{DMat4, DVec3};
use karui::{Progress, Silent};
use serde_json::json;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Share of the root's size by which content may leave its cell: what 32 bits
/// round.
const ROUNDING: f64 = 1e-6;

/// Writes cells with implicit tiling into a new folder: `tileset.json`,
/// `subtrees/` and `content/`. All cells between a cell with content and the
/// root are there, without content of their own.
///
/// Implicit tiles have no transforms, so all contents are relative to the
/// middle of the root cell; keep the root small enough for 32-bit
/// coordinates, or use [`write`](super::write).
///
/// # Errors
/// As [`write`](super::write); and
/// [`Geometry`](crate::ErrorKind::Geometry) if a content leaves its cell.
pub fn write_implicit(
    folder: impl AsRef<Path>,
    tree: &CellTree,
    contents: &dyn TileContents,
    options: &TilesOptions,
) -> Result<TilesWritten> {
    write_implicit_with_progress(folder, tree, contents, options, &Silent)
}

/// [`write_implicit`] with an observer (stage `contents`).
///
/// # Errors
/// As [`write_implicit`]; and [`karui::Error::Cancelled`] if the observer says
/// so.
pub fn write_implicit_with_progress(
    folder: impl AsRef<Path>,
    tree: &CellTree,
    contents: &dyn TileContents,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<TilesWritten> {
    let folder = folder.as_ref();
    run(folder, tree, contents, options, progress).map_err(|e| e.in_file(folder))
}

fn run(
    folder: &Path,
    tree: &CellTree,
    contents: &dyn TileContents,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<TilesWritten> {
    let fail = |error: karui::Error| Error::file(folder, error.into());
    check(tree, options).map_err(fail)?;
    let draft = Draft::new(folder, options.overwrite)?;
    let origin = tree.min + (tree.max - tree.min) * 0.5;
    let template = template(tree.scheme, "content", "glb");
    let order = |(i, cell): (usize, &Cell)| Order {
        node: i as u32,
        origin,
        name: cell.fill(&template),
    };
    let orders: Vec<Order> = tree.cells.iter().enumerate().map(order).collect();
    let stored = write_contents(&draft, &orders, contents, options, progress)?;
    let root = z_up_extent(tree.min, tree.max, options.up).moved(-z_up(origin, options.up));
    contained(tree, root, &stored).map_err(fail)?;
    let filled = tree.cells.iter().zip(&stored).filter(|(_, s)| s.is_some());
    let filled: BTreeSet<Cell> = filled.map(|(c, _)| *c).collect();
    let mut written = TilesWritten {
        contents: filled.len() as u64,
        bytes: stored.iter().flatten().map(|s| s.bytes).sum(),
        tilesets: 1,
        ..TilesWritten::default()
    };
    let levels = write_subtrees(&draft, tree, &filled, &mut written)?;
    let tileset = tileset(tree, options, root, levels, template);
    written.bytes += draft.publish(&tileset.to_json())?;
    Ok(written)
}

fn template(scheme: Scheme, folder: &str, extension: &str) -> String {
    let z = match scheme {
        Scheme::Quadtree => "",
        Scheme::Octree => "_{z}",
    };
    format!("{folder}/{{level}}/{{x}}_{{y}}{z}.{extension}")
}

fn check(tree: &CellTree, options: &TilesOptions) -> karui::Result<()> {
    let bad = |option, found: String, expected| {
        Err(karui::Error::BadOption {
            option,
            found,
            expected,
        })
    };
    if !(1..=8).contains(&tree.subtree_levels) {
        return bad("subtree_levels", tree.subtree_levels.to_string(), "1 to 8");
    }
    if options.volume != VolumeKind::Box {
        let found = format!("{:?}", options.volume);
        return bad("volume", found, "boxes for implicit tiling");
    }
    check_place(options)?;
    let near = [tree.min, tree.max].map(|p| p.abs().max_element() <= REACH && !p.is_nan());
    let finite = near == [true; 2] && tree.error.is_finite();
    if !finite || tree.error < 0.0 || !tree.min.cmplt(tree.max).all() {
        let found = format!("{} to {}, error {}", tree.min, tree.max, tree.error);
        return bad(
            "min, max, error",
            found,
            "within 1e15 m, min < max, error >= 0",
        );
    }
    let mut known = BTreeSet::new();
    for cell in &tree.cells {
        let flat = tree.scheme == Scheme::Quadtree && cell.z > 0;
        let deep = cell.level >= MAX_LEVEL;
        let largest = [cell.x, cell.y, cell.z].into_iter().max().unwrap_or(0);
        if flat || deep || u64::from(largest) >> cell.level > 0 || !known.insert(*cell) {
            let expected = "different cells with coordinates below 2^level, level below 31";
            return bad("cells", cell.to_string(), expected);
        }
    }
    if tree.cells.is_empty() {
        return Err(karui::Error::Empty { what: "cell tree" });
    }
    Ok(())
}

/// Contents have to lie in their cells.
fn contained(tree: &CellTree, root: Extent, stored: &[Option<Stored>]) -> karui::Result<()> {
    let size = root.max - root.min;
    // Coordinates far from the origin have been rounded before they came here.
    let far = tree.min.abs().max(tree.max.abs()).max_element();
    let slack = size.max_element() * ROUNDING + far * f64::from(f32::EPSILON);
    for (i, (cell, stored)) in tree.cells.iter().zip(stored).enumerate() {
        let Some(stored) = stored else { continue };
        let step = size / f64::from(cell.level).exp2();
        let at = DVec3::new(f64::from(cell.x), f64::from(cell.y), f64::from(cell.z));
        let min = root.min + at * step;
        let mut max = min + step;
        if tree.scheme == Scheme::Quadtree {
            max.z = root.max.z;
        }
        let allowed = Extent { min, max }.grown(slack);
        let inside = stored.extent.min.cmpge(allowed.min).all()
            && stored.extent.max.cmple(allowed.max).all();
        if !inside {
            return Err(karui::Error::BadOption {
                option: "content",
                found: format!("{} to {} in cell {i}", stored.extent.min, stored.extent.max),
                expected: "within its cell",
            });
        }
    }
    Ok(())
}

/// Writes all subtree files; returns the number of levels.
fn write_subtrees(
    draft: &Draft,
    tree: &CellTree,
    filled: &BTreeSet<Cell>,
    written: &mut TilesWritten,
) -> Result<u32> {
    let mut tiles = BTreeSet::from([Cell::ROOT]);
    for cell in filled {
        let mut up = *cell;
        while tiles.insert(up) && up.level > 0 {
            up = up.ancestor(1);
        }
    }
    let levels = tree.subtree_levels;
    let mut subtrees: BTreeMap<Cell, Vec<Cell>> = BTreeMap::new();
    for tile in &tiles {
        let root = tile.ancestor(tile.level % levels);
        subtrees.entry(root).or_default().push(*tile);
    }
    let template = template(tree.scheme, "subtrees", "subtree");
    for (root, members) in &subtrees {
        let child = |morton: &u64| {
            let below = root.descendant(tree.scheme, levels, *morton);
            subtrees.contains_key(&below)
        };
        let bytes = subtree(tree, members, filled, &child);
        written.bytes += draft.write(&root.fill(&template), &bytes)?;
        written.subtrees += 1;
    }
    written.tiles = tiles.len() as u64;
    Ok(tiles.last().map_or(1, |t| t.level + 1))
}

/// The bytes of a subtree file.
fn subtree(
    tree: &CellTree,
    members: &[Cell],
    filled: &BTreeSet<Cell>,
    child: &dyn Fn(&u64) -> bool,
) -> Vec<u8> {
    let (scheme, levels) = (tree.scheme, tree.subtree_levels);
    let number = |cell: &Cell| {
        let level = cell.level % levels;
        offset(scheme, level).unwrap_or(0) + cell.morton(scheme, level)
    };
    let tiles = bits(
        offset(scheme, levels).unwrap_or(0),
        members.iter().map(number),
    );
    let with = members.iter().filter(|m| filled.contains(m)).map(number);
    let contents = bits(offset(scheme, levels).unwrap_or(0), with);
    let below = cells(scheme, levels).unwrap_or(0);
    let children = bits(below, (0..below).filter(child));
    let mut binary = Vec::new();
    let mut views = Vec::new();
    let mut availability = |bits: &[u8]| {
        let count: u32 = bits.iter().map(|b| b.count_ones()).sum();
        if count == 0 {
            return json!({ "constant": 0, "availableCount": 0 });
        }
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bits.len() }));
        binary.extend(bits);
        binary.resize(binary.len().next_multiple_of(8), 0);
        json!({ "bitstream": views.len() - 1, "availableCount": count })
    };
    let mut json = json!({
        "tileAvailability": availability(&tiles),
        "contentAvailability": [availability(&contents)],
        "childSubtreeAvailability": availability(&children),
    });
    json["buffers"] = json!([{ "byteLength": binary.len() }]);
    json["bufferViews"] = json!(views);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(8), b' ');
    let mut file = b"subt\x01\0\0\0".to_vec();
    file.extend((text.len() as u64).to_le_bytes());
    file.extend((binary.len() as u64).to_le_bytes());
    [file, text, binary].concat()
}

fn bits(length: u64, set: impl Iterator<Item = u64>) -> Vec<u8> {
    let mut bytes = vec![0u8; length.div_ceil(8) as usize];
    for bit in set {
        bytes[(bit / 8) as usize] |= 1 << (bit % 8);
    }
    bytes
}

fn tileset(
    tree: &CellTree,
    options: &TilesOptions,
    root: Extent,
    levels: u32,
    content: String,
) -> Tileset {
    let origin = z_up(tree.min + (tree.max - tree.min) * 0.5, options.up);
    let moved = DMat4::from_translation(origin);
    let place = options.place.map(|p| p.ecef_from_east_north_up());
    let transform = place.unwrap_or(DMat4::IDENTITY) * moved;
    let implicit = ImplicitTiling {
        scheme: tree.scheme,
        subtree_levels: tree.subtree_levels,
        available_levels: levels,
        subtrees: template(tree.scheme, "subtrees", "subtree"),
        other: serde_json::Map::new(),
    };
    let tile = Tile {
        bounding_volume: BoundingVolume::from(root.shape(DVec3::ZERO)),
        geometric_error: tree.error,
        refine: Some(tree.refine),
        transform: (transform != DMat4::IDENTITY).then_some(transform),
        contents: vec![Content {
            uri: content,
            ..Content::default()
        }],
        implicit: Some(implicit),
        ..Tile::default()
    };
    Tileset {
        asset: asset(),
        // What is missing if not even the root is drawn: all of it.
        geometric_error: tree.error.max((tree.max - tree.min).length()),
        tiles: vec![tile],
        ..Tileset::default()
    }
}
