//! A tree of tiles written as a tileset.

use super::{
    extent::{self, Extent},
    model::{Asset, BoundingVolume, Content, Region, Shape, Tile, Tileset},
    publish::{Draft, signature},
    split::split,
    tree::{TileContents, TileTree, TilesOptions, TilesWritten, Up, VolumeKind},
    write_content::{Order, Stored, write_contents},
};
use crate::error::{Error, Result};
use glam::{DMat4, DVec3};
use karui::{Progress, Silent};
use std::path::Path;

/// Largest latitude of a region that is written, radians: at the poles
/// longitudes say nothing.
const POLE: f64 = 1.55;
/// Largest coordinate, metres: a hundred light hours, with a metre kept.
pub(super) const REACH: f64 = 1e15;

/// Writes a tree of tiles with explicit tiling into a new folder: the root in
/// `tileset.json`, contents below `content/`, large branches in external
/// tilesets below `tilesets/`. The folder appears when all of it is complete,
/// and is the same for any number of threads.
///
/// Volumes enclose contents as they are stored and those of all children;
/// errors are raised to those of children.
///
/// # Errors
/// [`Geometry`](crate::ErrorKind::Geometry) if the tree or an option is not as
/// documented, or a content is not valid; [`Io`](crate::ErrorKind::Io) if the
/// folder cannot be written or holds something that must not be replaced; and
/// whatever `contents` fails with.
pub fn write(
    folder: impl AsRef<Path>,
    tree: &TileTree,
    contents: &dyn TileContents,
    options: &TilesOptions,
) -> Result<TilesWritten> {
    write_with_progress(folder, tree, contents, options, &Silent)
}

/// [`write()`] with an observer (stage `contents`).
///
/// # Errors
/// As [`write()`]; and [`karui::Error::Cancelled`] if the observer says so.
pub fn write_with_progress(
    folder: impl AsRef<Path>,
    tree: &TileTree,
    contents: &dyn TileContents,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<TilesWritten> {
    let folder = folder.as_ref();
    run(folder, tree, contents, options, progress).map_err(|e| e.in_file(folder))
}

fn run(
    folder: &Path,
    tree: &TileTree,
    contents: &dyn TileContents,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<TilesWritten> {
    check(tree, options).map_err(|e| Error::file(folder, e.into()))?;
    let draft = Draft::new(folder, options.overwrite)?;
    let orders: Vec<Order> = (0..tree.nodes.len()).map(|n| order(tree, n)).collect();
    let stored = write_contents(&draft, &orders, contents, options, progress)?;
    let mut plan = Plan::new(tree, options, &orders, &stored);
    plan.enclose();
    plan.volumes().map_err(|e| Error::file(folder, e.into()))?;
    let mut written = TilesWritten {
        tiles: tree.nodes.len() as u64,
        contents: stored.iter().flatten().count() as u64,
        bytes: stored.iter().flatten().map(|s| s.bytes).sum(),
        raised_errors: plan.raised,
        ..TilesWritten::default()
    };
    let root = plan.write(&draft, &mut written)?;
    written.bytes += draft.publish(&root)?;
    Ok(written)
}

fn bad(option: &'static str, found: String, expected: &'static str) -> karui::Error {
    karui::Error::BadOption {
        option,
        found,
        expected,
    }
}

/// What has to hold of the input.
fn check(tree: &TileTree, options: &TilesOptions) -> karui::Result<()> {
    if tree.nodes.is_empty() {
        return Err(karui::Error::Empty { what: "tile tree" });
    }
    if options.tiles_per_file < 2 {
        let found = options.tiles_per_file.to_string();
        return Err(bad("tiles_per_file", found, "at least 2"));
    }
    check_place(options)?;
    for (n, node) in tree.nodes.iter().enumerate() {
        let parent_first = node.parent.map_or(n == 0, |p| (p as usize) < n);
        if !parent_first {
            return Err(karui::Error::BadReference {
                what: "tile",
                index: n,
                target: "tile",
                to: node.parent.map_or(0, |p| p as usize),
                problem: "is no earlier tile",
            });
        }
        let near = [node.min, node.max].map(|p| p.abs().max_element() <= REACH && !p.is_nan());
        let finite = near == [true; 2] && node.error.is_finite();
        if !finite || node.error < 0.0 || node.min.cmpgt(node.max).any() {
            let found = format!(
                "{} to {}, error {}, of tile {n}",
                node.min, node.max, node.error
            );
            return Err(bad("nodes", found, "within 1e15 m, min <= max, error >= 0"));
        }
    }
    Ok(())
}

pub(super) fn check_place(options: &TilesOptions) -> karui::Result<()> {
    let Some(place) = options.place else {
        if options.volume == VolumeKind::Region {
            return Err(bad(
                "place",
                "None".into(),
                "a place on the earth for regions",
            ));
        }
        return Ok(());
    };
    let finite = place.lon.is_finite() && place.height.is_finite();
    if !finite || place.lat.is_nan() || place.lat.abs() > std::f64::consts::FRAC_PI_2 {
        let expected = "finite, with a latitude of at most 90 degrees";
        return Err(bad("place", format!("{place:?}"), expected));
    }
    Ok(())
}

/// A point of the input with z up.
pub(super) fn z_up(p: DVec3, up: Up) -> DVec3 {
    match up {
        Up::Z => p,
        Up::Y => DVec3::new(p.x, -p.z, p.y),
    }
}

/// A box of the input with z up.
pub(super) fn z_up_extent(min: DVec3, max: DVec3, up: Up) -> Extent {
    Extent::EMPTY.with(z_up(min, up)).with(z_up(max, up))
}

/// A content and the origin of its tile: the middle of the node.
fn order(tree: &TileTree, n: usize) -> Order {
    let node = &tree.nodes[n];
    Order {
        node: n as u32,
        origin: node.min + (node.max - node.min) * 0.5,
        name: format!("content/{}/{n}.glb", n / 1024),
    }
}

/// The tileset as it is going to be.
struct Plan<'a> {
    tree: &'a TileTree,
    options: &'a TilesOptions,
    orders: &'a [Order],
    stored: &'a [Option<Stored>],
    /// Origins of the frames of the tiles, z up.
    origins: Vec<DVec3>,
    /// Around everything at and below each tile, z up.
    extents: Vec<Extent>,
    errors: Vec<f64>,
    raised: u64,
    shapes: Vec<Shape>,
}

impl<'a> Plan<'a> {
    fn new(
        tree: &'a TileTree,
        options: &'a TilesOptions,
        orders: &'a [Order],
        stored: &'a [Option<Stored>],
    ) -> Self {
        let origins: Vec<DVec3> = orders.iter().map(|o| z_up(o.origin, options.up)).collect();
        let extent = |n: usize| {
            let node = &tree.nodes[n];
            let given = z_up_extent(node.min, node.max, options.up);
            let found = stored[n].map_or(Extent::EMPTY, |s| s.extent.moved(origins[n]));
            given.union(found)
        };
        Self {
            extents: (0..tree.nodes.len()).map(extent).collect(),
            errors: tree.nodes.iter().map(|n| n.error).collect(),
            raised: 0,
            shapes: Vec::new(),
            tree,
            options,
            orders,
            stored,
            origins,
        }
    }

    /// Lets every tile enclose those below, and have no smaller error.
    fn enclose(&mut self) {
        let own = self.errors.clone();
        for n in (1..self.tree.nodes.len()).rev() {
            if let Some(parent) = self.tree.nodes[n].parent.map(|p| p as usize) {
                self.extents[parent] = self.extents[parent].union(self.extents[n]);
                self.errors[parent] = self.errors[parent].max(self.errors[n]);
            }
        }
        let pairs = own.iter().zip(&self.errors);
        self.raised = pairs.filter(|(own, now)| now > own).count() as u64;
    }

    /// Bounding volumes in the frames of their tiles.
    fn volumes(&mut self) -> karui::Result<()> {
        let boxes = || self.extents.iter().zip(&self.origins);
        self.shapes = match self.options.volume {
            VolumeKind::Box => boxes().map(|(e, o)| e.shape(*o)).collect(),
            VolumeKind::Sphere => self.spheres(),
            VolumeKind::Region => self.regions()?,
        };
        Ok(())
    }

    fn spheres(&self) -> Vec<Shape> {
        let count = self.tree.nodes.len();
        let mut below: Vec<Vec<(DVec3, f64)>> = vec![Vec::new(); count];
        let mut spheres = vec![(DVec3::ZERO, 0.0); count];
        for n in (0..count).rev() {
            spheres[n] = extent::sphere(self.extents[n], &std::mem::take(&mut below[n]));
            if let Some(parent) = self.tree.nodes[n].parent {
                below[parent as usize].push(spheres[n]);
            }
        }
        let shape = |((center, radius), origin): ((DVec3, f64), &DVec3)| Shape::Sphere {
            center: center - *origin,
            radius,
        };
        spheres.into_iter().zip(&self.origins).map(shape).collect()
    }

    fn regions(&self) -> karui::Result<Vec<Shape>> {
        let Some(place) = self.options.place else {
            return Ok(Vec::new());
        };
        let ecef_from_scene = place.ecef_from_east_north_up();
        let own = |e: &Extent| extent::region(*e, &ecef_from_scene, place);
        let mut regions: Vec<Region> = self.extents.iter().map(own).collect();
        for n in (1..regions.len()).rev() {
            if let Some(parent) = self.tree.nodes[n].parent.map(|p| p as usize) {
                regions[parent] = extent::union(regions[parent], regions[n]);
            }
        }
        let root = regions[0];
        let wide = root.east - root.west > std::f64::consts::PI;
        if wide || root.north > POLE || root.south < -POLE {
            let found = format!("latitudes {} to {} radians", root.south, root.north);
            return Err(bad(
                "volume",
                found,
                "boxes or spheres at a pole or around the earth",
            ));
        }
        Ok(regions
            .into_iter()
            .map(|r| Shape::Region(extent::wrapped(r)))
            .collect())
    }

    /// Writes all tileset files but the root's, whose text is given back.
    fn write(&self, draft: &Draft, written: &mut TilesWritten) -> Result<Vec<u8>> {
        let parents: Vec<Option<u32>> = self.tree.nodes.iter().map(|n| n.parent).collect();
        let alone = split(&parents, self.options.tiles_per_file);
        let mut files: Vec<Tileset> = Vec::new();
        // File and place in it of every node's tile.
        let mut places: Vec<(usize, u32)> = Vec::with_capacity(parents.len());
        for n in 0..parents.len() {
            let above = parents[n].map(|p| places[p as usize]);
            let place = match (above, alone[n]) {
                (Some((file, tile)), false) => {
                    push(&mut files[file], self.tile(n, Some(tile), file > 0))
                        .map(|tile| (file, tile))
                }
                (above, _) => {
                    if let Some((file, tile)) = above {
                        push(
                            &mut files[file],
                            self.stub(n, tile, files_name(n), file > 0),
                        );
                    }
                    files.push(self.frame(n));
                    let file = files.len() - 1;
                    push(&mut files[file], self.tile(n, None, file > 0)).map(|tile| (file, tile))
                }
            };
            places.push(place.unwrap_or_default());
        }
        let mut roots = (0..parents.len()).filter(|&n| alone[n]);
        let mut root = Vec::new();
        for tileset in &files {
            let text = tileset.to_json();
            match roots.next() {
                Some(n) if n > 0 => {
                    let name = format!("tilesets/{}", files_name(n));
                    written.bytes += draft.write(&name, &text)?;
                }
                _ => root = text,
            }
            written.tilesets += 1;
        }
        Ok(root)
    }

    fn frame(&self, n: usize) -> Tileset {
        // What is missing if not even the root is drawn: all of it. A client draws no
        // tile of a tileset whose own error cannot be seen.
        let extent = self.extents[n];
        let all = (extent.max - extent.min).length();
        Tileset {
            asset: asset(),
            geometric_error: self.errors[n].max(if all.is_finite() { all } else { 0.0 }),
            ..Tileset::default()
        }
    }

    /// The tile of a node. That of an external tileset's root stands where
    /// its stub does, so it has no transform of its own.
    fn tile(&self, n: usize, parent: Option<u32>, external: bool) -> Tile {
        let content = self.stored[n].map(|_| {
            let up = if external { "../" } else { "" };
            Content {
                uri: format!("{up}{}", self.orders[n].name),
                ..Content::default()
            }
        });
        let transform = match (parent, external) {
            (None, true) => None,
            _ => self.transform(n),
        };
        Tile {
            parent,
            bounding_volume: BoundingVolume::from(self.shapes[n]),
            geometric_error: self.errors[n],
            refine: Some(self.tree.nodes[n].refine),
            transform,
            contents: content.into_iter().collect(),
            ..Tile::default()
        }
    }

    /// The tile that names the file of a node's branch.
    fn stub(&self, n: usize, parent: u32, name: String, external: bool) -> Tile {
        let folder = if external { "" } else { "tilesets/" };
        Tile {
            contents: vec![Content {
                uri: format!("{folder}{name}"),
                ..Content::default()
            }],
            transform: self.transform(n),
            ..self.tile(n, Some(parent), external)
        }
    }

    /// Takes the frame of a node to that of its parent, or of the root to the
    /// earth.
    fn transform(&self, n: usize) -> Option<DMat4> {
        let parent = self.tree.nodes[n].parent;
        let offset = self.origins[n] - parent.map_or(DVec3::ZERO, |p| self.origins[p as usize]);
        let moved = DMat4::from_translation(offset);
        let matrix = match (parent, self.options.place) {
            (None, Some(place)) => place.ecef_from_east_north_up() * moved,
            _ => moved,
        };
        (matrix != DMat4::IDENTITY).then_some(matrix)
    }
}

pub(super) fn asset() -> Asset {
    let mut asset = Asset {
        version: "1.1".to_owned(),
        ..Asset::default()
    };
    asset.other.insert("extras".to_owned(), signature());
    asset
}

fn files_name(n: usize) -> String {
    format!("{n}.json")
}

/// Adds a tile to a file; its index there.
fn push(tileset: &mut Tileset, tile: Tile) -> Option<u32> {
    let index = tileset.tiles.len() as u32;
    if let Some(parent) = tile.parent {
        tileset.tiles[parent as usize].children.push(index);
    }
    tileset.tiles.push(tile);
    Some(index)
}
