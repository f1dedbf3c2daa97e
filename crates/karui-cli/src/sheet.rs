//! Pictures side by side, each with a line of text below.

use font8x8::legacy::BASIC_LEGACY;
use karui::render::Picture;

const GLYPH: u32 = 8;
/// Most tiles in a row.
const COLUMNS: u32 = 4;

/// Places of tiles on a sheet, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    tile: (u32, u32),
    columns: u32,
    rows: u32,
    /// Pixels a dot of the font is high and wide.
    dot: u32,
}

impl Layout {
    /// For `count` tiles of this size.
    pub fn new(count: usize, tile: (u32, u32)) -> Self {
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        let columns = count.clamp(1, COLUMNS);
        Self {
            tile,
            columns,
            rows: count.div_ceil(columns),
            dot: (tile.0 / 384).clamp(1, 8),
        }
    }

    /// Width and height of the sheet.
    pub fn size(&self) -> (u64, u64) {
        let height = u64::from(self.tile.1) + u64::from(self.caption_height());
        let width = u64::from(self.columns) * u64::from(self.tile.0);
        (width, u64::from(self.rows) * height)
    }

    /// A line and half a line above and below.
    fn caption_height(&self) -> u32 {
        2 * GLYPH * self.dot
    }

    /// A sheet of `tiles` with their captions.
    pub fn draw(&self, tiles: &[(Picture, String)], background: [u8; 4]) -> Picture {
        let (width, height) = self.size();
        let mut sheet = Picture::filled(width as u32, height as u32, background);
        let ink = ink_on(background);
        for (i, (tile, caption)) in (0..).zip(tiles) {
            let left = i % self.columns * self.tile.0;
            let top = i / self.columns * (self.tile.1 + self.caption_height());
            paste(&mut sheet, tile, left, top);
            let top = top + self.tile.1 + self.dot * GLYPH / 2;
            self.write(&mut sheet, caption, (left, top), ink);
        }
        sheet
    }

    /// Text in the middle of a tile; what does not fit is cut off.
    fn write(&self, sheet: &mut Picture, text: &str, (left, top): (u32, u32), ink: [u8; 4]) {
        let advance = GLYPH * self.dot;
        let room = (self.tile.0 / advance) as usize;
        let text: Vec<char> = text.chars().take(room).collect();
        let start = left + (self.tile.0 - text.len() as u32 * advance) / 2;
        for (i, &c) in (0..).zip(&text) {
            let at = (start + i * advance, top);
            self.glyph(sheet, c, at, ink);
        }
    }

    fn glyph(&self, sheet: &mut Picture, c: char, (left, top): (u32, u32), ink: [u8; 4]) {
        let unknown = BASIC_LEGACY['?' as usize];
        let rows = BASIC_LEGACY.get(c as usize).copied().unwrap_or(unknown);
        let side = GLYPH * self.dot;
        let (width, height) = (sheet.width(), sheet.height());
        for y in 0..side {
            for x in 0..side {
                let on = rows[(y / self.dot) as usize] >> (x / self.dot) & 1 == 1;
                let (x, y) = (left + x, top + y);
                if on && x < width && y < height {
                    sheet.pixels_mut()[y as usize * width as usize + x as usize] = ink;
                }
            }
        }
    }
}

fn paste(sheet: &mut Picture, tile: &Picture, left: u32, top: u32) {
    let (wide, width) = (sheet.width() as usize, tile.width() as usize);
    let rows = tile.pixels().chunks_exact(width.max(1));
    for (y, row) in (top as usize..).zip(rows) {
        let start = y * wide + left as usize;
        sheet.pixels_mut()[start..start + width].copy_from_slice(row);
    }
}

/// Black or white, whichever is told better from the background; black where
/// one sees through it.
fn ink_on([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    let light = 2 * u32::from(r) + 5 * u32::from(g) + u32::from(b);
    match a >= 128 && light < 8 * 128 {
        true => [255; 4],
        false => [0, 0, 0, 255],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_lie_side_by_side_and_then_below() {
        let sizes = [1, 2, 4, 5].map(|n| Layout::new(n, (100, 50)).size());
        assert_eq!(sizes, [(100, 66), (200, 66), (400, 66), (400, 132)]);
    }

    #[test]
    fn captions_stay_below_their_tiles() {
        let layout = Layout::new(2, (64, 40));
        let white = [255; 4];
        let tile = |text: &str| (Picture::filled(64, 40, [9, 9, 9, 255]), text.to_owned());
        let tiles = [tile("far too long for it"), tile("")];
        let sheet = layout.draw(&tiles, white);
        let is_white = |x, y| sheet.get(x, y) == Some(white);
        assert!((0..128).all(|x| (0..40).all(|y| !is_white(x, y))));
        assert!((0..64).any(|x| (40..56).any(|y| !is_white(x, y))));
        assert!((64..128).all(|x| (40..56).all(|y| is_white(x, y))));
    }
}
