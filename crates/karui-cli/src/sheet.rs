//! Pictures side by side, each with a line of text below.

use crate::text::{self, GLYPH, ink_on};
use karui::render::Picture;

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
        let text: String = text.chars().take(room).collect();
        let start = left + (self.tile.0 - text::width(&text, self.dot)) / 2;
        text::write(sheet, &text, (start, top), self.dot, ink);
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
