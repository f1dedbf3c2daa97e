//! Stand-ins for groups of objects.
//!
//! Kinds, after section 3 of Kato, Kanoh, Nishihara, "Fast display of scenes with
//! very many objects by perceptual grouping", 1998, whose conditions hold for all
//! of them: (a) fewer triangles than the members together, (b) no higher spatial
//! frequency than they have.
//!
//! - [`box_proxy()`]: the paper's, a box of the mean colour;
//! - [`merged()`]: the members as one simplified mesh, its textures baked into one;
//! - [`impostor()`]: pictures of the members on a few cards;
//! - [`choose()`]: the first of them, from the cheapest on, that looks like the members.
//!
//! ```
//! use karui::geom::{DMat4, DVec3};
//! use karui::hlod::proxy::{Group, Look, MergedOptions, Member, Objects, merged};
//! use karui::mesh::shapes;
//!
//! # fn main() -> karui::Result<()> {
//! let (ball, look) = (shapes::icosphere(3), Look::default());
//! let members: Vec<Member> = (0..4)
//!     .map(|i| Member {
//!         mesh: &ball,
//!         world_from_mesh: DMat4::from_translation(DVec3::new(1e9 + 3.0 * f64::from(i), 0.0, 0.0)),
//!         look: &look,
//!         objects: Objects::One(i),
//!         error: 0.0,
//!     })
//!     .collect();
//! let group = Group::new(&members)?;
//! let proxy = merged(&group, &MergedOptions::default())?.expect("fewer triangles");
//! assert!(proxy.triangles() < 4 * ball.triangles.len());
//! assert!(proxy.error > 0.0 && proxy.error < 0.3);
//! # Ok(())
//! # }
//! ```

mod bake;
mod box_proxy;
mod budget;
mod charts;
mod choose;
mod dilate;
mod distance;
mod finish;
mod floor;
mod group;
mod hidden;
mod impostor;
mod join;
mod judge;
mod look;
mod merged;
mod normal_map;
mod outfit;
mod pack;
mod paint;
mod pick;
mod plan;
#[allow(clippy::module_inception, reason = "it holds the type of that name")]
mod proxy;
mod silhouette;
mod single;

#[cfg(test)]
mod tests;

pub use box_proxy::{BoxOptions, box_proxy};
pub use choose::{Candidate, Choice, ChooseOptions, choose};
pub use group::{Group, Member, Objects};
pub use impostor::{ImpostorOptions, impostor};
pub use look::Look;
pub use merged::{MergedOptions, merged};
pub use proxy::{FEATURE_ID, NO_OBJECT, Proxy, ProxyKind};
