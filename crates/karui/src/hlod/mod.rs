//! Scenes of very many objects: what people see as one thing becomes one group,
//! for which something simple stands in from afar.
//!
//! - N. Kato, H. Kanoh, S. Nishihara: A Realtime Display Method for Virtual
//!   Environment Using Grouping Operation, 1998. Today's name is hierarchical
//!   level of detail; the paper adds perception: proximity, similarity of shape
//!   and colour, common fate.
//!
//! A [`Tree`] of groups is built once from [`Object`]s, and a [`Walk`] chooses
//! frame by frame which groups and objects to draw.
//!
//! ```
//! use karui::geom::{Camera, Vec3, DVec3};
//! use karui::hlod::{Assets, Levels, Shape, Tree, TreeOptions, View, Walk};
//! use karui::{mesh::shapes, render::Model};
//! use glam::DMat4;
//!
//! # fn main() -> karui::Result<()> {
//! let mesh = shapes::icosphere(3);
//! let shape = Shape::of(&Model::of_mesh(&mesh), 0)?; // once a mesh
//! let at = |i: u32| DMat4::from_translation(DVec3::new(f64::from(i * i), 0.0, 0.0));
//! let objects = (0..20).map(|i| shape.placed(&at(i))).collect();
//! let tree = Tree::build(objects, &TreeOptions::default())?;
//! assert_eq!(tree.roots().count(), 1);
//!
//! let levels = [Levels { switch: vec![30.0], triangles: vec![1280, 80] }];
//! let proxies = vec![12; tree.group_capacity()];
//! let assets = Assets { levels: &levels, levels_of_object: &[0; 20], proxies: &proxies };
//! let mut walk = Walk::default();
//! let eye = Vec3::new(-5.0, 2.0, 30.0);
//! let camera = Camera { eye, target: Vec3::ZERO, ..Camera::looking_at(mesh.bounds(), Vec3::Z, 0.8) };
//! let list = walk.frame(&tree, &View { threshold: 0.1, ..View::new(camera) }, &assets)?;
//! assert!(list.counts.triangles < 20 * 1280);
//! # Ok(())
//! # }
//! ```

mod agglomerate;
mod bounds;
mod check;
mod finder;
mod group;
mod levels;
mod nesting;
mod object;
mod oklab;
mod omega;
pub mod proxy;
mod queue;
mod shape;
mod slots;
mod thresholds;
pub mod tiles;
mod tree;
mod update;
mod walk;

pub use bounds::Bounds;
pub use group::{Group, Member};
pub use nesting::Nest;
pub use object::Object;
pub use omega::{ColorSpace, Lengths, OmegaOptions, omega0};
pub use shape::Shape;
pub use thresholds::Thresholds;
pub use tree::{Tree, TreeOptions};
pub use update::Updated;
pub use walk::{Assets, Counts, DrawList, Item, Levels, View, Walk};

/// Stands for no group, object or slot.
const NONE: u32 = u32::MAX;
