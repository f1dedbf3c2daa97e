//! A decoded picture.

use crate::error::{Error, Result};

/// Pixels, row by row from the top left: sRGB-encoded colour with straight
/// (not premultiplied) alpha, 8 bits a channel.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// A picture of one colour.
    #[must_use]
    pub fn filled(width: u32, height: u32, color: [u8; 4]) -> Self {
        let pixels = vec![color; width as usize * height as usize];
        Self {
            width,
            height,
            pixels,
        }
    }

    /// A picture of these pixels.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] if there are not `width * height` of them.
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 4]>) -> Result<Self> {
        let expected = width as usize * height as usize;
        if pixels.len() != expected {
            return Err(Error::LengthMismatch {
                what: "pixels".into(),
                expected,
                found: pixels.len(),
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Pixels a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top left.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// All pixels, to be changed.
    pub fn pixels_mut(&mut self) -> &mut [[u8; 4]] {
        &mut self.pixels
    }

    /// The pixel at `x` from the left and `y` from the top, if there is one.
    #[must_use]
    pub fn get(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        (x < self.width && y < self.height)
            .then(|| self.pixels[y as usize * self.width as usize + x as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_counted() {
        let black = [0, 0, 0, 255];
        assert!(Picture::new(2, 3, vec![black; 5]).is_err());
        let picture = Picture::new(2, 3, vec![black; 6]);
        assert_eq!(picture, Ok(Picture::filled(2, 3, black)));
    }

    #[test]
    fn there_is_nothing_outside() {
        let mut picture = Picture::filled(2, 3, [0; 4]);
        picture.pixels_mut()[5] = [1, 2, 3, 4];
        assert_eq!(picture.get(1, 2), Some([1, 2, 3, 4]));
        assert_eq!(picture.get(2, 2), None);
        assert_eq!(picture.get(1, 3), None);
    }
}
