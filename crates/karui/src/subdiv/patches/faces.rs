//! The faces after the last step.

use super::{Patches, sides};
use rayon::prelude::*;

impl Patches {
    /// Vertices of all faces, four each, in the order of the whole mesh.
    pub fn corners(&self) -> Vec<u32> {
        let each = 4 * self.layout.cells.len();
        let mut corners = vec![0; each * self.start.faces.count()];
        let (numbers, strides) = self.numbers();
        let patches = corners.par_chunks_exact_mut(each).enumerate();
        patches.for_each_init(Vec::new, |grid: &mut Vec<u32>, (face, to)| {
            grid.clear();
            let inside = numbers.iter().zip(&strides);
            grid.extend(inside.map(|(number, stride)| number + face as u32 * stride));
            self.number_rim(face, grid);
            let width = self.side() as u32 + 1;
            for (to, &cell) in to.as_chunks_mut::<4>().0.iter_mut().zip(&self.layout.cells) {
                let row = [cell, cell + width].map(|i| i as usize);
                *to = [
                    grid[row[0]],
                    grid[row[0] + 1],
                    grid[row[1] + 1],
                    grid[row[1]],
                ];
            }
        });
        corners
    }

    /// Numbers of the vertices in the grid of patch 0, and what each grows by from patch to
    /// patch; of the rim nothing is known.
    fn numbers(&self) -> (Vec<u32>, Vec<u32>) {
        let size = (self.side() + 1) * (self.side() + 1);
        let (mut numbers, mut strides) = (vec![0; size], vec![0; size]);
        for block in self.layout.blocks.iter().filter(|block| !block.of_edges) {
            for (number, &place) in (block.first..).zip(&block.places) {
                numbers[place as usize] = number;
                strides[place as usize] = block.places.len() as u32;
            }
        }
        (numbers, strides)
    }

    fn number_rim(&self, face: usize, grid: &mut [u32]) {
        let n = self.side();
        for (i, (start, stride)) in sides(n).into_iter().enumerate() {
            let c = 4 * face + i;
            let (v, e) = (self.start.corners[c], self.start.corner_edges[c]);
            let forward = self.start.edge(e)[0] == v;
            grid[start] = v;
            for block in self.layout.blocks.iter().filter(|block| block.of_edges) {
                let first = block.first + e * block.places.len() as u32;
                for (number, &place) in (first..).zip(&block.places) {
                    let t = if forward {
                        place as usize
                    } else {
                        n - place as usize
                    };
                    grid[start.wrapping_add_signed(stride * t as isize)] = number;
                }
            }
        }
    }
}
