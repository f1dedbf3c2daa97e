//! `karui saliency`: what matters on a model.

mod picture;

use super::render::stem;
use crate::args::WriteArgs;
use crate::console::Console;
use crate::output::Staged;
use crate::saliency::{self, Kind, PresetArg};
use crate::table::{bytes, count, seconds};
use crate::{input, output};
use anyhow::Result;
use karui::mesh::{Attribute, AttributeValues};
use karui::render::heat_color;
use serde_json::json;
use std::path::PathBuf;

/// Find out which parts of a model matter
///
/// Every vertex gets a value from 0 to 1, as attribute `saliency` (`_SALIENCY` in glTF). It can be
/// painted over and given back: `karui simplify --weights saliency`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model
    input: PathBuf,
    /// The file to write; PLY and glTF can hold the values
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// What tells
    #[arg(long, value_enum, default_value_t = Kind::Mesh)]
    kind: Kind,
    /// As published, in place of a kind
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "kind")]
    preset: Option<PresetArg>,
    /// Make every value the mean of those around it, so far as this share of the diagonal
    /// [default: 0.02 for hybrid, 0 for others]
    #[arg(long, value_name = "SHARE", conflicts_with = "preset")]
    smoothing: Option<f64>,
    /// Also as vertex colours, in place of the model's: dark blue is 0, yellow is 1
    #[arg(long)]
    colors: bool,
    /// A picture of it too, as PNG: front and back, with a legend
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    write: WriteArgs,
}

/// Reads, finds out, writes, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    input::output_format(&args.output)?;
    args.picture.as_deref().map(stem).transpose()?;
    let mut input = input::read(&args.input, console)?;
    input.require_triangles()?;
    let preset = args.preset.map(PresetArg::resolve);
    let values = match preset {
        Some(preset) => saliency::of_preset(preset, &input, console)?,
        None => saliency::of_scene(args.kind, args.smoothing, &input, console)?,
    };
    let name = preset.map_or(args.kind.name(), |p| p.name().to_owned());
    let staged = args.picture.as_deref().map(|path| {
        let png = karui_io::encode_png(&picture::sheet(&input, &values, &name)?)?;
        let staged = Staged::beside(path)?;
        let file = path.file_name().unwrap_or_default();
        staged.bytes(&file.to_string_lossy(), &png)?;
        Ok::<_, anyhow::Error>(staged)
    });
    let staged = staged.transpose()?;
    let all: Vec<f32> = values.iter().flatten().copied().collect();
    for (mesh, values) in input.scene.meshes.iter_mut().zip(values) {
        let attributes = &mut mesh.mesh.attributes;
        if args.colors {
            attributes.colors = vec![values.iter().map(|v| heat_color(*v)).collect()];
        }
        attributes.custom.retain(|a| a.name != NAME);
        attributes.custom.push(Attribute {
            name: NAME.into(),
            components: 1,
            values: AttributeValues::F32(values),
        });
    }
    let written = output::write_one(&args.output, &input.scene, &args.write.resolve())?;
    staged.map(Staged::publish).transpose()?;
    let shares = histogram(&all);
    console.data(&bars(&shares))?;
    console.document(&json!({
        "input": args.input, "output": args.output, "picture": args.picture, "bytes": written.bytes,
        "kind": name, "vertices": all.len(), "histogram": shares,
    }))?;
    console.summary(&format!(
        "{}: {} saliency of {} vertices, {} in {}",
        args.output.display(),
        name,
        count(all.len()),
        bytes(written.bytes),
        seconds(console.elapsed()),
    ))
}

const NAME: &str = "saliency";

/// Vertices by tenths of the saliency.
fn histogram(values: &[f32]) -> [usize; 10] {
    let mut counts = [0; 10];
    for value in values {
        counts[((value * 10.0) as usize).min(9)] += 1;
    }
    counts
}

fn bars(counts: &[usize; 10]) -> String {
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let bar = |(i, &n): (usize, &usize)| {
        let (from, to) = (i as f32 / 10.0, (i + 1) as f32 / 10.0);
        let bar = "#".repeat((n * 40).div_ceil(most));
        format!("{from:.1} - {to:.1}  {:>11}  {bar}", count(n))
    };
    let lines: Vec<String> = counts.iter().enumerate().map(bar).collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_in_the_last_tenth() {
        assert_eq!(histogram(&[0.0, 0.05, 0.95, 1.0])[9], 2);
        assert!(bars(&[0; 10]).ends_with('0') || bars(&[0; 10]).ends_with("  "));
    }
}
