//! Lists of different length, one after the other.

/// Row `i` is `entries[starts[i]..starts[i + 1]]`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::subdiv) struct Rows {
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Rows {
    /// Puts every entry in the row it belongs to, in order of entries. `entries` is called
    /// twice and must give the same pairs of row and entry.
    pub fn group<I>(rows: usize, entries: impl Fn() -> I) -> Self
    where
        I: Iterator<Item = (u32, u32)>,
    {
        let mut starts = vec![0u32; rows + 1];
        for (row, _) in entries() {
            starts[row as usize + 1] += 1;
        }
        for i in 0..rows {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut all = vec![0; starts[rows] as usize];
        for (row, entry) in entries() {
            let slot = &mut next[row as usize];
            all[*slot as usize] = entry;
            *slot += 1;
        }
        Self {
            starts,
            entries: all,
        }
    }

    pub fn row(&self, i: usize) -> &[u32] {
        &self.entries[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    pub fn row_mut(&mut self, i: usize) -> &mut [u32] {
        &mut self.entries[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}
