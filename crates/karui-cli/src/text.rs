//! Text in pictures, and what it says about colours.

use font8x8::legacy::BASIC_LEGACY;
use karui::render::{Picture, heat_table};

/// Dots a letter is wide and high.
pub const GLYPH: u32 = 8;

/// Pixels a line of text takes, of dots of so many.
pub fn width(text: &str, dot: u32) -> u32 {
    text.chars().count() as u32 * GLYPH * dot
}

/// A line of text from a corner to the right and down; what does not fit into
/// the picture is cut off.
pub fn write(picture: &mut Picture, text: &str, (left, top): (u32, u32), dot: u32, ink: [u8; 4]) {
    for (i, c) in (0..).zip(text.chars()) {
        glyph(picture, c, (left + i * GLYPH * dot, top), dot, ink);
    }
}

fn glyph(picture: &mut Picture, c: char, (left, top): (u32, u32), dot: u32, ink: [u8; 4]) {
    let unknown = BASIC_LEGACY['?' as usize];
    let rows = BASIC_LEGACY.get(c as usize).copied().unwrap_or(unknown);
    let side = GLYPH * dot;
    for y in 0..side {
        for x in 0..side {
            if rows[(y / dot) as usize] >> (x / dot) & 1 == 1 {
                set(picture, (left + x, top + y), ink);
            }
        }
    }
}

fn set(picture: &mut Picture, (x, y): (u32, u32), color: [u8; 4]) {
    let (width, height) = (picture.width(), picture.height());
    if x < width && y < height {
        picture.pixels_mut()[y as usize * width as usize + x as usize] = color;
    }
}

/// Black or white, whichever is told better from the background; black where
/// one sees through it.
pub fn ink_on([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    let light = 2 * u32::from(r) + 5 * u32::from(g) + u32::from(b);
    match a >= 128 && light < 8 * 128 {
        true => [255; 4],
        false => [0, 0, 0, 255],
    }
}

/// What the colours of [`heat_table`] stand for: a bar along the lower edge with the
/// values at its ends, and their unit.
pub fn legend(picture: &mut Picture, [low, high]: [&str; 2], unit: &str, background: [u8; 4]) {
    let dot = (picture.width() / 512).clamp(1, 4);
    let (line, margin) = (GLYPH * dot, 4 * dot);
    let ink = ink_on(background);
    let wide = picture.width().saturating_sub(2 * margin);
    let top = picture.height().saturating_sub(2 * line + 2 * margin);
    let table = heat_table();
    for x in 0..wide {
        let [r, g, b] = table[(x * 255 / wide.max(1)) as usize];
        for y in 0..line {
            set(picture, (margin + x, top + y), [r, g, b, 255]);
        }
    }
    let top = top + line + margin / 2;
    write(picture, low, (margin, top), dot, ink);
    let right = |text: &str| (margin + wide).saturating_sub(width(text, dot));
    write(picture, high, (right(high), top), dot, ink);
    let middle = (picture.width() - width(unit, dot).min(picture.width())) / 2;
    write(picture, unit, (middle, top), dot, ink);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_goes_from_dark_to_bright_and_names_its_unit() {
        let white = [255; 4];
        let mut picture = Picture::filled(256, 64, white);
        legend(&mut picture, ["0", "2"], "mm", white);
        let row: Vec<[u8; 4]> = (4..252).filter_map(|x| picture.get(x, 42)).collect();
        let light = |c: &[u8; 4]| u32::from(c[0]) + u32::from(c[1]) + u32::from(c[2]);
        assert!(light(&row[0]) < light(&row[row.len() - 1]));
        let ink = picture.pixels().iter().filter(|p| **p == [0, 0, 0, 255]);
        assert!(ink.count() > 30);
    }

    #[test]
    fn small_pictures_hold_what_fits() {
        for side in [1, 5, 20] {
            let mut picture = Picture::filled(side, side, [0; 4]);
            legend(&mut picture, ["0", "1"], "metres", [0; 4]);
            write(&mut picture, "text", (side - 1, 0), 3, [255; 4]);
        }
    }
}
