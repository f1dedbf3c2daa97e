//! Refinement as a page asks for it: a camera goes in, what has changed comes out.
//!
//! A session is all that one page sees of one model. It knows nothing of sockets: text goes
//! in, bytes come out, laid out as in `docs/viewer-protocol.md`. What the page has already,
//! vertices and clusters, is not sent again.

mod clusters;
mod desk;
mod error;
mod frame;
mod geometry;
mod half_edge;
mod prepared;
mod request;
mod slots;
mod socket;
mod vertices;

pub use clusters::{ClusterOptions, ClusterSession};
pub use error::{LiveError, Result};
pub use frame::{FLAG_COMPLETE, FLAG_RESET, FLAG_TRUNCATED, HEADER_BYTES, Kind, MAGIC};
pub use geometry::Geometry;
pub use half_edge::{HalfEdgeOptions, HalfEdgeSession};
pub use request::{BudgetOfRequest, MAX_LIGHTS, Request};

pub(crate) use desk::Desk;
pub(crate) use frame::{Frame, Header};
pub(crate) use geometry::octahedral;
pub(crate) use prepared::Prepared;
pub(crate) use request::Order;
pub(crate) use slots::Slots;
pub(crate) use socket::{MAX_SESSIONS, answer_all, live, open};

/// What one page sees of one model.
pub trait Session {
    /// The answer to one message: a frame.
    ///
    /// # Errors
    /// [`LiveError`] for what is no message, is older than the last one, or asks for what
    /// cannot be; nothing has changed then.
    fn answer(&mut self, message: &str) -> Result<Vec<u8>>;
}
