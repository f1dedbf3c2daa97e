//! A control mesh made smooth as a page looks at it.

mod faces;
mod options;
mod session;

pub use options::{How, SmoothOptions};
pub use session::AdaptiveSession;
