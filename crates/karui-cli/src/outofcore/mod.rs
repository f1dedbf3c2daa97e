//! What `karui simplify --memory-limit`, `karui plan` and `karui task` share.

mod arguments;
mod failure;
mod observer;
mod place;
mod work;

pub use arguments::{BlockArgs, CutArgs, TargetArgs, memory};
pub use failure::{told, told_of_files};
pub use observer::observer;
pub use place::{cloudy, known, split};
pub use work::{Work, finish};
