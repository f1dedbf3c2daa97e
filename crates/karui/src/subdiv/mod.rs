//! Subdivision surfaces.

mod cage;
mod catmull_clark;
mod control_mesh;
mod crease;
mod face_varying;
mod level;
mod loop_;
mod masks;
mod options;
mod refinement;
mod split;
mod sum;

pub use cage::{Cage, Corner, Crease, INFINITELY_SHARP};
pub use control_mesh::{ControlMesh, FaceVarying, Rules};
pub use crease::{Blend, Rule};
pub use level::{Faces, Level};
pub use options::{Boundary, CreaseMethod, FaceVaryingRule, Scheme, SubdivOptions, TriangleRule};
pub use refinement::Refinement;
