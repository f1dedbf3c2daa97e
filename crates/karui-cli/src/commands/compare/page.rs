//! The report of `karui compare`: one HTML file that holds all it shows.

use super::{Args, Found, decibels};
use crate::output::Staged;
use crate::table::{number, percent};
use anyhow::Result;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use karui::render::Picture;
use karui_viewer::LOOK;
use std::fmt::Write as _;

/// What the pictures of a view are called.
const NAMES: [(&str, &str); 4] = [
    ("a", "A"),
    ("b", "B"),
    (
        "flip",
        "where they look different (FLIP: black is 0, pale yellow 1)",
    ),
    ("distance", "A, by its distance to B"),
];

/// Pictures one sees through have black legends, hence the light ground.
const STYLE: &str = "body{max-width:72em;margin:2em auto;padding:0 1.2em}\
h1{font-size:1.4em}h2{font-size:1.1em;margin-top:2em}\
table{border-collapse:collapse;margin:1.2em 0;font-variant-numeric:tabular-nums}\
td,th{padding:.3em .9em;text-align:right;border-bottom:1px solid var(--line)}\
th{color:var(--quiet);font-weight:400}td:first-child,th:first-child{text-align:left}\
.v{display:grid;grid-template-columns:repeat(auto-fit,minmax(15em,1fr));gap:1em}\
figure{margin:0}img{width:100%;background:#c9ced6;border-radius:var(--radius)}\
figcaption{color:var(--quiet)}";

/// Writes report.html and its pictures.
pub fn write(
    staged: &Staged,
    args: &Args,
    found: &Found,
    looks: &[(usize, [Picture; 4])],
) -> Result<()> {
    let mut views = String::new();
    for (view, pictures) in looks {
        let flip = number(found.views[*view].flip);
        write!(
            views,
            "<h2>View {view}: FLIP {flip}</h2>\n<div class=\"v\">"
        )?;
        for ((name, caption), picture) in NAMES.iter().zip(pictures) {
            let png = karui_io::encode_png(picture)?;
            staged.bytes(&format!("view-{view:03}-{name}.png"), &png)?;
            let data = STANDARD.encode(&png);
            write!(
                views,
                "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{data}\">\
                 <figcaption>{caption}</figcaption></figure>"
            )?;
        }
        views.push_str("</div>\n");
    }
    let [a, b] = [&args.a, &args.b].map(|path| escaped(&path.display().to_string()));
    let html = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>{a} and {b}</title>\n\
         <style>{LOOK}{STYLE}</style>\n<h1>A: {a}<br>B: {b}</h1>\n{}\n{}\n{views}</html>\n",
        distances(found),
        differences(found),
    );
    staged.bytes("report.html", html.as_bytes())
}

fn distances(found: &Found) -> String {
    let distance = &found.distance;
    let row = |name: &str, [max, mean, rms]: [f64; 3]| {
        let share = |x: f64| percent(x / distance.diagonal);
        format!(
            "<tr><td>{name}<td>{}<td>{}<td>{}<td>{}<td>{}",
            number(max),
            number(mean),
            number(rms),
            share(max),
            share(rms)
        )
    };
    let (to, back) = (&distance.a_to_b, &distance.b_to_a);
    format!(
        "<table><tr><th>distance, model units<th>max<th>mean<th>RMS<th>max/diagonal\
         <th>RMS/diagonal{}{}{}</table>",
        row("A to B", [to.max, to.mean, to.rms]),
        row("B to A", [back.max, back.mean, back.rms]),
        row(
            "two-sided",
            [distance.max(), distance.mean(), distance.rms()]
        ),
    )
}

fn differences(found: &Found) -> String {
    let mean = ("mean".to_owned(), &found.mean);
    let views = found.views.iter().enumerate();
    let all = views.map(|(i, view)| (format!("view {i}"), view));
    let rows: String = std::iter::once(mean)
        .chain(all)
        .map(|(name, d)| {
            let [flip, rmse, ssim] = [d.flip, d.rmse, d.ssim].map(number);
            let psnr = decibels(d.psnr);
            format!("<tr><td>{name}<td>{flip}<td>{rmse}<td>{psnr}<td>{ssim}")
        })
        .collect();
    format!("<table><tr><th>pictures<th>FLIP<th>RMSE<th>PSNR, dB<th>SSIM{rows}</table>")
}

/// Text for HTML.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_end_a_tag() {
        assert_eq!(
            escaped("<a href=\"b&c\">"),
            "&lt;a href=&quot;b&amp;c&quot;&gt;"
        );
    }
}
