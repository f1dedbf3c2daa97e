//! Why a simplification stopped, and what would take it further.

use karui::simplify::Stopped;

/// The reason, to follow `stopped: `.
pub fn reason(stopped: Stopped) -> &'static str {
    match stopped {
        Stopped::Target => "target reached",
        Stopped::ErrorBound => "error bound reached",
        Stopped::Exhausted => "nothing is left to collapse",
        Stopped::Locked => "what is left is locked",
        Stopped::Topology => "going on would change the topology",
        Stopped::Seams => "going on would tear attribute seams or material borders",
        Stopped::Flips => "going on would turn triangles over",
    }
}

/// The name used in JSON.
pub fn key(stopped: Stopped) -> &'static str {
    match stopped {
        Stopped::Target => "target",
        Stopped::ErrorBound => "error_bound",
        Stopped::Exhausted => "exhausted",
        Stopped::Locked => "locked",
        Stopped::Topology => "topology",
        Stopped::Seams => "seams",
        Stopped::Flips => "flips",
    }
}

/// What would go further, if something would.
pub fn advice(stopped: Stopped) -> Option<&'static str> {
    match stopped {
        Stopped::Target | Stopped::Exhausted => None,
        Stopped::ErrorBound => Some("a larger error goes further"),
        Stopped::Locked => Some("`--border preserve` (without `--lock-border`) goes further"),
        Stopped::Topology => Some("`--pairs DISTANCE` joins parts and goes further"),
        Stopped::Seams => Some("fewer materials or UV charts in the input would go further"),
        Stopped::Flips => Some("`--border free` or `--placement optimal` may go further"),
    }
}
