//! What can be wrong with a message.

/// Why a message has no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// It is not JSON, or not what a message looks like.
    #[error("not a message of a camera: {0}")]
    Message(#[from] serde_json::Error),
    /// It is not newer than the one that was answered last.
    #[error("message {found} is not newer than {last}, which was answered")]
    OutOfOrder {
        /// Number of the message.
        found: u32,
        /// Number of the last one.
        last: u32,
    },
    /// A number is out of range.
    #[error("{what}: expected {expected}, found {found}")]
    Range {
        /// Which number.
        what: &'static str,
        /// What would have been in range.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// The library cannot do what is asked for.
    #[error(transparent)]
    Karui(#[from] karui::Error),
}

/// Shorthand for answers.
pub type Result<T, E = LiveError> = std::result::Result<T, E>;
