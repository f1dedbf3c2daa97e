//! `karui compare`: how different two models look, and how far they are apart.

mod page;

use super::measure;
use crate::console::Console;
use crate::eye::{Eye, differences};
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::output::Staged;
use crate::progress::check_cancelled;
use crate::table::{number, seconds, table};
use crate::text::legend;
use crate::textures;
use anyhow::Result;
use karui::metrics::image::{ImageDifference, PIXELS_PER_DEGREE, ViewDifferences, flip};
use karui::metrics::{SurfaceDistance, vertex_distances};
use karui::render::{Model, Paint, Picture, RenderOptions, Renderer, Scalar, heat_table};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Compare how two models look, and how far they are apart
///
/// Both are drawn from the same directions all around, under the same lights, with their own
/// textures, and the pictures compared: FLIP (Andersson et al. 2020), RMSE, PSNR and SSIM. Then
/// the distance between the surfaces, as `karui measure` has it.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The original
    a: PathBuf,
    /// The model to compare with it
    b: PathBuf,
    /// Folder for report.html, which holds all it shows, and the pictures as PNG: of the views
    /// that differ most, A, B, where they differ, and A's distance to B
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Directions to look from
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    views: u32,
    /// Pixels a side of each picture
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,
    /// Views in the report
    #[arg(long, value_name = "N", default_value_t = 3)]
    shown: usize,
    /// Face samples, and as many edge samples, of each surface
    #[arg(long, value_name = "N", default_value_t = 500_000)]
    samples: u64,
    /// Largest mean FLIP accepted; exit code 1 if it is exceeded
    #[arg(long, value_name = "FLIP")]
    max_flip: Option<f64>,
}

/// What was found.
struct Found {
    distance: SurfaceDistance,
    views: Vec<ImageDifference>,
    mean: ImageDifference,
    /// Numbers of the views that differ most, most first.
    worst: Vec<usize>,
}

/// Draws, compares, measures, writes, tells, then checks.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let staged = args.output.as_deref().map(Staged::in_directory);
    let staged = staged.transpose()?;
    let [a, b] = [&args.a, &args.b].map(|path| -> Result<Input> {
        let input = input::read(path, console)?;
        input.require_triangles()?;
        Ok(input)
    });
    let (a, b) = (a?, b?);
    let images = [&a, &b].map(|input| textures::decode(input, console));
    let models =
        [(&a, &images[0]), (&b, &images[1])].map(|(i, own)| Model::of_scene(&i.scene, own));
    let bounds = Renderer::of_model(&models[0])?.bounds();
    let eye = Eye::new(bounds, args.views, args.size);
    let (seen_a, seen_b) = (eye.pictures(&models[0])?, eye.pictures(&models[1])?);
    check_cancelled()?;
    let views = differences(&seen_a, &seen_b)?;
    let [a, b] = [&args.a, &args.b].map(|path| measure::mesh(path, console));
    let (a, b) = (a?, b?);
    let distance = measure::distance(&a, &b, (args.samples, 0), console)?;
    let found = Found::of(distance, views);
    let files = match staged {
        Some(staged) => {
            let looks = found.worst.iter().take(args.shown).map(|&view| {
                let (camera, pair) = (&eye.cameras[view], [&seen_a[view], &seen_b[view]]);
                let flip = flip(pair[0], pair[1], PIXELS_PER_DEGREE)?.picture()?;
                let far = distance_picture(&eye, camera, (&a, &b))?;
                Ok((view, [pair[0].clone(), pair[1].clone(), flip, far]))
            });
            let looks = looks.collect::<Result<Vec<_>>>()?;
            page::write(&staged, args, &found, &looks)?;
            staged.publish()?
        }
        None => Vec::new(),
    };
    console.data(&found.text())?;
    console.document(&found.document(args, &files))?;
    console.summary(&found.summary(args, console))?;
    found.check(args)
}

/// `a`, coloured by its distance to `b`.
fn distance_picture(
    eye: &Eye,
    camera: &karui::geom::Camera,
    (a, b): (&karui::TriMesh, &karui::TriMesh),
) -> Result<Picture> {
    let distances = vertex_distances(a, b)?;
    let high = distances.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let map = heat_table();
    let values = [distances.as_slice()];
    let options = RenderOptions {
        paint: Paint::Scalar(Scalar {
            values: &values,
            low: 0.0,
            high,
            map: &map,
        }),
        ..*eye.options()
    };
    let mut picture = eye.picture(&Renderer::of_mesh(a)?, camera, &options)?;
    let ends = ["0", &number(high.into())];
    legend(
        &mut picture,
        ends,
        "distance, model units",
        options.background,
    );
    Ok(picture)
}

impl Found {
    fn of(distance: SurfaceDistance, views: Vec<ImageDifference>) -> Self {
        let mut sum = ViewDifferences::default();
        views.iter().for_each(|view| sum.add(view));
        let mut worst: Vec<usize> = (0..views.len()).collect();
        worst.sort_by(|&i, &j| views[j].flip.total_cmp(&views[i].flip));
        // There is one view at least.
        let mean = sum.mean().unwrap_or(views[0]);
        Self {
            distance,
            views,
            mean,
            worst,
        }
    }

    fn text(&self) -> String {
        format!("{}\n\n{}", measure::text(&self.distance), self.looks())
    }

    /// Mean and worst view.
    fn looks(&self) -> String {
        let row = |name: String, d: &ImageDifference| {
            vec![
                name,
                number(d.flip),
                number(d.rmse),
                decibels(d.psnr),
                number(d.ssim),
            ]
        };
        let worst = self.worst[0];
        let rows = [
            row(format!("mean of {} views", self.views.len()), &self.mean),
            row(format!("worst, view {worst}"), &self.views[worst]),
        ];
        table(&["", "FLIP", "RMSE", "PSNR, dB", "SSIM"], &rows, false)
    }

    fn summary(&self, args: &Args, console: &Console) -> String {
        let mut line = format!(
            "FLIP {}, farthest {} of the diagonal; {}",
            number(self.mean.flip),
            crate::table::percent(self.distance.max() / self.distance.diagonal),
            seconds(console.elapsed())
        );
        if let Some(folder) = &args.output {
            line = format!("{}: {line}", folder.join("report.html").display());
        }
        line
    }

    fn document(&self, args: &Args, files: &[PathBuf]) -> Value {
        let of = |d: &ImageDifference| {
            // Equal pictures have no PSNR that JSON could hold.
            let psnr = d.psnr.is_finite().then_some(d.psnr);
            json!({ "flip": d.flip, "rmse": d.rmse, "psnr": psnr, "ssim": d.ssim })
        };
        let distance = &self.distance;
        json!({
            "a": args.a, "b": args.b, "size": args.size, "files": files,
            "mean": of(&self.mean), "views": self.views.iter().map(of).collect::<Vec<_>>(),
            "distance": {
                "max": distance.max(), "mean": distance.mean(), "rms": distance.rms(),
                "diagonal": distance.diagonal,
            },
        })
    }

    fn check(&self, args: &Args) -> Result<()> {
        match args.max_flip {
            Some(most) if self.mean.flip.is_nan() || self.mean.flip > most => {
                let (found, most) = (number(self.mean.flip), number(most));
                Err(Failure::check(format!("the mean FLIP {found} exceeds {most}")).into())
            }
            _ => Ok(()),
        }
    }
}

fn decibels(psnr: f64) -> String {
    match psnr.is_finite() {
        true => number(psnr),
        false => "equal".into(),
    }
}
