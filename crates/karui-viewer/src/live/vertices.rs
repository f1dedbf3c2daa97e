//! Which vertices a page has, and under what number.

use super::frame::Frame;
use super::geometry::Geometry;

/// Not sent yet.
const NONE: u32 = u32::MAX;

/// Numbers of the vertices that have been sent, in the order in which they were.
#[derive(Debug, Clone)]
pub(super) struct Vertices<'a> {
    geometry: &'a Geometry,
    number: Vec<u32>,
    sent: u32,
}

impl<'a> Vertices<'a> {
    pub fn new(geometry: &'a Geometry) -> Self {
        Self {
            geometry,
            number: vec![NONE; geometry.vertex_count()],
            sent: 0,
        }
    }

    /// How many the page has.
    pub fn sent(&self) -> u32 {
        self.sent
    }

    /// The page's number of a vertex, which is sent if it was not before.
    #[inline]
    pub fn number(&mut self, vertex: u32, frame: &mut Frame) -> u32 {
        let number = &mut self.number[vertex as usize];
        if *number == NONE {
            *number = self.sent;
            self.sent += 1;
            let (position, normal) = self.geometry.vertex(vertex);
            frame.vertex(position, normal);
        }
        *number
    }
}
