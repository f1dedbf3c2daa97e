//! The triangles of a block, cut at the faces of the smallest cells.

use super::super::block::{Block, Head, Part};
use super::super::manifest::{Phase, Row};
use super::super::weld::weld;
use super::super::{Result, Store};
use super::cut::cut;
use super::gather::{mesh, packed};

/// The block of the pieces of the block that `row` names.
///
/// # Errors
/// Those of the store and of damaged blocks.
pub(in super::super) fn pieces(store: &dyn Store, phase: &Phase, row: &Row) -> Result<Vec<u8>> {
    let keys = phase.keys.as_ref().ok_or_else(|| phase.broken("no keys"))?;
    let planes = keys.planes(phase.level);
    let mut all = Part::default();
    for (name, first, end) in &row.inputs {
        let block = Block::open(store, name)?;
        for mut part in block.pages(*first as usize..*end as usize)? {
            cut(&mut part, &planes);
            all.append(part);
        }
    }
    let head = Head {
        number: row.id,
        ..Head::default()
    };
    packed(mesh(weld(all)), phase, head)
}
