//! Union-find over `0..n`.

/// Disjoint sets of the numbers below `n`. The least member names a set, so
/// names do not depend on the order of the unions.
#[derive(Debug, Clone)]
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Every number a set of its own.
    pub fn new(n: usize) -> Self {
        Self {
            parent: (0..n as u32).collect(),
        }
    }

    /// Least member of the set of `x`.
    pub fn find(&mut self, mut x: u32) -> u32 {
        while self.parent[x as usize] != x {
            let grandparent = self.parent[self.parent[x as usize] as usize];
            self.parent[x as usize] = grandparent;
            x = grandparent;
        }
        x
    }

    /// Joins the sets of `a` and `b`.
    pub fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_named_after_their_least_member() {
        let mut sets = DisjointSets::new(6);
        for (a, b) in [(5, 3), (3, 4), (2, 0), (4, 5)] {
            sets.unite(a, b);
        }
        let names: Vec<u32> = (0..6).map(|x| sets.find(x)).collect();
        assert_eq!(names, [0, 1, 0, 3, 3, 3]);
    }
}
