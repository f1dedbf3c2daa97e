//! The figures of `karui bench saliency` as Markdown.

use crate::commands::bench::page::machine;
use crate::table::{count, table};
use karui::Scene;
use serde::Serialize;

/// One result.
#[derive(Debug, Serialize)]
pub struct Row {
    pub model: String,
    /// Triangles asked for.
    pub triangles: usize,
    pub method: String,
    /// Triangles left.
    pub left: usize,
    /// RMS distance from the most salient surface, as a share of the diagonal.
    pub salient: f64,
    /// From the whole surface.
    pub whole: f64,
    /// Mean FLIP over the views.
    pub flip: f64,
    /// Mean RMSE over the views.
    pub rmse: f64,
}

/// How long saliency takes.
#[derive(Debug, Serialize)]
pub struct Times {
    pub model: String,
    pub triangles: usize,
    pub vertices: usize,
    /// By kind.
    pub seconds: Vec<(String, f64)>,
}

impl Times {
    pub fn new(model: &str, scene: &Scene) -> Self {
        Self {
            model: model.to_owned(),
            triangles: scene.triangle_count(),
            vertices: scene.meshes.iter().map(|m| m.mesh.positions.len()).sum(),
            seconds: Vec::new(),
        }
    }
}

/// Largest ratio to plain simplification that is asked for, on the salient surface...
const SALIENT: f64 = 0.7;
/// ...and on all of it.
const WHOLE: f64 = 1.6;

/// Both tables.
pub fn markdown(views: u32, size: u32, rows: &[Row], times: &[Times]) -> String {
    format!(
        "## Saliency and what it is good for\n\n\
         Written by `karui bench saliency FILES -o FILE` (release build).\n\n\
         - salient: RMS distance from the fifth of the original's surface that is most salient by\n  \
         hybrid saliency, in 1e-4 of the diagonal; all: from all of it.\n\
         - FLIP, RMSE: difference to pictures of the original, mean of {views} views of {size} x \
         {size}\n  pixels that the saliency has not seen, times 1000.\n\
         - ÷: divided by plain simplification. **Bold**: above {SALIENT} on the salient surface, above\n  \
         {WHOLE} on all, or a picture that is not closer.\n\n{}\n\n{}\n\n\
         Seconds for the saliency of all vertices:\n\n{}\n",
        machine(),
        results(rows),
        durations(times),
    )
}

fn results(rows: &[Row]) -> String {
    let header = [
        "model",
        "triangles",
        "weights",
        "left",
        "salient",
        "÷",
        "all",
        "÷",
        "FLIP",
        "÷",
        "RMSE",
        "÷",
    ];
    let mut plain = None;
    let mut cells = Vec::new();
    for row in rows {
        if row.method == "plain" {
            plain = Some(row);
        }
        let mut line = vec![
            format!("`{}`", row.model),
            count(row.triangles),
            row.method.clone(),
            count(row.left),
        ];
        let of = |pick: fn(&Row) -> f64| (pick(row), plain.map(pick));
        let parts = [
            (of(|r| r.salient * 1e4), SALIENT),
            (of(|r| r.whole * 1e4), WHOLE),
            (of(|r| r.flip * 1e3), 1.0),
            (of(|r| r.rmse * 1e3), 1.0),
        ];
        for ((value, plain), most) in parts {
            line.push(format!("{value:.2}"));
            line.push(match plain {
                Some(plain) if row.method != "plain" => ratio(value / plain, most),
                _ => String::new(),
            });
        }
        cells.push(line);
    }
    table(&header, &cells, true)
}

fn ratio(ratio: f64, most: f64) -> String {
    match ratio <= most {
        true => format!("{ratio:.2}"),
        false => format!("**{ratio:.2}**"),
    }
}

fn durations(times: &[Times]) -> String {
    let kinds = times.first().map_or(&[][..], |t| &t.seconds);
    let mut header = vec!["model", "triangles", "vertices"];
    header.extend(kinds.iter().map(|k| k.0.as_str()));
    let cells: Vec<Vec<String>> = times
        .iter()
        .map(|time| {
            let name = format!("`{}`", time.model);
            let mut line = vec![name, count(time.triangles), count(time.vertices)];
            line.extend(time.seconds.iter().map(|s| format!("{:.2}", s.1)));
            line
        })
        .collect();
    table(&header, &cells, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_that_are_missed_are_bold() {
        let row = |method: &str, salient, flip| Row {
            model: "m".into(),
            triangles: 10,
            method: method.into(),
            left: 10,
            salient,
            whole: 1.0,
            flip,
            rmse: 1.0,
        };
        let rows = [row("plain", 1.0, 1.0), row("mesh x3", 0.6, 1.25)];
        let text = markdown(64, 512, &rows, &[]);
        assert!(text.contains("| 0.60 |"), "{text}");
        assert!(text.contains("**1.25**"), "{text}");
    }
}
