//! What the renderer makes.

use super::Picture;

/// A picture and what is seen in it. What was not asked for is empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Frame {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The picture.
    pub color: Picture,
    /// Distance from the eye along the view, world units, pixel by pixel, row by
    /// row from the top left; infinite where nothing is seen. Surfaces that
    /// are blended are seen through.
    pub depth: Vec<f32>,
    /// What is seen, likewise.
    pub hits: Vec<Hit>,
}

/// What a pixel shows at its centre; if it has several samples, at the one just
/// above and to the left of the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index into [`Renderer::instances`](super::Renderer::instances).
    pub instance: u32,
    /// Triangle of the instance's mesh.
    pub triangle: u32,
    /// Weights of the triangle's second and third corner; the first has what is
    /// left to 1.
    pub barycentric: [f32; 2],
}

impl Hit {
    /// Where nothing is seen.
    pub const MISS: Self = Self {
        instance: u32::MAX,
        triangle: u32::MAX,
        barycentric: [0.0; 2],
    };

    /// Whether something is seen.
    #[must_use]
    pub fn is_some(&self) -> bool {
        self.triangle != u32::MAX
    }

    /// Weights of the three corners.
    #[must_use]
    pub fn weights(&self) -> [f32; 3] {
        let [b, c] = self.barycentric;
        [1.0 - b - c, b, c]
    }
}

impl Frame {
    /// What is seen at `x` from the left and `y` from the top.
    #[must_use]
    pub fn hit(&self, x: u32, y: u32) -> Option<Hit> {
        let hit = self.hits.get(self.index(x, y)?)?;
        hit.is_some().then_some(*hit)
    }

    /// Depth at `x` from the left and `y` from the top, if something is seen.
    #[must_use]
    pub fn depth_at(&self, x: u32, y: u32) -> Option<f32> {
        let depth = *self.depth.get(self.index(x, y)?)?;
        depth.is_finite().then_some(depth)
    }

    fn index(&self, x: u32, y: u32) -> Option<usize> {
        let inside = x < self.width && y < self.height;
        inside.then(|| y as usize * self.width as usize + x as usize)
    }
}
