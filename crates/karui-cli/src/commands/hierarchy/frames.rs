//! Frames of a path: where they are seen from, and the files that come of them.

use crate::console::Console;
use crate::failure::Failure;
use crate::input::Input;
use crate::output::Staged;
use crate::progress::check_cancelled;
use crate::{table, textures};
use anyhow::{Context as _, Result};
use karui::geom::{Aabb, Camera, Light};
use karui::render::{Model, Outputs, Picture, RenderOptions, Renderer};
use karui::{Scene, TriMesh};
use karui_io::{CameraPath, WriteOptions};
use std::path::{Path, PathBuf};

/// From where frames are seen, and what is written of them.
#[derive(Debug, clap::Args)]
pub struct FramesArgs {
    /// The directory to write to
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Cameras and lights, as JSON [default: once around]
    #[arg(long, value_name = "FILE", conflicts_with = "around")]
    path: Option<PathBuf>,
    /// Frames once around the model
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    around: u32,
    /// Width and height of a frame, pixels
    #[arg(long, value_name = "N|WxH", default_value = "1024x768", value_parser = crate::args::size)]
    pub size: (u32, u32),
    /// Write every frame as a picture: frame-000.png and so on
    #[arg(long)]
    pictures: bool,
    /// Draw the edges of the triangles in the pictures
    #[arg(long, requires = "pictures")]
    wireframe: bool,
    /// Write every frame as a mesh: frame-000.glb and so on
    #[arg(long)]
    meshes: bool,
}

impl FramesArgs {
    /// The path that was asked for: of a file, else once around `bounds`.
    pub fn path(&self, bounds: Aabb) -> Result<CameraPath> {
        match &self.path {
            Some(path) => read_path(path),
            None => Ok(CameraPath::around(bounds, self.around)),
        }
    }
}

/// A path from a JSON file.
pub fn read_path(path: &Path) -> Result<CameraPath> {
    let hint = "docs/hierarchy.md shows what a path looks like";
    let read = CameraPath::read(path);
    Ok(read.map_err(|e| Failure::input(e.to_string()).hint(hint))?)
}

/// The files of all frames, on their way.
pub struct Frames<'a> {
    args: &'a FramesArgs,
    scene: &'a Scene,
    images: Vec<Option<Picture>>,
    staged: Staged,
}

impl<'a> Frames<'a> {
    /// Makes sure that files can be written; they look like `input`.
    pub fn new(args: &'a FramesArgs, input: &'a Input, console: &Console) -> Result<Self> {
        let images = match args.pictures {
            true => textures::decode(input, console),
            false => Vec::new(),
        };
        Ok(Self {
            args,
            scene: &input.scene,
            images,
            staged: Staged::in_directory(&args.output)?,
        })
    }

    /// What `step` makes of every frame of the path, in order.
    pub fn walk<R>(
        &self,
        path: &CameraPath,
        stage: &'static str,
        console: &Console,
        mut step: impl FnMut(usize, Camera, Vec<Light>) -> Result<R>,
    ) -> Result<Vec<R>> {
        let progress = console.progress();
        let mut rows = Vec::new();
        for (i, frame) in path.frames.iter().enumerate() {
            check_cancelled()?;
            progress.report(stage, i as f32 / path.frames.len() as f32);
            let resolved = frame.resolve().map_err(Into::into);
            let row = resolved.and_then(|(camera, lights)| step(i, camera, lights));
            rows.push(row.with_context(|| format!("frame {i}"))?);
        }
        Ok(rows)
    }

    /// Writes a frame as was asked for; makes its mesh only if something was.
    pub fn write(
        &self,
        i: usize,
        camera: &Camera,
        lights: &[Light],
        mesh: impl FnOnce() -> karui::Result<TriMesh>,
    ) -> Result<()> {
        if !self.args.pictures && !self.args.meshes {
            return Ok(());
        }
        let scene = self.scene_of(mesh()?);
        if self.args.meshes {
            let name = format!("frame-{i:03}.glb");
            self.staged.scene(&name, &scene, &WriteOptions::default())?;
        }
        if self.args.pictures {
            let png = self.picture(&scene, camera, lights)?;
            self.staged.bytes(&format!("frame-{i:03}.png"), &png)?;
        }
        Ok(())
    }

    fn picture(&self, scene: &Scene, camera: &Camera, lights: &[Light]) -> Result<Vec<u8>> {
        let options = RenderOptions {
            width: self.args.size.0,
            height: self.args.size.1,
            samples: 2,
            outputs: Outputs::COLOR,
            wireframe: self.args.wireframe.then(Default::default),
            ..RenderOptions::default()
        };
        let model = Model::of_scene(scene, &self.images);
        let frame = Renderer::of_model(&model)?.frame(camera, lights, &options)?;
        Ok(karui_io::encode_png(&frame.color)?)
    }

    /// The mesh of a frame with the materials of the model.
    fn scene_of(&self, mut mesh: TriMesh) -> Scene {
        // What a range was in the file does not hold for the mesh of all.
        mesh.ranges.iter_mut().for_each(|r| r.source = None);
        Scene {
            materials: self.scene.materials.clone(),
            textures: self.scene.textures.clone(),
            images: self.scene.images.clone(),
            ..Scene::from_mesh(mesh)
        }
    }

    /// Adds `frames.csv` and moves all files to their places.
    pub fn publish(self, sheet: &Sheet) -> Result<Vec<PathBuf>> {
        self.staged.bytes("frames.csv", sheet.csv().as_bytes())?;
        self.staged.publish()
    }
}

/// A line a frame.
pub struct Sheet {
    /// What is in the columns.
    pub header: &'static [&'static str],
    /// The cells, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Sheet {
    /// As columns to look at.
    pub fn shown(&self) -> String {
        table::table(self.header, &self.rows, false)
    }

    fn csv(&self) -> String {
        let lines = self.rows.iter().map(|cells| cells.join(","));
        let header = std::iter::once(self.header.join(","));
        header.chain(lines).map(|line| line + "\n").collect()
    }
}
