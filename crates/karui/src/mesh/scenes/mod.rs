//! Made-up scenes of very many objects: forests, cities, and the trees of the
//! paper on perceptual grouping (Kato, Kanoh and Nishihara, "Fast display
//! based on grouping", 1998).
//!
//! Objects are placements ([`Placements`](super::Placements)) of few meshes.
//! Y points up and lengths are in metres, but for [`city`], whose street tiles
//! are 2 units wide. Same arguments, same bits.

mod build;
mod city;
mod city_parts;
mod forest;
mod ground;
mod kato1998;
mod trees;

pub use city::{CityOptions, city};
pub use city_parts::{CityParts, CityRole};
pub use forest::{ForestOptions, forest};
pub use kato1998::{kato1998_32_trees, kato1998_wide};
pub use trees::{TreeKind, tree_lod, tree_model};

#[cfg(test)]
mod tests;
