//! A session over a half-edge hierarchy.

use super::frame::{FLAG_COMPLETE, FLAG_TRUNCATED, Frame, Header, Kind};
use super::geometry::Geometry;
use super::request::{Order, Request};
use super::slots::Slots;
use super::vertices::Vertices;
use super::{Result, Session};
use karui::geom::{Camera, Light};
use karui::hierarchy::{Change, Cut, Hierarchy, Silhouette, ViewAndLight};
use serde::Deserialize;
use std::time::Instant;

/// What is kept: the fields of [`ViewAndLight`], with its defaults.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct HalfEdgeOptions {
    /// Least area on the screen, square pixels.
    pub area: f64,
    /// Least angle between normals, degrees.
    pub flatness: f64,
    /// Silhouettes are kept down to this area, square pixels; none: they count as all else.
    pub silhouette: Option<f64>,
    /// The same where light and dark part.
    pub light_silhouette: Option<f64>,
    /// Degrees between the mirrored light and the eye; 0 turns it off.
    pub highlight: f64,
    /// Highlights are kept down to this area, square pixels.
    pub highlight_area: f64,
    /// Whether what is outside the picture is coarse.
    pub frustum: bool,
    /// Whether what faces away is coarse.
    pub back_facing: bool,
}

impl Default for HalfEdgeOptions {
    fn default() -> Self {
        let defaults = ViewAndLight::default();
        let least = |s| match s {
            Silhouette::Ignored => None,
            Silhouette::Kept { area } => Some(area),
        };
        Self {
            area: defaults.area,
            flatness: defaults.flatness,
            silhouette: least(defaults.silhouette),
            light_silhouette: least(defaults.light_silhouette),
            highlight: defaults.highlight,
            highlight_area: defaults.highlight_area,
            frustum: defaults.frustum,
            back_facing: defaults.back_facing,
        }
    }
}

impl HalfEdgeOptions {
    /// The tests for one frame.
    #[must_use]
    pub fn criteria(&self, camera: Camera, lights: Vec<Light>, size: [u32; 2]) -> ViewAndLight {
        let least = |area: Option<f64>| match area {
            None => Silhouette::Ignored,
            Some(area) => Silhouette::Kept { area },
        };
        ViewAndLight {
            camera,
            size,
            lights,
            frustum: self.frustum,
            back_facing: self.back_facing,
            silhouette: least(self.silhouette),
            area: self.area,
            flatness: self.flatness,
            light_silhouette: least(self.light_silhouette),
            highlight: self.highlight,
            highlight_area: self.highlight_area,
            ..ViewAndLight::default()
        }
    }
}

/// One page's cut of a half-edge hierarchy.
#[derive(Debug, Clone)]
pub struct HalfEdgeSession<'a> {
    cut: Cut<'a>,
    vertices: Vertices<'a>,
    slots: Slots<3>,
    order: Order,
}

impl<'a> HalfEdgeSession<'a> {
    /// Starts with nothing sent. `geometry` is that of the mesh which `hierarchy` was built
    /// from.
    ///
    /// # Errors
    /// [`karui::Error::LengthMismatch`] if it has not as many vertices.
    pub fn new(geometry: &'a Geometry, hierarchy: &'a Hierarchy) -> karui::Result<Self> {
        let (expected, found) = (hierarchy.vertex_count(), geometry.vertex_count());
        if expected != found {
            let what = "positions".into();
            return Err(karui::Error::LengthMismatch {
                what,
                expected,
                found,
            });
        }
        Ok(Self {
            cut: hierarchy.coarsest(),
            vertices: Vertices::new(geometry),
            slots: Slots::new(),
            order: Order::default(),
        })
    }

    /// The cut that was sent last.
    #[must_use]
    pub fn cut(&self) -> &Cut<'a> {
        &self.cut
    }

    /// Writes the slots in the ranges that have changed, all of them the first time.
    fn write(&mut self, change: &Change, frame: &mut Frame) {
        let indices = self.cut.indices();
        let ranges = match self.vertices.sent() {
            0 => std::iter::once(0..indices.len() as u32).collect(),
            _ => change.ranges.clone(),
        };
        let mut runs = self.slots.resize(indices.len());
        for at in ranges.into_iter().flatten() {
            let corners = indices[at as usize];
            let numbers = corners.map(|v| self.vertices.number(v, frame));
            runs.set(at as usize, numbers);
        }
        runs.write(frame);
    }
}

impl Session for HalfEdgeSession<'_> {
    fn answer(&mut self, message: &str) -> Result<Vec<u8>> {
        let started = Instant::now();
        let request: Request<HalfEdgeOptions> = Request::parse(message)?;
        self.order.check(request.seq)?;
        let (camera, lights) = request.view()?;
        let criteria = request.options.criteria(camera, lights, request.size);
        let change = self.cut.refine(&criteria, request.budget.resolve()?)?;
        self.order.answered(request.seq);
        let known = self.vertices.sent();
        let mut frame = Frame::default();
        self.write(&change, &mut frame);
        let complete = if change.complete { FLAG_COMPLETE } else { 0 };
        let truncated = if change.floor > 0.0 {
            FLAG_TRUNCATED
        } else {
            0
        };
        let header = Header {
            kind: Kind::HalfEdge,
            seq: request.seq,
            flags: complete | truncated,
            triangles: change.triangles,
            microseconds: started.elapsed().as_micros(),
            changes: [change.splits, change.collapses],
            level: change.floor,
        };
        Ok(frame.finish(&header, known))
    }
}
