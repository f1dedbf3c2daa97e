//! `karui scene terrain`: land of any size, a few rows of it in memory.

use super::mesh_output::MeshOutput;
use crate::console::Console;
use crate::failure::Failure;
use anyhow::Result;
use karui::geom::Vec3;
use karui::mesh::{Attributes, shapes::landscape_height};
use karui::outofcore::Vertices;
use karui_io::HeightRows;
use rayon::prelude::*;
use std::path::PathBuf;

/// Vertices that are in memory at once, at least a row.
const PORTION: u32 = 1 << 17;
/// The part of the land over which hills run down into the flat half.
const SLOPE: u32 = 16;

/// Make land as one mesh of any size
///
/// A grid, y up, written row by row as binary PLY: 16385x8193 vertices, 268 million triangles,
/// take 5 GB on disk and some megabytes of memory. Hills from waves of 1024 vertices down to 2,
/// 1 unit from vertex to vertex; or the heights of a grey PNG of 8 or 16 bits.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Vertices along x and z, each at least 2
    #[arg(long, value_name = "COLUMNSxROWS", default_value = "1025x1025", value_parser = size)]
    size: (u32, u32),
    /// Another number, another land
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// The half where x is larger is a plain
    #[arg(long)]
    half_flat: bool,
    /// Grey PNG whose values are the heights, instead of made-up ones
    #[arg(long, value_name = "FILE", conflicts_with_all = ["size", "seed", "half_flat"])]
    heights: Option<PathBuf>,
    /// Distance of two pixels of the PNG
    #[arg(
        long,
        value_name = "LENGTH",
        default_value_t = 1.0,
        requires = "heights"
    )]
    spacing: f32,
    /// Grey value of height 0
    #[arg(long, value_name = "GREY", default_value_t = 0, requires = "heights")]
    zero: u16,
    /// Height of one step of grey
    #[arg(
        long,
        value_name = "LENGTH",
        default_value_t = 1.0,
        requires = "heights"
    )]
    step: f32,
    #[command(flatten)]
    output: MeshOutput,
}

/// Makes and writes it.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    args.output.check()?;
    let mut land = Land::new(args)?;
    let [columns, rows] = land.size;
    let mut writer = args.output.create()?;
    let progress = console.progress();
    let step = (PORTION / columns).max(1);
    let starts = || (0..rows).step_by(step as usize);
    for first in starts() {
        super::check(&*progress, "vertices", 0.5 * first as f32 / rows as f32)?;
        let positions = land.rows(first, step.min(rows - first))?;
        let attributes = Attributes::default();
        let slice = Vertices {
            positions,
            attributes,
        };
        args.output.put(writer.write_vertices(slice))?;
    }
    for first in starts() {
        super::check(
            &*progress,
            "triangles",
            0.5 + 0.5 * first as f32 / rows as f32,
        )?;
        let cells = first..(first + step).min(rows - 1);
        let triangles: Vec<_> = cells
            .flat_map(|j| strip(j.into(), columns.into()))
            .collect();
        args.output.put(writer.write_triangles(&triangles))?;
    }
    drop(progress);
    args.output.finish(writer, "land", console)
}

/// The triangles between rows `j` and `j + 1`, facing up.
fn strip(j: u64, columns: u64) -> impl Iterator<Item = [u64; 3]> {
    (0..columns - 1).flat_map(move |i| {
        let [near, far] = [j * columns + i, (j + 1) * columns + i];
        [[near, far, far + 1], [near, far + 1, near + 1]]
    })
}

/// Where heights come from.
struct Land<'a> {
    args: &'a Args,
    size: [u32; 2],
    picture: Option<HeightRows>,
}

impl<'a> Land<'a> {
    fn new(args: &'a Args) -> Result<Self> {
        let picture = args.heights.as_ref().map(HeightRows::open).transpose()?;
        let size = picture.as_ref().map_or(args.size.into(), HeightRows::size);
        let lengths = [args.spacing, args.step];
        let [columns, rows] = size;
        let most = f64::from(columns.max(rows)) * f64::from(args.spacing);
        let highest = 65535.0 * f64::from(args.step);
        let limit = f64::from(f32::MAX);
        if lengths.iter().any(|l| !l.is_finite() || *l == 0.0) || args.spacing < 0.0 {
            let message = "--spacing is above 0 and --step is not 0";
            return Err(Failure::input(message).into());
        }
        if most > limit || highest.abs() > limit {
            return Err(Failure::input("the land is larger than 32-bit numbers").into());
        }
        check_size(columns, rows).map_err(Failure::input)?;
        Ok(Self {
            args,
            size,
            picture,
        })
    }

    /// Positions of some rows; those of a picture in order only.
    fn rows(&mut self, first: u32, count: u32) -> Result<Vec<Vec3>> {
        let [columns, _] = self.size;
        let Some(picture) = &mut self.picture else {
            let row = |j: u32| (0..columns).into_par_iter().map(move |i| (i, j));
            let vertices = (first..first + count).into_par_iter().flat_map(row);
            let args = self.args;
            return Ok(vertices.map(|(i, j)| made(args, i, j)).collect());
        };
        let mut positions = Vec::with_capacity((columns * count) as usize);
        for j in first..first + count {
            let Some(row) = picture.next_row()? else {
                return Err(Failure::input("the picture has fewer rows than it says").into());
            };
            let height = |grey: u16| (f32::from(grey) - f32::from(self.args.zero)) * self.args.step;
            let spacing = self.args.spacing;
            positions.extend(
                (0u32..).zip(row).map(|(i, grey)| {
                    Vec3::new(i as f32 * spacing, height(grey), j as f32 * spacing)
                }),
            );
        }
        Ok(positions)
    }
}

/// A vertex of made-up land.
fn made(args: &Args, i: u32, j: u32) -> Vec3 {
    let columns = args.size.0;
    let share = if args.half_flat {
        let to_plain = (columns / 2).saturating_sub(i);
        (to_plain as f32 / (columns / SLOPE).max(1) as f32).min(1.0)
    } else {
        1.0
    };
    let height = if share > 0.0 {
        share * landscape_height(i, j, args.seed)
    } else {
        0.0
    };
    Vec3::new(i as f32, height, j as f32)
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x');
    let sides = sides.and_then(|(c, r)| Some((c.parse().ok()?, r.parse().ok()?)));
    let (columns, rows) = sides.ok_or("expected COLUMNSxROWS, for instance 4097x2049")?;
    check_size(columns, rows)?;
    Ok((columns, rows))
}

fn check_size(columns: u32, rows: u32) -> Result<(), String> {
    if columns < 2 || rows < 2 {
        return Err(format!(
            "{columns} x {rows} vertices; each side has at least 2"
        ));
    }
    if columns.checked_mul(rows).is_none() {
        return Err(format!(
            "{columns} x {rows} vertices are more than PLY can number"
        ));
    }
    Ok(())
}
