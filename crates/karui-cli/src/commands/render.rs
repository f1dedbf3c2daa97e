//! `karui render`: pictures of models.

use super::measure;
use crate::args::PictureArgs;
use crate::console::Console;
use crate::eye::require_placed;
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::output::Staged;
use crate::progress::check_cancelled;
use crate::sheet::Layout;
use crate::table::{bytes, count, percent, seconds};
use crate::textures;
use anyhow::Result;
use karui::geom::{Aabb, Light};
use karui::render::{MAX_SIDE, Model, Picture, Renderer};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Draw models into a PNG
///
/// One model makes a picture; several make a sheet, up to four in a row, each with its name and
/// triangles below, all seen by the camera that has the first one in view: levels compare. The
/// same pixels on every machine, whatever the number of threads.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The models
    #[arg(required = true, value_name = "MODEL")]
    inputs: Vec<PathBuf>,
    /// The PNG to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Write N pictures from all around, the first where the camera is: FILE-000.png and so on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    turntable: Option<u32>,
    /// Also say below each model but the first how far it is from the first: the two-sided RMS
    /// distance, as a share of the first one's diagonal
    #[arg(long)]
    errors: bool,
    #[command(flatten)]
    picture: PictureArgs,
}

/// A model with its images.
struct Shown {
    input: Input,
    images: Vec<Option<Picture>>,
    /// RMS distance to the first model, as a share of its diagonal; none if not asked for.
    error: Option<f64>,
}

/// Reads, draws, then writes all or nothing.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let stem = stem(&args.output)?;
    let layout = Layout::new(args.inputs.len(), args.picture.size);
    let size = sheet_size(args, layout)?;
    let read = args.inputs.iter().map(|path| shown(path, args, console));
    let mut models = read.collect::<Result<Vec<_>>>()?;
    if args.errors {
        measure_all(&mut models, console)?;
    }
    let renderers = models.iter().map(renderer).collect::<Result<Vec<_>>>()?;
    let staged = Staged::beside(&args.output)?;
    let progress = console.progress();
    let mut written = 0;
    let names = names(args, &stem);
    for (i, name) in names.iter().enumerate() {
        check_cancelled()?;
        progress.report("draw", i as f32 / names.len() as f32);
        let turn = 360.0 * i as f64 / names.len() as f64;
        let png = karui_io::encode_png(&frame(args, layout, &models, &renderers, turn)?)?;
        staged.bytes(name, &png)?;
        written += png.len() as u64;
    }
    drop(progress);
    let files = staged.publish()?;
    console.summary(&format!(
        "{}: {} x {} pixels, {} triangles, {}; {}",
        said(&files),
        size.0,
        size.1,
        count(models.iter().map(|m| m.input.scene.triangle_count()).sum()),
        bytes(written),
        seconds(console.elapsed()),
    ))?;
    console.document(&json!({
        "models": models.iter().map(Shown::document).collect::<Vec<_>>(),
        "files": files, "bytes": written, "width": size.0, "height": size.1,
    }))
}

fn shown(path: &Path, args: &Args, console: &Console) -> Result<Shown> {
    let input = input::read(path, console)?;
    input.require_triangles()?;
    let images = match args.picture.shows_textures() {
        true => textures::decode(&input, console),
        false => Vec::new(),
    };
    Ok(Shown {
        input,
        images,
        error: None,
    })
}

/// Samples of either kind of each surface.
const SAMPLES: u64 = 500_000;

/// How far every model but the first is from the first.
fn measure_all(models: &mut [Shown], console: &Console) -> Result<()> {
    let Some((first, rest)) = models.split_first_mut() else {
        return Ok(());
    };
    let original = measure::mesh(&first.input.path, console)?;
    for model in rest {
        let mesh = measure::mesh(&model.input.path, console)?;
        let distance = measure::distance(&original, &mesh, (SAMPLES, 0), console)?;
        model.error = Some(distance.rms() / distance.diagonal);
    }
    Ok(())
}

fn renderer(shown: &Shown) -> Result<Renderer<'_>> {
    let model = Model::of_scene(&shown.input.scene, &shown.images);
    let renderer = Renderer::of_model(&model)?;
    require_placed(&renderer, &shown.input.path)?;
    Ok(renderer)
}

/// What one file shows.
fn frame(
    args: &Args,
    layout: Layout,
    models: &[Shown],
    renderers: &[Renderer<'_>],
    turn: f64,
) -> Result<Picture> {
    let options = args.picture.resolve();
    let bounds = renderers.first().map_or(Aabb::EMPTY, Renderer::bounds);
    let camera = args.picture.camera(bounds, turn);
    let lights = Light::three_points(&camera)?;
    let mut tiles = Vec::new();
    for (model, renderer) in models.iter().zip(renderers) {
        check_cancelled()?;
        let frame = renderer.frame(&camera, &lights, &options)?;
        tiles.push((frame.color, model.caption()));
    }
    Ok(match tiles.len() {
        1 => tiles.swap_remove(0).0,
        _ => layout.draw(&tiles, options.background),
    })
}

impl Shown {
    fn caption(&self) -> String {
        let name = self.input.path.file_name().unwrap_or_default();
        let triangles = count(self.input.scene.triangle_count());
        let name = name.to_string_lossy();
        match self.error {
            Some(error) => format!("{name}  {triangles} triangles  RMS {}", percent(error)),
            None => format!("{name}  {triangles} triangles"),
        }
    }

    fn document(&self) -> Value {
        let decoded = self.images.iter().flatten().count();
        json!({
            "path": self.input.path,
            "triangles": self.input.scene.triangle_count(),
            "rms_of_diagonal": self.error,
            "images": { "decoded": decoded, "missing": self.images.len() - decoded },
        })
    }
}

/// Width and height of what is written, if that can be.
fn sheet_size(args: &Args, layout: Layout) -> Result<(u64, u64)> {
    let (width, height) = match args.inputs.len() {
        1 => (args.picture.size.0.into(), args.picture.size.1.into()),
        _ => layout.size(),
    };
    if width.max(height) <= MAX_SIDE.into() {
        return Ok((width, height));
    }
    let message = format!("the sheet has {width} x {height} pixels; a side has up to {MAX_SIDE}");
    let hint = "choose a smaller --size; it is that of each tile";
    Err(Failure::input(message).hint(hint).into())
}

/// The name of the output without `.png`.
pub(super) fn stem(output: &Path) -> Result<String> {
    let is_png = output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"));
    let stem = output.file_stem().and_then(|s| s.to_str());
    match stem {
        Some(stem) if is_png => Ok(stem.to_owned()),
        _ => {
            let message = format!("{}: pictures are written as PNG", output.display());
            Err(Failure::input(message).hint("name the output .png").into())
        }
    }
}

/// The files to be written, in order.
fn names(args: &Args, stem: &str) -> Vec<String> {
    match args.turntable {
        None => {
            let name = args.output.file_name().unwrap_or_default();
            vec![name.to_string_lossy().into_owned()]
        }
        // As many digits for all, so that names sort as the frames do.
        Some(frames) => {
            let digits = (frames - 1).to_string().len().max(3);
            (0..frames)
                .map(|i| format!("{stem}-{i:0digits$}.png"))
                .collect()
        }
    }
}

fn said(files: &[PathBuf]) -> String {
    match files {
        [first, .., last] => {
            let (n, first, last) = (files.len(), first.display(), last.display());
            format!("{n} pictures, {first} to {last}")
        }
        [one] => one.display().to_string(),
        [] => String::new(),
    }
}
