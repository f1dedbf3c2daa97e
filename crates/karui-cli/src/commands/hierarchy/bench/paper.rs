//! The experiment of Miyamura and Imai, and pictures at equal numbers of triangles.

use super::{Args, two_lights};
use crate::commands::bench::page::machine;
use crate::commands::hierarchy::{build, read_mesh};
use crate::console::{Console, to_stderr};
use crate::output::Staged;
use crate::progress::check_cancelled;
use crate::table::{count, table};
use anyhow::Result;
use karui::TriMesh;
use karui::geom::{Camera, Light, Vec3};
use karui::hierarchy::{Budget, Hierarchy, Silhouette, ViewAndLight};
use karui::mesh::{NormalWeight, PositionIds, vertex_normals};
use karui::metrics::image::rmse;
use karui::render::{Outputs, Picture, RenderOptions, Renderer, Shading};
use karui::simplify::{AttributeWeights, Placement, SimplifyOptions, Stop, simplify};
use serde::Serialize;
use std::f32::consts::FRAC_PI_6;
use std::path::Path;
use std::time::Instant;

/// Sides of the pictures, pixels.
const SIDE: u32 = 443;

/// At what closeness pictures are compared.
const COMPARED: f32 = 2.4;

/// Degrees below which a surface counts as flat.
const PHI: f64 = 3.0;

/// The published parameters: tau as a share of the picture, phi and rho in degrees.
const CONDITIONS: [(&str, f64, f64, f64); 3] = [
    ("view", 2e-9, PHI, 0.0),
    ("light", 1.0, 0.0, 30.0),
    ("view and light", 2e-9, PHI, 30.0),
];

#[derive(Debug, Serialize)]
struct Row {
    model: String,
    condition: String,
    triangles: usize,
    /// Median of the moves; none where there is nothing to refine.
    milliseconds: Option<f64>,
    /// Milliseconds to draw the frame.
    redraw: f64,
    mse: f64,
}

/// One model on its way through the experiment.
struct Experiment<'a> {
    name: String,
    mesh: &'a TriMesh,
    hierarchy: &'a Hierarchy,
    lights: Vec<Light>,
    original: Picture,
    pictures: Vec<(String, Picture)>,
    rows: Vec<Row>,
}

/// Runs every model; as Markdown.
pub fn run(args: &Args, console: &Console) -> Result<String> {
    let staged = args
        .pictures
        .as_deref()
        .map(Staged::in_directory)
        .transpose()?;
    let mut rows = Vec::new();
    let mut builds = Vec::new();
    for file in &args.files {
        if !console.quiet {
            to_stderr(&file.display().to_string());
        }
        let (_, mut mesh) = read_mesh(file, console)?;
        with_normals(&mut mesh)?;
        let started = Instant::now();
        let hierarchy = build(&mesh, args.build, file, console)?;
        builds.push((file.clone(), started.elapsed().as_secs_f64()));
        let mut experiment = Experiment::new(file, &mesh, &hierarchy)?;
        for condition in CONDITIONS {
            experiment.condition(condition)?;
        }
        for &area in &args.areas {
            experiment.at_equal_triangles(area, args.rho)?;
        }
        if let Some(staged) = &staged {
            experiment.write(staged)?;
        }
        rows.extend(experiment.rows);
    }
    staged.map(Staged::publish).transpose()?;
    console.document(&rows)?;
    Ok(markdown(&rows, &builds))
}

impl<'a> Experiment<'a> {
    fn new(file: &Path, mesh: &'a TriMesh, hierarchy: &'a Hierarchy) -> Result<Self> {
        let lights = two_lights(hierarchy.bounds());
        let (original, redraw) = drawn(mesh, hierarchy, &lights)?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let name = name.split('.').next().unwrap_or("model").to_owned();
        let first = Row {
            model: name.clone(),
            condition: "original".into(),
            triangles: hierarchy.triangle_count(),
            milliseconds: None,
            redraw,
            mse: 0.0,
        };
        Ok(Self {
            pictures: vec![("original".into(), original.clone())],
            rows: vec![first],
            name,
            mesh,
            hierarchy,
            lights,
            original,
        })
    }

    /// 20 moves forth and 20 back, then the picture.
    fn condition(&mut self, (name, tau, phi, rho): (&str, f64, f64, f64)) -> Result<()> {
        let mut cut = self.hierarchy.coarsest();
        let mut times = Vec::new();
        for step in 0..=40i32 {
            check_cancelled()?;
            let z = 1.0 + 0.1 * (20 - (20 - step).abs()) as f32;
            let change = cut.refine(&self.criteria(z, tau, phi, rho), Budget::UNLIMITED)?;
            times.push(change.time.as_secs_f64() * 1e3);
        }
        // From the coarsest to the first view is no move.
        times.remove(0);
        times.sort_by(f64::total_cmp);
        cut.refine(&self.criteria(COMPARED, tau, phi, rho), Budget::UNLIMITED)?;
        self.add(name, &cut.to_mesh(self.mesh)?, Some(times[times.len() / 2]))
    }

    fn criteria(&self, z: f32, tau: f64, phi: f64, rho: f64) -> ViewAndLight {
        let lights = if rho > 0.0 {
            self.lights.clone()
        } else {
            Vec::new()
        };
        ViewAndLight {
            camera: camera(self.hierarchy, z),
            size: [SIDE; 2],
            lights,
            silhouette: Silhouette::Kept { area: 0.0 },
            light_silhouette: Silhouette::Kept { area: 0.0 },
            area: tau * f64::from(SIDE * SIDE),
            flatness: phi,
            highlight: rho,
            highlight_area: 0.0,
            ..ViewAndLight::default()
        }
    }

    /// By view and light, by view alone, and without regard to either, the others
    /// with no fewer triangles than the first.
    fn at_equal_triangles(&mut self, area: f64, rho: f64) -> Result<()> {
        let tau = area / f64::from(SIDE * SIDE);
        let mut cut = self.hierarchy.coarsest();
        let both = self.criteria(COMPARED, tau, PHI, rho);
        let triangles = cut.refine(&both, Budget::UNLIMITED)?.triangles;
        let name = format!("view and light, {area} px2, rho {rho}");
        self.add(&name, &cut.to_mesh(self.mesh)?, None)?;
        let (mut fine, mut coarse) = (0.0, tau);
        for _ in 0..24 {
            check_cancelled()?;
            let tau = 0.5 * (fine + coarse);
            let view = self.criteria(COMPARED, tau, PHI, 0.0);
            match cut.refine(&view, Budget::UNLIMITED)?.triangles {
                n if n >= triangles => fine = tau,
                _ => coarse = tau,
            }
        }
        let view = self.criteria(COMPARED, fine, PHI, 0.0);
        cut.refine(&view, Budget::UNLIMITED)?;
        let area = fine * f64::from(SIDE * SIDE);
        let name = format!("view, {area:.2} px2");
        self.add(&name, &cut.to_mesh(self.mesh)?, None)?;
        let options = SimplifyOptions {
            stop: Stop::triangles(triangles),
            placement: Placement::HalfEdge,
            attributes: AttributeWeights::NONE,
            ..SimplifyOptions::default()
        };
        let uniform = simplify(self.mesh, &options)?.mesh;
        self.add("simplified everywhere", &uniform, None)
    }

    fn add(&mut self, condition: &str, mesh: &TriMesh, milliseconds: Option<f64>) -> Result<()> {
        let (picture, redraw) = drawn(mesh, self.hierarchy, &self.lights)?;
        let error = 255.0 * rmse(&self.original, &picture)?;
        self.rows.push(Row {
            model: self.name.clone(),
            condition: condition.to_owned(),
            triangles: mesh.triangles.len(),
            milliseconds,
            redraw,
            mse: error * error,
        });
        let name = condition
            .split(',')
            .next()
            .unwrap_or(condition)
            .replace(' ', "-");
        self.pictures.push((name, picture));
        Ok(())
    }

    /// The pictures, and eight times the differences from the original's.
    fn write(&self, staged: &Staged) -> Result<()> {
        for (i, (name, picture)) in self.pictures.iter().enumerate() {
            let name = format!("{}-{i}-{name}", self.name);
            staged.bytes(&format!("{name}.png"), &karui_io::encode_png(picture)?)?;
            let mut difference = picture.clone();
            for (d, o) in difference
                .pixels_mut()
                .iter_mut()
                .zip(self.original.pixels())
            {
                for k in 0..3 {
                    d[k] = d[k].abs_diff(o[k]).saturating_mul(8);
                }
            }
            let png = karui_io::encode_png(&difference)?;
            staged.bytes(&format!("{name}-difference.png"), &png)?;
        }
        Ok(())
    }
}

/// Vertices keep the normals they have, however few are left.
fn with_normals(mesh: &mut TriMesh) -> Result<()> {
    if mesh.attributes.normals.is_none() {
        let ids = PositionIds::of_mesh(mesh);
        let normals = vertex_normals(mesh, &ids, NormalWeight::default())?;
        mesh.attributes.normals = Some(normals);
    }
    Ok(())
}

/// The centre is 1/z of the distance away at which all is just in view.
fn camera(hierarchy: &Hierarchy, z: f32) -> Camera {
    let mut camera = Camera::looking_at(hierarchy.bounds(), Vec3::new(0.3, 0.2, 1.0), FRAC_PI_6);
    camera.eye = camera.target + (camera.eye - camera.target) / z;
    camera
}

/// The picture that is compared, and the milliseconds it takes.
fn drawn(mesh: &TriMesh, hierarchy: &Hierarchy, lights: &[Light]) -> Result<(Picture, f64)> {
    let mut plain = TriMesh::new(mesh.positions.clone(), mesh.triangles.clone());
    plain
        .attributes
        .normals
        .clone_from(&mesh.attributes.normals);
    let options = RenderOptions {
        width: SIDE,
        height: SIDE,
        samples: 1,
        outputs: Outputs::COLOR,
        background: [0, 0, 0, 255],
        shading: Shading::BlinnPhong,
        ..RenderOptions::default()
    };
    let renderer = Renderer::of_mesh(&plain)?;
    let started = Instant::now();
    let frame = renderer.frame(&camera(hierarchy, COMPARED), lights, &options)?;
    Ok((frame.color, started.elapsed().as_secs_f64() * 1e3))
}

fn markdown(rows: &[Row], builds: &[(std::path::PathBuf, f64)]) -> String {
    let header = [
        "model",
        "condition",
        "triangles",
        "tests ms",
        "redraw ms",
        "MSE",
    ];
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            vec![
                row.model.clone(),
                row.condition.clone(),
                count(row.triangles),
                row.milliseconds
                    .map_or("-".to_owned(), |ms| format!("{ms:.3}")),
                format!("{:.1}", row.redraw),
                format!("{:.4}", row.mse),
            ]
        })
        .collect();
    let built = builds.iter().map(|(file, s)| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        format!("`{name}` {s:.2} s")
    });
    format!(
        "## The experiment of Miyamura and Imai (table 2)\n\n\
         Written by `karui hierarchy bench --paper FILES -o FILE` (release build): {SIDE} x {SIDE} pixels,\n\
         the eye at 1/z of the distance at which all is in view, z from 1.0 to 3.0 and back by 0.1;\n\
         tests: median of the 40 moves, all of `refine`; redraw: one frame on the CPU; MSE: mean\n\
         squared difference of red, green and blue (0-255) from the original's picture at z = {COMPARED}.\n\
         Two point lights, Blinn-Phong. Parameters as published: view (tau 2e-9, phi 3, rho 0), light\n\
         (tau 1, phi 0, rho 30), view and light (tau 2e-9, phi 3, rho 30), tau as a share of the\n\
         picture's area (1 is {} square pixels). Published, for the bunny on a Pentium 4, 2.8 GHz:\n\
         tests 41.05 / 40.19 / 43.90 ms, redraw 216 to 110-120 ms, MSE 149.8 / 181.3 / 135.5, build\n\
         8.96 s. Below them a larger tau, in square pixels: view and light; the view alone and\n\
         simplification without regard to either (`simplify`, half-edge), both with no fewer triangles,\n\
         but where the view alone cannot have as many.\n\n\
         Built: {}. {}\n\n{}\n",
        SIDE * SIDE,
        built.collect::<Vec<_>>().join(", "),
        machine(),
        table(&header, &cells, true)
    )
}
