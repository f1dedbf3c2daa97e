//! Curves as an SVG file.

use std::fmt::Write as _;

/// Size of the drawing, and of what surrounds the curves: left, top, right, bottom.
const SIZE: [f64; 2] = [640.0, 400.0];
const MARGIN: [f64; 4] = [60.0, 20.0, 20.0, 50.0];

/// A named curve; points go from left to right.
pub struct Curve {
    pub name: String,
    /// As SVG has it.
    pub color: &'static str,
    pub points: Vec<[f64; 2]>,
}

/// Curves over the same axes, which start at 0; the axes are named.
pub fn svg(curves: &[Curve], names: [&str; 2]) -> String {
    let all = || curves.iter().flat_map(|c| &c.points);
    let most = |axis: usize| all().map(|p| p[axis]).fold(f64::MIN_POSITIVE, f64::max);
    let (steps, most) = ([0, 1].map(|axis| step(most(axis))), [most(0), most(1)]);
    let most = [0, 1].map(|axis| (most[axis] / steps[axis]).ceil() * steps[axis]);
    let [left, top, right, bottom] = MARGIN;
    let (width, height) = (SIZE[0] - left - right, SIZE[1] - top - bottom);
    let x = |value: f64| left + width * value / most[0];
    let y = |value: f64| top + height * (1.0 - value / most[1]);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        SIZE[0], SIZE[1]
    );
    for (axis, step) in steps.into_iter().enumerate() {
        for i in 0..=(most[axis] / step).round() as u32 {
            let value = f64::from(i) * step;
            text += &match axis {
                0 => tick([x(value), top], [x(value), top + height], value, "middle"),
                _ => tick([left + width, y(value)], [left, y(value)], value, "end"),
            };
        }
    }
    for (i, curve) in curves.iter().enumerate() {
        let place = |p: &[f64; 2]| format!("{:.1},{:.1}", x(p[0]), y(p[1]));
        let points: Vec<String> = curve.points.iter().map(place).collect();
        let (color, down) = (curve.color, top + 18.0 * (i as f64 + 1.0));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "<polyline fill=\"none\" stroke=\"{color}\" stroke-width=\"2\" points=\"{}\"/>\n\
             <text x=\"{}\" y=\"{down}\" fill=\"{color}\" text-anchor=\"end\">{}</text>",
            points.join(" "),
            left + width - 8.0,
            curve.name
        );
    }
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
         <text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n</svg>",
        left + 0.5 * width,
        SIZE[1] - 12.0,
        names[0],
        top + 0.5 * height,
        names[1]
    );
    text
}

/// A grid line from one point to another, which is where its value stands.
fn tick(from: [f64; 2], to: [f64; 2], value: f64, anchor: &str) -> String {
    let value = (value * 1e9).round() / 1e9;
    let (x, y) = match anchor {
        "middle" => (to[0], to[1] + 16.0),
        _ => (to[0] - 6.0, to[1] + 4.0),
    };
    format!(
        "<path stroke=\"#ddd\" d=\"M{:.1} {:.1}L{:.1} {:.1}\"/>\
         <text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{value}</text>\n",
        from[0], from[1], to[0], to[1]
    )
}

/// 1, 2 or 5 times a power of ten, so that there are four to ten steps.
fn step(most: f64) -> f64 {
    let power = 10f64.powf((most / 10.0).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|s| s * power);
    let few = steps.into_iter().find(|s| most / s <= 10.0 + 1e-9);
    few.unwrap_or(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (most, expected) in [(384.0, 50.0), (0.03, 0.005), (1.0, 0.1), (10.1, 2.0)] {
            assert!(
                (step(most) / expected - 1.0).abs() < 1e-9,
                "{most} {}",
                step(most)
            );
        }
    }

    #[test]
    fn curves_lie_between_the_axes() {
        let curve = Curve {
            name: "a".into(),
            color: "#000",
            points: vec![[0.0, 100.0], [1.0, 0.0]],
        };
        let text = svg(&[curve], ["x", "y"]);
        assert!(text.contains("points=\"60.0,20.0 620.0,350.0\""), "{text}");
    }
}
