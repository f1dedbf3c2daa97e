//! A control mesh made smooth as a page looks at it.

mod faces;
mod options;
mod session;
mod socket;

pub use options::{How, SmoothOptions};
pub use session::AdaptiveSession;

pub(crate) use socket::adaptive;
