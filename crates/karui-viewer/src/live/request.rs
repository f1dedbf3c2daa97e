//! The messages of a page.

use super::error::{LiveError, Result};
use karui::geom::{Camera, Light};
use karui::hierarchy::Budget;
use karui_io::FrameOfPath;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::time::Duration;

/// Lights of a message at most.
pub const MAX_LIGHTS: usize = 8;

/// A camera, and what is asked for there. `O` depends on what refines.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request<O> {
    /// Number of the message, larger than that of the one before; the answer has it too.
    pub seq: u32,
    /// Camera and lights, as in the paths of `karui hierarchy`.
    pub frame: FrameOfPath,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// What is asked for; what is left out has its default.
    #[serde(
        default = "O::default",
        bound(deserialize = "O: Deserialize<'de> + Default")
    )]
    pub options: O,
    /// What the answer may cost.
    #[serde(default)]
    pub budget: BudgetOfRequest,
}

/// What an answer may cost at most.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BudgetOfRequest {
    /// Triangles; none for as many as are asked for.
    #[serde(default)]
    pub triangles: Option<u64>,
    /// Time of the refinement, milliseconds; the rest waits for the next message.
    #[serde(default)]
    pub milliseconds: Option<f64>,
}

impl<O: DeserializeOwned + Default> Request<O> {
    /// Reads a message.
    ///
    /// # Errors
    /// [`LiveError::Message`] or, with too many lights, [`LiveError::Range`].
    pub fn parse(message: &str) -> Result<Self> {
        let request: Self = serde_json::from_str(message)?;
        let lights = request.frame.lights.as_ref().map_or(0, Vec::len);
        if lights > MAX_LIGHTS {
            return Err(LiveError::Range {
                what: "lights",
                expected: "at most 8",
                found: lights.to_string(),
            });
        }
        Ok(request)
    }

    /// The camera and the lights.
    ///
    /// # Errors
    /// [`LiveError::Karui`] if the camera looks nowhere.
    pub fn view(&self) -> Result<(Camera, Vec<Light>)> {
        Ok(self.frame.resolve()?)
    }
}

impl BudgetOfRequest {
    /// As the library knows budgets.
    ///
    /// # Errors
    /// [`LiveError::Range`] for a time that is none.
    pub fn resolve(&self) -> Result<Budget> {
        let time = |ms: f64| {
            Duration::try_from_secs_f64(ms * 1e-3).map_err(|_| LiveError::Range {
                what: "budget.milliseconds",
                expected: "0 or more, no more than centuries",
                found: ms.to_string(),
            })
        };
        Ok(Budget {
            triangles: self.most_triangles(),
            time: self.milliseconds.map(time).transpose()?,
        })
    }

    pub(super) fn most_triangles(&self) -> Option<usize> {
        self.triangles
            .map(|most| usize::try_from(most).unwrap_or(usize::MAX))
    }
}

/// Sees to it that messages come in order.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Order {
    last: Option<u32>,
}

impl Order {
    /// Refuses what is not newer than what has been answered.
    pub fn check(self, seq: u32) -> Result<()> {
        match self.last {
            Some(last) if seq <= last => Err(LiveError::OutOfOrder { found: seq, last }),
            _ => Ok(()),
        }
    }

    /// A message has been answered.
    pub fn answered(&mut self, seq: u32) {
        self.last = Some(seq);
    }
}
