//! From merges of two to groups of many.

use super::agglomerate::Merge;

/// A group of clusters: pieces, or other groups.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Family {
    /// The merge that completed it.
    pub merge: u32,
    /// Greatest Omega0 of a merge in it or below.
    pub omega: f64,
    /// Numbers of clusters: a piece, or a piece's count and the merge of another
    /// group.
    pub children: Vec<u32>,
}

/// Groups in the order of the merges that completed them: children come before
/// their parents. A merge takes the place of a member that merged at the same
/// threshold, the older member first, as long as there are no more than
/// `most` children. `below` is the greatest Omega0 in a piece.
pub(super) fn families(
    merges: &[Merge],
    pieces: usize,
    most: usize,
    below: impl Fn(usize) -> f64,
) -> Vec<Family> {
    let mut counts = vec![2usize; merges.len()];
    let mut absorbed = vec![false; merges.len()];
    let mut omegas: Vec<f64> = Vec::with_capacity(merges.len());
    for (i, merge) in merges.iter().enumerate() {
        let mut omega = merge.omega;
        for member in merge.members.map(|m| m as usize) {
            omega = omega.max(match member.checked_sub(pieces) {
                Some(inner) => omegas[inner],
                None => below(member),
            });
            let Some(inner) = member.checked_sub(pieces) else {
                continue;
            };
            let count = counts[i] - 1 + counts[inner];
            if merges[inner].level == merge.level && count <= most {
                absorbed[inner] = true;
                counts[i] = count;
            }
        }
        omegas.push(omega);
    }
    let family = |i: usize| Family {
        merge: i as u32,
        omega: omegas[i],
        children: children(merges, pieces, &absorbed, i),
    };
    (0..merges.len())
        .filter(|&i| !absorbed[i])
        .map(family)
        .collect()
}

fn children(merges: &[Merge], pieces: usize, absorbed: &[bool], merge: usize) -> Vec<u32> {
    let mut found = Vec::new();
    let [a, b] = merges[merge].members;
    let mut open = vec![b, a];
    while let Some(cluster) = open.pop() {
        match (cluster as usize).checked_sub(pieces) {
            Some(inner) if absorbed[inner] => {
                let [a, b] = merges[inner].members;
                open.extend([b, a]);
            }
            _ => found.push(cluster),
        }
    }
    found
}
