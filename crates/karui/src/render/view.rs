//! A camera and the pixels it is looked through.

use super::RenderOptions;
use crate::error::Result;
use crate::geom::{Aabb, Camera, DVec3, Projection, Vec3};

/// Pixels beyond which a vertex is cut off rather than rounded to the grid of
/// sub-pixels, where it would overflow.
const GUARD: f64 = (1 << 20) as f64;

/// Takes world positions to sample positions: x to the right and y down from
/// the top left corner, and the distance along the view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Samples a unit at distance 1, or a unit anywhere without perspective.
    focal: f64,
    by_focal: f64,
    center: [f64; 2],
    pub(super) near: f64,
    pub(super) far: f64,
    pub(super) perspective: bool,
    /// Depths at which something is cut; infinite where nothing can be.
    least: f64,
    most: f64,
    rows: [[f64; 4]; 3],
    /// Against the ray through the top left corner, and what a sample to the right
    /// and one downwards add.
    back: [Vec3; 3],
}

/// A position before the division: x and y of the sample times `w`, and the
/// distance along the view, which is `w` with perspective (else that is 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Homogeneous {
    pub x: f64,
    pub y: f64,
    pub depth: f64,
    pub w: f64,
}

impl View {
    /// The view of a camera on something with these bounds.
    ///
    /// # Errors
    /// Those of [`Camera::clip_from_world`].
    pub fn new(camera: &Camera, bounds: Aabb, width: u32, height: u32) -> Result<Self> {
        let axes = camera.axes()?;
        let (near, far) = camera.depth_range(bounds)?;
        let center = [0.5 * f64::from(width), 0.5 * f64::from(height)];
        let perspective = matches!(camera.projection, Projection::Perspective { .. });
        let cut_near = perspective || camera.near.is_some();
        let focal = camera.scale()? * center[1];
        let mut view = Self {
            eye: camera.eye.as_dvec3(),
            right: axes.right,
            up: axes.up,
            forward: axes.forward,
            focal,
            by_focal: 1.0 / focal,
            center,
            near,
            far,
            perspective,
            least: if cut_near { near } else { f64::NEG_INFINITY },
            most: if camera.far.is_some() {
                far
            } else {
                f64::INFINITY
            },
            rows: [[0.0; 4]; 3],
            back: [Vec3::ZERO; 3],
        };
        view.rows = view.world_rows();
        let [corner, right, down] =
            [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| -view.ray(x, y).1);
        view.back = [corner, right - corner, down - corner].map(|v| v.as_vec3());
        Ok(view)
    }

    pub(super) fn of_samples(
        camera: &Camera,
        bounds: Aabb,
        options: &RenderOptions<'_>,
    ) -> Result<Self> {
        let n = options.samples;
        Self::new(camera, bounds, options.width * n, options.height * n)
    }

    /// Rows of the matrix that gives `Homogeneous`' x, y and depth.
    fn world_rows(&self) -> [[f64; 4]; 3] {
        let row = |axis: DVec3| [axis.x, axis.y, axis.z, -axis.dot(self.eye)];
        let (x, y, depth) = (row(self.right), row(-self.up), row(self.forward));
        // The middle of the picture, which goes with w.
        let middle = |axis: [f64; 4], middle: f64| -> [f64; 4] {
            std::array::from_fn(|k| {
                let w = match (self.perspective, k) {
                    (true, _) => depth[k],
                    (false, 3) => 1.0,
                    (false, _) => 0.0,
                };
                self.focal * axis[k] + middle * w
            })
        };
        [middle(x, self.center[0]), middle(y, self.center[1]), depth]
    }

    /// Takes world space to that of a mesh placed by this matrix, given by rows.
    #[inline]
    pub(super) fn homogeneous(&self, p: Vec3) -> Homogeneous {
        let (px, py, pz) = (f64::from(p.x), f64::from(p.y), f64::from(p.z));
        let [x, y, depth] = self.rows.map(|[a, b, c, d]| a * px + b * py + c * pz + d);
        let w = if self.perspective { depth } else { 1.0 };
        Homogeneous { x, y, depth, w }
    }

    /// Where a world position is seen: x and y in pixels and the distance along
    /// the view. `None` before the near or beyond the far plane; what is beside
    /// the picture has a place.
    #[must_use]
    pub fn project(&self, position: Vec3) -> Option<DVec3> {
        let h = self.homogeneous(position);
        let seen = h.depth >= self.near && h.depth <= self.far;
        seen.then(|| DVec3::new(h.x / h.w, h.y / h.w, h.depth))
    }

    /// The ray through x and y: what it passes at distance 0 along the view, and
    /// what it moves by for every unit of that distance.
    #[inline]
    fn ray(&self, x: f32, y: f32) -> (DVec3, DVec3) {
        let by = |at: f32, middle: f64| (f64::from(at) - middle) * self.by_focal;
        let aside = self.right * by(x, self.center[0]) - self.up * by(y, self.center[1]);
        if self.perspective {
            return (self.eye, self.forward + aside);
        }
        (self.eye + aside, self.forward)
    }

    /// What is seen at x and y at a distance along the view.
    pub(super) fn unproject(&self, x: f32, y: f32, depth: f32) -> Vec3 {
        let (from, step) = self.ray(x, y);
        (from + step * f64::from(depth)).as_vec3()
    }

    /// The unit vector to the viewer from what is seen at x and y.
    #[inline]
    pub(super) fn viewer_from(&self, x: f32, y: f32) -> Vec3 {
        let back = self.back[0] + self.back[1] * x + self.back[2] * y;
        back * (1.0 / back.length())
    }

    /// What is compared between surfaces: larger is closer, 0 at the far plane, and
    /// linear over the picture.
    #[inline]
    pub(super) fn closeness(&self, h: &Homogeneous) -> f32 {
        if self.perspective {
            return (1.0 / h.w) as f32;
        }
        ((self.far - h.depth) / (self.far - self.near)) as f32
    }

    /// The distance that a closeness stands for.
    #[inline]
    pub(super) fn depth_of(&self, closeness: f32) -> f32 {
        if self.perspective {
            return 1.0 / closeness;
        }
        (self.far - f64::from(closeness) * (self.far - self.near)) as f32
    }

    /// Signed distances, up to a factor, from the planes that cut: near, far,
    /// and those of the guard band around the picture.
    pub(super) fn inside(&self, h: &Homogeneous) -> [f64; 6] {
        let guard = GUARD * h.w;
        let (near, far) = (h.depth - self.least, self.most - h.depth);
        [
            near,
            far,
            guard + h.x,
            guard - h.x,
            guard + h.y,
            guard - h.y,
        ]
    }

    /// The planes that a position lies outside of, one bit each.
    #[inline]
    pub(super) fn outside(&self, h: &Homogeneous) -> u32 {
        let guard = GUARD * h.w;
        let between = h.depth >= self.least && h.depth <= self.most;
        if between && h.x.abs() <= guard && h.y.abs() <= guard {
            return 0;
        }
        let inside = self.inside(h);
        let bit = |k: usize| if inside[k] >= 0.0 { 0 } else { 1 << k };
        // Behind the near plane, sides mean nothing.
        if bit(0) != 0 {
            return bit(0);
        }
        (1..6).map(bit).fold(0, |all, one| all | one)
    }

    /// The camera's upwards axis.
    pub(super) fn up(&self) -> Vec3 {
        self.up.as_vec3()
    }
}
