//! `karui tiles`: a scene as 3D Tiles.

mod large;

use crate::args::WriteArgs;
use crate::console::Console;
use crate::input::{self, Input};
use crate::outofcore::{self, told_of_files};
use crate::table::{bytes, count, number, seconds};
use crate::textures;
use anyhow::Result;
use karui::hlod::TreeOptions;
use karui::hlod::proxy::{ChooseOptions, ImpostorOptions, ProxyKind};
use karui::hlod::tiles::{Hlod, HlodOptions, TileContent};
use karui_io::ErrorKind;
use karui_io::tiles::{
    Geodetic, TilesOptions, TilesWritten, Up, VolumeKind, may_write, write_hlod,
};
use serde::Serialize;
use std::path::PathBuf;

/// Write a scene as 3D Tiles 1.1
///
/// Objects that look like one thing become groups, groups become tiles. A tile shows its objects,
/// as instances of their meshes; from farther off their coarsest levels; then one stand-in for
/// all that is in it: the first of a box, pictures on crossed cards, and the objects merged and
/// simplified that looks the same. Geometric errors are measured, in metres, taking the
/// scene's unit as one. Every tile knows its objects, stand-ins too.
///
/// With --memory-limit, one mesh of any size instead: it is read in slices and cut into cells;
/// each cell shows its triangles, simplified more the larger it is.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene
    input: PathBuf,
    /// The folder to make, or an s3://, gs:// or az:// URL (of a karui built with `--features
    /// cloud`); the tileset is its tileset.json, which is put last
    #[arg(short, long, value_name = "PLACE")]
    output: PathBuf,
    /// Replace a tileset that Karui wrote
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    place: PlaceArgs,
    #[command(flatten)]
    cut: CutArgs,
    #[command(flatten)]
    large: large::LargeArgs,
    #[command(flatten)]
    write: WriteArgs,
}

/// Where it stands.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Place")]
struct PlaceArgs {
    /// Latitude of the scene's origin, degrees [default: nowhere on the Earth]
    #[arg(
        long,
        value_name = "DEG",
        requires = "lon",
        allow_negative_numbers = true
    )]
    lat: Option<f64>,
    /// Longitude of the scene's origin, degrees
    #[arg(
        long,
        value_name = "DEG",
        requires = "lat",
        allow_negative_numbers = true
    )]
    lon: Option<f64>,
    /// Height of the scene's origin above the ellipsoid, metres
    #[arg(
        long,
        value_name = "M",
        default_value_t = 0.0,
        requires = "lat",
        allow_negative_numbers = true
    )]
    height: f64,
    /// Which axis of the scene points up
    #[arg(long, value_enum, default_value_t = UpArg::Y)]
    up: UpArg,
    /// Kind of bounding volumes; regions need a place
    #[arg(long, value_enum, default_value_t = VolumeArg::Box)]
    volume: VolumeArg,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum UpArg {
    Y,
    Z,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum VolumeArg {
    Box,
    Sphere,
    Region,
}

/// How it is cut into tiles.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Tiles")]
struct CutArgs {
    /// What makes objects one group
    #[arg(long, value_enum, default_value_t = Grouping::ScaleFree)]
    grouping: Grouping,
    /// Most triangles of the objects of a tile; with --memory-limit, of any tile, about
    #[arg(long, value_name = "COUNT", default_value_t = HlodOptions::default().triangles)]
    triangles: usize,
    /// Most triangles of a stand-in
    #[arg(long, value_name = "COUNT", default_value_t = HlodOptions::default().stand_in)]
    stand_in: usize,
    /// Kinds of stand-ins to choose from
    #[arg(long, value_enum, value_delimiter = ',', value_name = "KIND",
          default_values_t = [Kind::Box, Kind::Cards, Kind::Merged])]
    kinds: Vec<Kind>,
    /// Largest mean FLIP between a stand-in and what it stands for, 0 to 1
    #[arg(long, value_name = "FLIP", default_value_t = ChooseOptions::default().tolerance)]
    tolerance: f64,
    /// Largest error of a stand-in when it is switched in, pixels; if none keeps to it, the one
    /// with the least is taken
    #[arg(long, value_name = "PX", default_value_t = HlodOptions::default().choose.error)]
    error: f64,
    /// Pixels that a group covers when its stand-in is switched in: what textures and cards
    /// are made for
    #[arg(long, value_name = "PX", default_value_t = HlodOptions::default().choose.pixels)]
    pixels: u32,
    /// Tiles of one tileset file
    #[arg(long, value_name = "COUNT", default_value_t = TilesOptions::default().tiles_per_file)]
    tiles_per_file: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Grouping {
    /// Lengths relative to the sizes of what is grouped
    ScaleFree,
    /// Weights, thresholds and units of Kato, Kanoh, Nishihara, 1998
    Kato1998,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    Box,
    Cards,
    Merged,
}

impl PlaceArgs {
    fn resolve(&self, args: &Args) -> TilesOptions {
        let place = self.lat.zip(self.lon);
        TilesOptions {
            up: match self.up {
                UpArg::Y => Up::Y,
                UpArg::Z => Up::Z,
            },
            volume: match self.volume {
                VolumeArg::Box => VolumeKind::Box,
                VolumeArg::Sphere => VolumeKind::Sphere,
                VolumeArg::Region => VolumeKind::Region,
            },
            place: place.map(|(lat, lon)| Geodetic::from_degrees(lat, lon, self.height)),
            tiles_per_file: args.cut.tiles_per_file,
            overwrite: args.overwrite,
            gltf: args.write.resolve().gltf,
        }
    }
}

impl CutArgs {
    fn choose(&self, up: Up) -> ChooseOptions<'static> {
        let all = HlodOptions::default().choose;
        let has = |kind| self.kinds.contains(&kind);
        let cards = ImpostorOptions {
            up: match up {
                Up::Y => glam::Vec3::Y,
                Up::Z => glam::Vec3::Z,
            },
            ..ImpostorOptions::default()
        };
        ChooseOptions {
            tolerance: self.tolerance,
            error: self.error,
            pixels: self.pixels,
            solid: all.solid.filter(|_| has(Kind::Box)),
            cards: has(Kind::Cards).then_some(cards),
            merged: all.merged.filter(|_| has(Kind::Merged)),
            ..all
        }
    }

    fn tree(&self) -> TreeOptions<'static> {
        match self.grouping {
            Grouping::ScaleFree => TreeOptions::default(),
            Grouping::Kato1998 => TreeOptions::kato1998(),
        }
    }
}

/// Makes the tiles.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let options = args.place.resolve(args);
    outofcore::known(&args.output)?;
    may_write(&args.output, args.overwrite).map_err(told_of_files)?;
    if let Some(memory) = args.large.memory_limit {
        return large::run(args, memory, &options, console);
    }
    let input = input::read(&args.input, console)?;
    input.require_triangles()?;
    let images = textures::decode(&input, console);
    let progress = console.progress();
    let refused = |error| karui_io::Error::file(&args.input, ErrorKind::Geometry(error));
    let hlod = Hlod::build(
        &input.scene,
        &images,
        &HlodOptions {
            tree: args.cut.tree(),
            triangles: args.cut.triangles,
            stand_in: args.cut.stand_in,
            choose: args.cut.choose(options.up),
            progress: &*progress,
            ..HlodOptions::default()
        },
    )
    .map_err(refused)?;
    let written = write_hlod(&args.output, &hlod, &options, &*progress);
    let written = written.map_err(told_of_files)?;
    drop(progress);
    report(args, &input, &hlod, &written, console)
}

/// What was made.
#[derive(Debug, Default, Serialize)]
struct Made {
    objects: usize,
    groups: usize,
    /// Tiles of each kind.
    tiles: Kinds,
    root_triangles: usize,
    /// Metres.
    root_error: f64,
}

#[derive(Debug, Default, Serialize)]
struct Kinds {
    objects: usize,
    coarsest: usize,
    boxes: usize,
    cards: usize,
    merged: usize,
    nothing: usize,
}

impl Made {
    fn of(hlod: &Hlod<'_>) -> Self {
        let root = hlod.tiles().first();
        let mut made = Self {
            objects: hlod.object_count(),
            groups: hlod.tree().group_count(),
            root_triangles: root.map_or(0, |t| t.triangles),
            root_error: root.map_or(0.0, |t| t.error),
            tiles: Kinds::default(),
        };
        for tile in hlod.tiles() {
            *match &tile.content {
                TileContent::Objects(_) => &mut made.tiles.objects,
                TileContent::Coarse(_) => &mut made.tiles.coarsest,
                TileContent::Nothing => &mut made.tiles.nothing,
                TileContent::Proxy(proxy) => match proxy.kind {
                    ProxyKind::Box => &mut made.tiles.boxes,
                    ProxyKind::Impostor => &mut made.tiles.cards,
                    ProxyKind::Merged => &mut made.tiles.merged,
                },
            } += 1;
        }
        made
    }
}

fn report(
    args: &Args,
    input: &Input,
    hlod: &Hlod<'_>,
    written: &TilesWritten,
    console: &Console,
) -> Result<()> {
    let made = Made::of(hlod);
    let tiles = &made.tiles;
    let stand_ins = tiles.boxes + tiles.cards + tiles.merged;
    console.summary(&format!(
        "{}: {} tiles of {} objects, {} with stand-ins ({} boxes, {} cards, {} merged), {}; \
         coarsest {} triangles, off by at most {} m; {}",
        args.output.display(),
        count(written.tiles as usize),
        count(made.objects),
        count(stand_ins),
        count(tiles.boxes),
        count(tiles.cards),
        count(tiles.merged),
        bytes(written.bytes),
        count(made.root_triangles),
        number(made.root_error),
        seconds(console.elapsed()),
    ))?;
    console.document(&serde_json::json!({
        "input": input.path,
        "output": args.output,
        "made": made,
        "written": written,
    }))
}
