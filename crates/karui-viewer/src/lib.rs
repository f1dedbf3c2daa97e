//! Karui to look at: a page on this machine that shows models, makes levels of
//! detail and compares them.
//!
//! ```no_run
//! use karui_viewer::{Viewer, ViewerOptions};
//!
//! let viewer = Viewer::open(&["bunny.obj".into()], &ViewerOptions::default())?;
//! println!("{}", viewer.url());
//! viewer.run(&|| false)?;
//! # Ok::<(), karui_viewer::Error>(())
//! ```
//!
//! The server listens on 127.0.0.1 alone. Whoever asks has to know a token of 128 random
//! bits that is part of the address, and has to call the server by its own name, so that no
//! other page in the browser can ask in the user's place (DNS rebinding, cross-site
//! requests). No path that a client sends touches the disk: files go by number, and those
//! that are dropped on the page stay in memory. `docs/viewer.md` describes page and API.

pub mod adaptive;
mod api;
mod error;
mod file;
mod guard;
mod job;
mod levels;
mod links;
pub mod live;
mod measured;
mod model;
mod page;
mod refusal;
mod shared;
mod tileset;
mod token;
mod viewer;

pub use error::{Error, Result};
pub use viewer::{Viewer, ViewerOptions};

/// Colours and type of the page as CSS, for reports that are to look like it.
pub const LOOK: &str = include_str!("../web/src/look.css");
