//! One frame: vertices, then triangles, then bands of rows.

use super::bins::{BAND, Bins, Entry, Kind, Picked, Treatment};
use super::edges::Window;
use super::geometry::Geometry;
use super::options::{Faces, RenderOptions};
use super::place::{Place, Steps};
use super::project::{Corner, project};
use super::renderer::Renderer;
use super::view::{Homogeneous, View};
use crate::error::Result;
use crate::geom::Camera;

/// What a frame needs before its bands can be drawn.
pub(super) struct Pass<'a> {
    pub view: View,
    pub geometry: &'a Geometry<'a>,
    pub picture: Window,
    corners: Vec<Corner>,
    bins: Bins,
}

impl<'a> Pass<'a> {
    pub(super) fn new(
        renderer: &'a Renderer<'a>,
        camera: &Camera,
        options: &RenderOptions<'_>,
    ) -> Result<Self> {
        let geometry = &renderer.geometry;
        let view = View::of_samples(camera, geometry.bounds, options)?;
        let corners = project(&view, geometry);
        let samples = |pixels: u32| 0..(pixels * options.samples) as i32;
        let picked = Picked {
            view: &view,
            geometry,
            corners: &corners,
            treatments: &treatments(renderer, options),
            picture: Window {
                columns: samples(options.width),
                rows: samples(options.height),
            },
        };
        let bins = picked.bins();
        let picture = picked.picture;
        Ok(Self {
            view,
            geometry,
            picture,
            corners,
            bins,
        })
    }

    /// Number of bands.
    pub(super) fn bands(&self) -> usize {
        (self.picture.rows.end as usize).div_ceil(BAND as usize)
    }

    /// Triangles of a kind in a band, list by list.
    pub(super) fn binned(&self, band: usize, kind: Kind) -> impl Iterator<Item = &[Entry]> {
        self.bins
            .iter()
            .map(move |chunk| &chunk[band][kind as usize][..])
    }

    #[inline]
    pub(super) fn corners_of(&self, t: u32) -> [Corner; 3] {
        let vertices = self.geometry.vertices_of(t);
        vertices.map(|v| self.corners[v as usize])
    }

    /// Where on a triangle a sample lies that it covers.
    #[inline]
    pub(super) fn place(&self, t: u32, column: i32, row: i32) -> Place {
        let corners = self.corners_of(t);
        if corners.iter().all(|c| c.outside == 0) {
            return Place::of_corners(&self.view, &corners, column, row);
        }
        let corners = self.geometry.homogeneous(&self.view, t);
        Place::of_homogeneous(&corners, column, row)
    }
}

impl Pass<'_> {
    /// See [`Steps`].
    pub(super) fn steps(&self, t: u32) -> Steps {
        let corners = self.corners_of(t);
        if corners.iter().all(|c| c.outside == 0) {
            return Steps::of_corners(&corners);
        }
        Steps::of_homogeneous(&self.geometry.homogeneous(&self.view, t))
    }
}

impl Geometry<'_> {
    pub(super) fn homogeneous(&self, view: &View, t: u32) -> [Homogeneous; 3] {
        self.positions_of(t).map(|p| view.homogeneous(p))
    }
}

fn treatments(renderer: &Renderer<'_>, options: &RenderOptions<'_>) -> Vec<Treatment> {
    let parts = renderer.geometry.parts.iter();
    parts
        .map(|part| {
            let material = renderer.material(part);
            let one_sided = match options.faces {
                Faces::ByMaterial => !material.double_sided,
                Faces::Both => false,
                Faces::Front => true,
            };
            // Fronts run counter-clockwise, that is, their areas are negative.
            Treatment {
                kind: material.kind(options),
                back: if part.mirrored { -1 } else { 1 },
                two_sided: !one_sided,
            }
        })
        .collect()
}
