//! Is my mesh fit for processing, and if not, what is wrong and what helps?
//!
//! `cargo run --release -p karui --example diagnose_mesh`
#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use karui::mesh::{Halfedge, RepairOptions, diagnose, diagnose_with, repair, shapes};

fn main() -> karui::Result<()> {
    for (name, mesh) in shapes::zoo() {
        mesh.validate()?;
        let report = diagnose(&mesh)?;
        println!(
            "{name}: {} triangles, {} component(s), Euler characteristic {}, {}, {}",
            report.triangles,
            report.components,
            report.euler_characteristic,
            if report.closed { "closed" } else { "open" },
            if report.manifold && report.oriented {
                "manifold"
            } else {
                "NOT manifold"
            },
        );
        if report.manifold && report.oriented && report.degenerate == 0 {
            continue;
        }
        let repaired = repair(&mesh, &RepairOptions::default())?;
        let counts = repaired.counts;
        println!(
            "  repaired: {} degenerate and {} duplicate triangles dropped, {} edges cut open",
            counts.degenerate, counts.duplicates, counts.split_edges,
        );
        let after = diagnose_with(&repaired.mesh, &repaired.ids)?;
        let topology = Halfedge::of_mesh(&repaired.mesh, &repaired.ids)?;
        println!(
            "  now {} component(s), {} half-edges, {} boundary loop(s)",
            after.components,
            topology.halfedge_count(),
            topology.boundary_loops().len(),
        );
    }
    Ok(())
}
