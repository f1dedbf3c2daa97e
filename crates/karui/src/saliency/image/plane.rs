//! One channel of a picture, and what a Gaussian pyramid does to it.

/// Values row by row from the top left.
#[derive(Debug, Clone, Default)]
pub(super) struct Plane {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f32>,
}

impl Plane {
    pub fn zero(width: usize, height: usize) -> Self {
        let values = vec![0.0; width * height];
        Self {
            width,
            height,
            values,
        }
    }

    pub fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..][..self.width]
    }

    /// The next level: weights 1 3 3 1 along both axes, whose centre is that of
    /// the four pixels that become one, so that a mirrored picture of even sides
    /// has the mirrored pyramid. What is outside repeats the border.
    pub fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut out = Self::zero(width, height);
        let mut sum = vec![0.0; self.width];
        for (y, to) in out.values.chunks_exact_mut(width).enumerate() {
            let row = |k: usize| self.row((2 * y + k).saturating_sub(1).min(self.height - 1));
            let outer = row(0).iter().zip(row(3));
            let inner = row(1).iter().zip(row(2));
            for ((s, (a, d)), (b, c)) in sum.iter_mut().zip(outer).zip(inner) {
                *s = weigh(*a, *b, *c, *d);
            }
            halve_row(&sum, to);
        }
        out
    }

    /// The plane interpolated to a finer level, `shift` levels below.
    pub fn enlarged(&self, width: usize, height: usize, shift: u32) -> Self {
        let mut out = Self::zero(width, height);
        let columns: Vec<_> = (0..width)
            .map(|x| between(coarser(x as f32, shift), self.width))
            .collect();
        for (y, to) in out.values.chunks_exact_mut(width).enumerate() {
            let (y0, y1, v) = between(coarser(y as f32, shift), self.height);
            let (above, below) = (self.row(y0), self.row(y1));
            for (to, &(x0, x1, u)) in to.iter_mut().zip(&columns) {
                *to = mix(
                    mix(above[x0], above[x1], u),
                    mix(below[x0], below[x1], u),
                    v,
                );
            }
        }
        out
    }

    pub fn add(&mut self, other: &Self) {
        self.values
            .iter_mut()
            .zip(&other.values)
            .for_each(|(a, b)| *a += b);
    }
}

fn halve_row(from: &[f32], to: &mut [f32]) {
    let at = |k: usize| from[k.min(from.len() - 1)];
    let last = to.len() - 1;
    for x in [0, last] {
        let k = 2 * x;
        to[x] = weigh(at(k.saturating_sub(1)), at(k), at(k + 1), at(k + 2));
    }
    if last > 1 {
        let windows = from[1..].windows(4).step_by(2);
        for (to, w) in to[1..last].iter_mut().zip(windows) {
            *to = weigh(w[0], w[1], w[2], w[3]);
        }
    }
}

#[inline]
fn weigh(a: f32, b: f32, c: f32, d: f32) -> f32 {
    (a + d) * 0.125 + (b + c) * 0.375
}

#[inline]
fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// A pixel's place on the level `shift` above, centres at whole numbers.
pub(super) fn coarser(x: f32, shift: u32) -> f32 {
    (x + 0.5) / (1u32 << shift) as f32 - 0.5
}

fn between(x: f32, size: usize) -> (usize, usize, f32) {
    let x = x.clamp(0.0, (size - 1) as f32);
    let low = x as usize;
    (low, (low + 1).min(size - 1), x - low as f32)
}
