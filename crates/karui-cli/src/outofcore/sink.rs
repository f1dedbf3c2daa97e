//! The result as a PLY file.

use anyhow::Result;
use karui::mesh::Attributes;
use karui::outofcore::{self, Error, Sink, Vertices};
use karui_io::slices::PlyWriter;
use std::path::Path;

/// A PLY file that is written in pieces.
pub struct PlySink(PlyWriter);

impl PlySink {
    /// Starts the file that is to become `target`.
    pub fn create(target: &Path) -> Result<Self> {
        Ok(Self(PlyWriter::create(target)?))
    }

    /// Puts the file in its place.
    pub fn finish(self) -> Result<u64> {
        Ok(self.0.finish()?)
    }
}

impl Sink for PlySink {
    fn begin(&mut self, _: u64, _: u64, _: &Attributes) -> outofcore::Result<()> {
        Ok(())
    }

    fn vertices(&mut self, vertices: &Vertices) -> outofcore::Result<()> {
        let written = self.0.write_vertices(vertices.clone());
        written.map_err(|error| Error::Sink(Box::new(error)))
    }

    fn triangles(&mut self, triangles: &[[u64; 3]]) -> outofcore::Result<()> {
        let written = self.0.write_triangles(triangles);
        written.map_err(|error| Error::Sink(Box::new(error)))
    }
}
