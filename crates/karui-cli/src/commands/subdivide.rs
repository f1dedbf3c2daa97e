//! `karui subdivide`: a smooth surface from a coarse cage.

mod adaptive;

use crate::args::WriteArgs;
use crate::console::Console;
use crate::failure::Failure;
use crate::table::{bytes, count, seconds};
use crate::{input, output};
use anyhow::{Context, Result};
use clap::ValueEnum;
use karui::subdiv::{
    Boundary, CreaseMethod, FaceVaryingRule, Rules, Scheme, SubdivOptions, SurfaceOptions,
    subdivide,
};
use serde_json::json;
use std::path::PathBuf;

/// Make a smooth surface of a coarse mesh (Catmull-Clark, √2, √3, Loop)
///
/// Faces may have any number of corners (OBJ, PLY, OFF). Of OBJ the tags of OpenSubdiv's shapes
/// are read: `t crease`, `t corner`, `t hole`, `t interpolateboundary`,
/// `t facevaryinginterpolateboundary`, `t creasemethod`, `t smoothtriangles`; options given here
/// take their place. Texture coordinates, colours and materials go along. Polygons are
/// triangulated on the way out.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The control mesh
    input: PathBuf,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// How faces are divided
    #[arg(long, value_enum, default_value_t)]
    scheme: SchemeName,
    /// Number of steps
    #[arg(long, value_name = "N", default_value_t = 2)]
    levels: u32,
    /// What happens where the surface ends [default: what the file says, else corner]
    #[arg(long, value_enum, value_name = "RULE")]
    boundary: Option<BoundaryName>,
    /// How creases decay from step to step [default: what the file says, else uniform]
    #[arg(long, value_enum, value_name = "RULE")]
    creases: Option<CreaseName>,
    /// Where texture coordinates stay linear [default: what the file says, else corners-plus1]
    #[arg(long, value_enum, value_name = "RULE")]
    uvs: Option<UvName>,
    /// Put vertices where infinitely many steps would
    #[arg(long)]
    limit: bool,
    /// Write normals of the limit surface
    #[arg(long)]
    normals: bool,
    /// Refuse to make more faces than this
    #[arg(long, value_name = "COUNT", default_value_t = SubdivOptions::default().max_faces)]
    max_faces: u64,
    #[command(flatten)]
    adaptive: adaptive::AdaptiveArgs,
    #[command(flatten)]
    write: WriteArgs,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum SchemeName {
    /// Catmull-Clark: quads, of any faces, four times as many a step
    #[default]
    CatmullClark,
    /// Catmull-Clark in two steps, each twice as many faces
    Sqrt2,
    /// Of triangles, three times as many a step
    Sqrt3,
    /// Of triangles, four times as many a step
    Loop,
    /// As Catmull-Clark, but nothing moves
    Bilinear,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BoundaryName {
    /// Faces at boundaries are left out
    None,
    /// Boundaries are smooth curves
    Edge,
    /// And vertices of one face stay where they are
    Corner,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CreaseName {
    /// By 1 a step
    Uniform,
    /// Smoothed along the crease
    Chaikin,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum UvName {
    /// Nowhere
    None,
    /// At corners of charts
    CornersOnly,
    /// Also where more than two charts meet
    CornersPlus1,
    /// Also where one of two charts has a corner, and where a seam ends
    CornersPlus2,
    /// Along boundaries of charts
    Boundaries,
    /// Everywhere
    All,
}

impl Args {
    fn options(&self) -> SubdivOptions {
        SubdivOptions {
            scheme: match self.scheme {
                SchemeName::CatmullClark => Scheme::CatmullClark,
                SchemeName::Sqrt2 => Scheme::Sqrt2,
                SchemeName::Sqrt3 => Scheme::Sqrt3,
                SchemeName::Loop => Scheme::Loop,
                SchemeName::Bilinear => Scheme::Bilinear,
            },
            levels: self.levels,
            max_faces: self.max_faces,
            ..SubdivOptions::default()
        }
    }

    /// Whether faces lie across edges of the cage, where texture coordinates may end.
    fn crosses_charts(&self) -> bool {
        match self.scheme {
            SchemeName::Sqrt3 => self.levels > 0,
            SchemeName::Sqrt2 => self.levels % 2 == 1,
            _ => false,
        }
    }

    /// The file's rules, those given in their place.
    fn rules(&self, of_file: Rules) -> Rules {
        let boundary = self.boundary.map(|name| match name {
            BoundaryName::None => Boundary::None,
            BoundaryName::Edge => Boundary::EdgeOnly,
            BoundaryName::Corner => Boundary::EdgeAndCorner,
        });
        let creases = self.creases.map(|name| match name {
            CreaseName::Uniform => CreaseMethod::Uniform,
            CreaseName::Chaikin => CreaseMethod::Chaikin,
        });
        let face_varying = self.uvs.map(|name| match name {
            UvName::None => FaceVaryingRule::None,
            UvName::CornersOnly => FaceVaryingRule::CornersOnly,
            UvName::CornersPlus1 => FaceVaryingRule::CornersPlus1,
            UvName::CornersPlus2 => FaceVaryingRule::CornersPlus2,
            UvName::Boundaries => FaceVaryingRule::Boundaries,
            UvName::All => FaceVaryingRule::All,
        });
        Rules {
            boundary: boundary.or(of_file.boundary),
            creases: creases.or(of_file.creases),
            face_varying: face_varying.or(of_file.face_varying),
            ..of_file
        }
    }
}

/// Reads, refines, writes, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    input::output_format(&args.output)?;
    let mut loaded = karui_io::read_control(&args.input)?;
    for warning in &loaded.warnings {
        console.warn(&format!("{}: {warning}", args.input.display()));
    }
    let control = &mut loaded.mesh;
    control.rules = args.rules(control.rules);
    if args.crosses_charts() && control.uvs.take().is_some() {
        console.warn("texture coordinates are left out: faces of this scheme cross their seams");
    }
    let surface = SurfaceOptions {
        on_limit: args.limit,
        normals: args.normals,
    };
    let made = {
        let progress = console.progress();
        let adaptive = args.adaptive.refine(control, &args.options());
        adaptive.unwrap_or_else(|| subdivide(control, &args.options(), surface, &*progress))
    };
    let made = made
        .map_err(|error| refused(error, args))
        .with_context(|| args.input.display().to_string())?;
    let (cage_faces, faces) = (control.cage.face_count(), made.mesh.face_count());
    let (cage_vertices, vertices) = (control.cage.vertices, made.mesh.positions.len());
    let mut scene = loaded.scene;
    if let Some(named) = scene.meshes.first_mut() {
        named.mesh = made.mesh.triangulate();
    }
    let written = output::write_one(&args.output, &scene, &args.write.resolve())?;
    console.summary(&format!(
        "faces     {} -> {}\nvertices  {} -> {}",
        count(cage_faces),
        count(faces),
        count(cage_vertices),
        count(vertices)
    ))?;
    console.document(&json!({
        "input": args.input, "output": args.output, "bytes": written.bytes,
        "faces": { "before": cage_faces, "after": faces },
        "vertices": { "before": cage_vertices, "after": vertices },
        "triangles": scene.triangle_count(),
    }))?;
    console.summary(&format!(
        "{}: {} triangles, {} in {}",
        args.output.display(),
        count(scene.triangle_count()),
        bytes(written.bytes),
        seconds(console.elapsed()),
    ))
}

fn refused(error: karui::Error, args: &Args) -> anyhow::Error {
    let of_limits = args.scheme == SchemeName::Sqrt3 && (args.limit || args.normals);
    let hint = match &error {
        karui::Error::TooFine { .. } => "take fewer --levels, or allow more with --max-faces",
        karui::Error::BadOption {
            option: "scheme", ..
        } if of_limits => "leave out --limit and --normals",
        karui::Error::BadOption {
            option: "scheme", ..
        } => "--scheme catmull-clark takes any faces and all tags",
        karui::Error::Cancelled => return error.into(),
        _ => "`karui validate` tells more about the mesh",
    };
    Failure::input(error.to_string()).hint(hint).into()
}
