//! Readers and writers for Karui: OBJ (with MTL), PLY, STL and OFF, each also
//! gzipped, and glTF 2.0.
//!
//! ```no_run
//! let scene = karui_io::read("dragon.ply")?;
//! karui_io::write("dragon.obj.gz", &scene)?;
//! # Ok::<(), karui_io::Error>(())
//! ```
//!
//! | | normals | UV sets | colours | materials | custom, vertex | custom, face | polygons |
//! |-|-|-|-|-|-|-|-|
//! | OBJ | yes | 1 | 1 | yes | no | no | read |
//! | PLY | yes | 8 | 8 | no | yes | yes | read |
//! | OFF | yes | 1 | 1 | no | no | colour | read |
//! | STL | no | 0 | 0 | no | no | `stl_attribute` | no |
//!
//! Texture coordinates grow downwards in memory, as in glTF, and upwards in
//! OBJ, PLY and OFF; they are turned on the way. Colours in those files are
//! taken as they are, a byte c as c / 255, and so are written back exactly.
//! Scenes are baked into one mesh in world space where a format has no nodes;
//! [`Written::lost`] tells what a format could not hold.
//!
//! [`tiles`] reads, checks and writes 3D Tiles.
//!
//! [`slices`] reads models that are larger than memory. With the feature `cloud`, `Cloud` keeps
//! their blocks at `s3://`, `gs://` and `az://` URLs.
//!
//! [`decode_image`] and [`encode_png`] are for pictures, [`HeightRows`] for height maps,
//! [`CameraPath`] is where a model is looked at from.
//!
//! Readers never panic and reserve no memory on the word of a header; every
//! error names the file, the place and what was expected there. Writers leave
//! either every file complete or none at all.

mod atomic;
mod camera_path;
#[cfg(feature = "cloud")]
mod cloud;
mod color;
mod control;
mod error;
mod format;
mod gltf;
mod image;
mod lost;
mod number;
mod obj;
mod off;
mod ply;
mod read;
pub mod slices;
mod source;
mod stl;
mod text;
pub mod tiles;
mod warnings;
mod write;

pub use atomic::Written;
pub use camera_path::{CameraOfPath, CameraPath, FrameOfPath, LightOfPath};
#[cfg(feature = "cloud")]
pub use cloud::Cloud;
pub use control::{LoadedControl, read_control, read_control_bytes, read_control_sent};
pub use error::{Error, ErrorKind, Place, Result};
pub use format::Format;
pub use gltf::{FeatureColumn, FeatureTable, FeatureValues, GltfOptions};
pub use image::{HeightRows, decode_image, encode_png, picture_of, pictures_of};
pub use ply::PlyEncoding;
pub use read::{
    Loaded, ReadOptions, read, read_bytes, read_poly, read_poly_bytes, read_sent, read_with,
};
pub use warnings::Warnings;
pub use write::{WriteOptions, glb_bytes, write, write_with};

/// The README's snippets compile.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
