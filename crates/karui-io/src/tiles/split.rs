//! Which branches of a tree go to files of their own.

/// Levels of tiles in one file: parsers of other programs descend as deep.
const LEVELS: u32 = 32;

/// For every node whether its branch is a file of its own; the root's is.
/// `parents` names the parent of each node, which comes before it. A file
/// holds at most `limit` tiles, the stubs that name other files among them,
/// unless a single node has more children.
pub(super) fn split(parents: &[Option<u32>], limit: usize) -> Vec<bool> {
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); parents.len()];
    for (node, parent) in parents.iter().enumerate() {
        if let Some(parent) = parent {
            children[*parent as usize].push(node as u32);
        }
    }
    let mut alone = vec![false; parents.len()];
    // Tiles and levels of the branch of each node that stay in its file.
    let mut weight = vec![1usize; parents.len()];
    let mut height = vec![1u32; parents.len()];
    for node in (0..parents.len()).rev() {
        let mut below = std::mem::take(&mut children[node]);
        let mut total: usize = 1 + below.iter().map(|&c| weight[c as usize]).sum::<usize>();
        // The heaviest first; the lower number among equals.
        below.sort_by_key(|&c| (std::cmp::Reverse(weight[c as usize]), c));
        for c in below.into_iter().map(|c| c as usize) {
            let deep = height[c] >= LEVELS;
            if weight[c] > 1 && (total > limit || deep) {
                total -= weight[c] - 1;
                alone[c] = true;
                height[c] = 1;
            }
            height[node] = height[node].max(1 + height[c]);
        }
        weight[node] = total;
    }
    if let Some(root) = alone.first_mut() {
        *root = true;
    }
    alone
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Tiles in each file.
    fn files(parents: &[Option<u32>], alone: &[bool]) -> Vec<usize> {
        let mut file = vec![0; parents.len()];
        let mut tiles = vec![0usize; parents.len()];
        for (node, parent) in parents.iter().enumerate() {
            file[node] = if alone[node] {
                node
            } else {
                file[parent.unwrap() as usize]
            };
            tiles[file[node]] += 1;
            if let (true, Some(parent)) = (alone[node], parent) {
                // The stub.
                tiles[file[*parent as usize]] += 1;
            }
        }
        tiles.into_iter().filter(|t| *t > 0).collect()
    }

    #[test]
    fn chains_and_stars() {
        let chain: Vec<_> = (0..1000u32).map(|i| i.checked_sub(1)).collect();
        let found = files(&chain, &split(&chain, 2000));
        assert!(found.iter().all(|t| *t <= LEVELS as usize + 1), "{found:?}");
        let star: Vec<_> = (0..1000).map(|i| (i > 0).then_some(0)).collect();
        assert_eq!(files(&star, &split(&star, 10)), [1000]);
    }

    proptest! {
        #[test]
        fn no_file_is_too_large(seed in prop::collection::vec(any::<u32>(), 1..400), limit in 10usize..40) {
            // Binary trees: no node has more children than fit.
            let parents: Vec<Option<u32>> =
                (0..seed.len() as u32).map(|i| i.checked_sub(1).map(|i| i / 2)).collect();
            let found = files(&parents, &split(&parents, limit));
            prop_assert!(found.iter().all(|t| *t <= limit), "{:?}", found);
        }
    }
}
