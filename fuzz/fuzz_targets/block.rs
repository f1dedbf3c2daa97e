//! Blocks of work out of core, whatever they hold: an error or triangles, never a panic.

#![no_main]

use karui::outofcore::{Error, Result, Store, checksum, verify_block};
use libfuzzer_sys::fuzz_target;
use std::ops::Range;

/// A store with one object.
struct One(Vec<u8>);

impl Store for One {
    fn get(&self, _: &str) -> Result<Vec<u8>> {
        Ok(self.0.clone())
    }

    fn get_range(&self, name: &str, range: Range<u64>) -> Result<Vec<u8>> {
        let part = self.0.get(range.start as usize..range.end as usize);
        part.map(<[u8]>::to_vec).ok_or_else(|| Error::Damaged {
            name: name.into(),
            problem: "it ends early",
        })
    }

    fn put(&self, _: &str, _: &[u8]) -> Result<()> {
        Ok(())
    }

    fn exists(&self, _: &str) -> Result<bool> {
        Ok(true)
    }

    fn list(&self) -> Result<Vec<String>> {
        Ok(Vec::new())
    }

    fn remove(&self, _: &str) -> Result<()> {
        Ok(())
    }
}

fuzz_target!(|data: &[u8]| {
    let _ = verify_block(&One(data.to_vec()), "as it is");
    // The first byte says how much is head, whose checksum is then made right.
    let Some((&share, body)) = data.split_first() else {
        return;
    };
    let (head, pages) = body.split_at(body.len() * usize::from(share) / 255);
    let mut block = b"KARUIBLK\x02\0\0\0\0\0\0\0".to_vec();
    block.extend((head.len() as u64).to_le_bytes());
    block.extend(checksum(head).to_le_bytes());
    block.extend(head);
    block.extend(pages);
    let _ = verify_block(&One(block), "sealed");
});
