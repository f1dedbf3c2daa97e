//! The figures as Markdown.

mod models;
mod ratio;
mod scaling;
mod summary;

use super::super::page::machine;
use super::inputs::Kind;
use super::{Args, Figures};

/// The whole section of a page.
pub fn markdown(args: &Args, figures: &Figures) -> String {
    let mut text = format!("{}{}\n", HEAD, machine());
    if args.runs > 1 {
        text += &format!(
            "Median of up to {} runs; ratios are of the least.\n",
            args.runs
        );
    }
    for (title, about, kind, rows) in [
        ("Geometry", GEOMETRY, Kind::Geometry, &figures.geometry),
        (
            "Attributes",
            ATTRIBUTES,
            Kind::Attributes,
            &figures.attributes,
        ),
    ] {
        if !rows.is_empty() {
            let tables = [summary::table(rows), models::table(kind, rows)];
            let tables: String = tables
                .iter()
                .flatten()
                .map(|t| format!("\n{t}\n"))
                .collect();
            text += &format!("\n### {title}\n{about}{tables}");
        }
    }
    if !figures.scaling.is_empty() {
        let table = scaling::table(&figures.scaling);
        text += &format!("\n### Size\n{SIZE}\n{table}\n");
    }
    text
}

const HEAD: &str = "\
## Simplification compared

Written by `karui bench simplify -o FILE` (release build). meshoptimizer runs in the same process,
in turn with ours: `cargo run --release -p karui-cli --features peers -- bench simplify --peers`,
which needs a C++ compiler.

- ms: one call, on the clock on the wall; CPU ms: of all threads. The mesh is in memory before.
- mean, RMS, max: measured two-sided distance, the worse direction, in 1e-4 of the diagonal.
- flips: triangles that face away from the nearest point of the original, beyond those of the
  original compared with itself. non-m.: edges with more than two triangles, beyond the original's.
- border: largest distance between the open borders, in 1e-4 of the diagonal.
- MB: growth of the process at most, in a process of its own.
- ÷: ours divided by meshoptimizer's. **Bold**: where ours does not win, or leaves what it should
  not: a ratio above 1, an error with more triangles than the target and the other have, more than
  1 % of triangles too many, a flip, a non-manifold edge, a border that moved farther than the
  surface.

";

const GEOMETRY: &str = "\
Vertices at one place joined, no attributes. ÷ is to `simplifyWithUpdate`, the closest of them, for
clustering to `simplifySloppy`.
";

const ATTRIBUTES: &str = "\
Normals and the first texture coordinates as the model has them; meshoptimizer's weights are 0.5 for
normals and 1 for texture coordinates. normal: mean angle in degrees between the interpolated
normals of nearest points; UV: mean distance in 1e-4 between their texture coordinates, within a
chart. ÷ is to `simplifyWithUpdate` with attributes.
";

const SIZE: &str = "\
Made-up land, equally rough at every size, to 10 %, each in a process of its own; what takes more
than a minute is not run on more. ÷ smallest: nanoseconds a triangle in relation to the smallest;
÷ time, ÷ MB: to `simplifyWithUpdate`, for clustering to `simplifySloppy`.
";
