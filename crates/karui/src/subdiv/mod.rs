//! Subdivision surfaces: coarse cages of any faces become smooth.
//!
//! Connectivity and values are apart: [`Refinement`] is made once, and evaluated for
//! positions, colours or anything else as often as wanted.
//!
//! ```
//! use karui::subdiv::{Cage, Refinement, SubdivOptions};
//!
//! let cube = Cage {
//!     vertices: 8,
//!     offsets: vec![0, 4, 8, 12, 16, 20, 24],
//!     indices: vec![
//!         0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5,
//!     ],
//!     ..Cage::default()
//! };
//! let positions: Vec<[f32; 3]> =
//!     (0..8).map(|i| [0, 1, 2].map(|axis| (i >> axis & 1) as f32)).collect();
//! let refinement = Refinement::new(&cube, &SubdivOptions::default())?;
//! let smooth = refinement.evaluate(&positions)?;
//! assert_eq!((refinement.faces().count(), smooth.len()), (96, 98));
//! # Ok::<(), karui::Error>(())
//! ```

pub mod adaptive;
mod cage;
mod catmull_clark;
mod control_mesh;
mod crease;
mod face_varying;
mod level;
mod limit;
mod loop_;
mod masks;
mod options;
mod patches;
mod rational;
mod refinement;
mod size;
mod split;
pub mod sqrt2;
mod sqrt3;
mod sum;
mod surface;

pub use cage::{Cage, Corner, Crease, INFINITELY_SHARP};
pub use control_mesh::{ControlMesh, FaceVarying, Rules};
pub use crease::{Blend, Rule};
pub use level::{Faces, Level};
pub use limit::Limits;
pub use options::{Boundary, CreaseMethod, FaceVaryingRule, Scheme, SubdivOptions, TriangleRule};
pub use refinement::{Refinement, Workspace};
pub use surface::{Subdivided, SurfaceOptions, subdivide};
