//! `karui bench saliency`: whether saliency helps, by distance and in pictures.

mod report;

use super::page::{Page, tell};
use crate::console::{Console, to_stderr};
use crate::eye::{Eye, differences};
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::progress::check_cancelled;
use crate::saliency::{self, Kind};
use crate::table::seconds;
use crate::textures;
use anyhow::Result;
use karui::geom::area;
use karui::lod::{Levels, LodOptions, chain_scene};
use karui::metrics::image::ViewDifferences;
use karui::metrics::{Samples, Surface, SurfaceDistanceOptions, directed_distance};
use karui::render::{Model, Picture, Renderer};
use karui::saliency::WeightMap;
use karui::simplify::Stop;
use karui::{Scene, TriMesh};
use report::{Row, Times};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Simplify with and without saliency and compare what comes out
///
/// Every model is brought down to the same numbers of triangles, plainly and weighted with each
/// kind of saliency, and compared with the original: the distance from the fifth of its surface
/// that hybrid saliency holds for most salient, from all of it, and pictures from directions that
/// the saliency has not seen.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The models
    #[arg(required = true, value_name = "FILES")]
    files: Vec<PathBuf>,
    /// Triangles to come down to; a model that has fewer is left out
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [5000, 1000, 500])]
    triangles: Vec<usize>,
    /// Kinds of saliency
    #[arg(long, value_enum, value_name = "KINDS", value_delimiter = ',', default_values_t = [Kind::Mesh, Kind::Hybrid])]
    kinds: Vec<Kind>,
    /// How much more the most salient vertices count than the least
    #[arg(long, value_name = "X", value_delimiter = ',', default_values_t = [300.0])]
    most: Vec<f32>,
    /// Powers of the saliency that the weights follow
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [8])]
    power: Vec<u32>,
    /// Smooth all saliency so far, as a share of the diagonal [default: 0.02 for hybrid, 0 for
    /// others]
    #[arg(long, value_name = "SHARE")]
    smoothing: Option<f64>,
    /// Directions that pictures are compared from
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    views: u32,
    /// Pixels a side of each picture
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Share of the surface that counts as most salient.
const SALIENT: f64 = 0.2;
/// Samples of a surface.
const SAMPLES: u64 = 200_000;

impl Args {
    /// All largest weights with all powers.
    fn maps(&self) -> impl Iterator<Item = (f32, u32)> {
        let with_all = |&most: &f32| self.power.iter().map(move |&power| (most, power));
        self.most.iter().flat_map(with_all)
    }
}

/// Runs every model, one after the other.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    if let Some(most) = args.most.iter().find(|m| !(**m > 0.0 && m.is_finite())) {
        let message = format!("--most is {most}; it must be above 0");
        return Err(Failure::input(message).into());
    }
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    for file in &args.files {
        check_cancelled()?;
        if !console.quiet {
            to_stderr(&file.display().to_string());
        }
        let of_file = Trial::of(file, args, console)?;
        of_file.run(args, &mut rows)?;
        times.push(of_file.times);
    }
    let markdown = report::markdown(args.views, args.size, &rows, &times);
    tell(page, "karui bench saliency", &markdown, console)?;
    console.document(&serde_json::json!({ "rows": rows, "times": times }))?;
    console.summary(&format!(
        "{} results of {} models; {}",
        rows.len(),
        args.files.len(),
        seconds(console.elapsed())
    ))
}

/// One model and what it takes to judge its levels.
struct Trial {
    name: String,
    input: Input,
    saliency: Vec<(Kind, Vec<Vec<f32>>)>,
    images: Vec<Option<Picture>>,
    eye: Eye,
    /// What the eye sees of the original.
    seen: Vec<Picture>,
    original: Surface,
    /// 1 for vertices of the most salient surface, of all meshes.
    salient: Vec<f32>,
    times: Times,
}

impl Trial {
    fn of(path: &Path, args: &Args, console: &Console) -> Result<Self> {
        let input = input::read(path, console)?;
        input.require_triangles()?;
        let images = textures::decode(&input, console);
        let model = Model::of_scene(&input.scene, &images);
        let eye = Eye::new(Renderer::of_model(&model)?.bounds(), args.views, args.size);
        let seen = eye.pictures(&model)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let mut times = Times::new(&name, &input.scene);
        let mut kinds = args.kinds.clone();
        if !kinds.contains(&Kind::Hybrid) {
            kinds.push(Kind::Hybrid);
        }
        let mut saliency = Vec::new();
        for kind in kinds {
            let start = Instant::now();
            saliency.push((
                kind,
                saliency::of_scene(kind, args.smoothing, &input, console)?,
            ));
            times
                .seconds
                .push((kind.name(), start.elapsed().as_secs_f64()));
        }
        let hybrid = saliency.iter().find(|s| s.0 == Kind::Hybrid);
        let salient = hybrid.map_or(Vec::new(), |s| most_salient(&input.scene, &s.1));
        saliency.retain(|s| args.kinds.contains(&s.0));
        Ok(Self {
            name: name.into_owned(),
            original: Surface::new(&joined(&input.scene))?,
            saliency,
            images,
            eye,
            seen,
            salient,
            times,
            input,
        })
    }

    fn run(&self, args: &Args, rows: &mut Vec<Row>) -> Result<()> {
        for &triangles in &args.triangles {
            if triangles >= self.input.scene.triangle_count() {
                continue;
            }
            rows.push(self.judge("plain".into(), triangles, &[])?);
            for (kind, values) in &self.saliency {
                for (most, power) in args.maps() {
                    check_cancelled()?;
                    let map = WeightMap::Power {
                        least: 1.0,
                        most,
                        power,
                    };
                    let weights = values.iter().map(|v| map.weights(v).map(Some));
                    let weights = weights.collect::<karui::Result<Vec<_>>>()?;
                    let method = format!("{} x{most} ^{power}", kind.name());
                    rows.push(self.judge(method, triangles, &weights)?);
                }
            }
        }
        Ok(())
    }

    /// Simplifies and compares with the original.
    fn judge(&self, method: String, triangles: usize, weights: &[Option<Vec<f32>>]) -> Result<Row> {
        let options = LodOptions {
            levels: Levels::Stops(vec![Stop {
                triangles: Some(triangles),
                ..Stop::default()
            }]),
            weights,
            ..LodOptions::default()
        };
        let scene = chain_scene(&self.input.scene, &options)?.scene_at(&self.input.scene, 1);
        let simplified = Surface::new(&joined(&scene))?;
        let rms = |weights: Option<&[f32]>| -> Result<f64> {
            let options = SurfaceDistanceOptions {
                samples: Samples::Count(SAMPLES),
                vertices: false,
                edges: false,
                weights,
                ..SurfaceDistanceOptions::default()
            };
            let distance = directed_distance(&self.original, &simplified, &options)?;
            Ok(distance.rms / self.original.bounds().diagonal())
        };
        let pictures = self.eye.pictures(&Model::of_scene(&scene, &self.images))?;
        let mut sum = ViewDifferences::default();
        for view in differences(&self.seen, &pictures)? {
            sum.add(&view);
        }
        let seen = sum.mean();
        Ok(Row {
            model: self.name.clone(),
            triangles,
            method,
            left: scene.triangle_count(),
            salient: rms(Some(&self.salient))?,
            whole: rms(None)?,
            flip: seen.map_or(0.0, |s| s.flip),
            rmse: seen.map_or(0.0, |s| s.rmse),
        })
    }
}

/// All meshes of a scene as one, where they are before they are placed.
fn joined(scene: &Scene) -> TriMesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in scene.meshes.iter().map(|m| &m.mesh) {
        let first = positions.len() as u32;
        positions.extend_from_slice(&mesh.positions);
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    TriMesh::new(positions, triangles)
}

/// 1 for the vertices whose saliency is that of the most salient [`SALIENT`] of the
/// area or more, 0 for the others.
fn most_salient(scene: &Scene, values: &[Vec<f32>]) -> Vec<f32> {
    let mut parts: Vec<(f32, f64)> = Vec::new();
    for (mesh, values) in scene.meshes.iter().map(|m| &m.mesh).zip(values) {
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let sum: f32 = corners.iter().map(|&v| values[v as usize]).sum();
            parts.push((sum / 3.0, area(mesh.corners(t))));
        }
    }
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut left = SALIENT * parts.iter().map(|p| p.1).sum::<f64>();
    let inside = parts.iter().take_while(|part| {
        let inside = left > 0.0;
        left -= part.1;
        inside
    });
    let least = inside.last().map_or(0.0, |part| part.0);
    let all = values.iter().flatten();
    all.map(|&v| f32::from(v >= least)).collect()
}
