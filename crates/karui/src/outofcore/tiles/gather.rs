//! The leaves: triangles of one cell out of all blocks, and the blocks that are made.

use super::super::block::{Block, Head, Part};
use super::super::columns::{attributes, columns};
use super::super::manifest::{Phase, Row};
use super::super::pack::{Contents, pack};
use super::super::weld::weld;
use super::super::{Result, Store};
use crate::mesh::TriMesh;

/// The block of the leaf that `row` names.
///
/// # Errors
/// Those of the store and of damaged blocks.
pub(in super::super) fn leaf(store: &dyn Store, phase: &Phase, row: &Row) -> Result<Vec<u8>> {
    let keys = phase.keys.as_ref().ok_or_else(|| phase.broken("no keys"))?;
    let mut all = Part::default();
    for (name, first, end) in &row.inputs {
        let block = Block::open(store, name)?;
        for mut part in block.pages(*first as usize..*end as usize)? {
            let positions = &part.positions;
            let key = |t: &[u32; 3]| keys.key(t.map(|v| positions[v as usize]));
            part.triangles
                .retain(|t| (row.first..row.end).contains(&key(t)));
            all.append(part);
        }
    }
    let head = Head {
        number: row.id,
        ..Head::default()
    };
    packed(mesh(weld(all)), phase, head)
}

/// A part as a mesh.
pub(super) fn mesh(part: Part) -> TriMesh {
    TriMesh {
        positions: part.positions,
        triangles: part.triangles,
        attributes: attributes(part.columns),
        ..TriMesh::default()
    }
}

/// A mesh as a block.
///
/// # Errors
/// [`super::super::Error::Manifest`] for a phase without keys.
pub(super) fn packed(mesh: TriMesh, phase: &Phase, head: Head) -> Result<Vec<u8>> {
    let columns = columns(mesh.attributes);
    let contents = Contents {
        positions: &mesh.positions,
        triangles: &mesh.triangles,
        columns: &columns,
        costs: None,
        sample: phase.sample,
    };
    let keys = phase.next.as_ref().ok_or_else(|| phase.broken("no keys"))?;
    Ok(pack(&contents, keys, head))
}
