//! Options of work out of core.

use crate::failure::Failure;
use anyhow::Result;
use karui::outofcore::{PlanOptions, Scheme};

/// What is to be left.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Target")]
#[group(required = true, multiple = true)]
pub struct TargetArgs {
    /// Share of the triangles to keep, 0 to 1
    #[arg(long, value_name = "SHARE")]
    pub ratio: Option<f64>,
    /// Triangles to keep
    #[arg(long, value_name = "COUNT")]
    pub triangles: Option<u64>,
    /// Largest error as the simplifier estimates it, in model units
    #[arg(long, value_name = "ERROR")]
    pub error: Option<f64>,
}

/// How much is done at a time.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Blocks")]
pub struct BlockArgs {
    /// Memory that may be taken, e.g. 1GiB or 800MB
    #[arg(long, value_name = "SIZE", value_parser = memory)]
    pub memory_limit: Option<u64>,
    #[command(flatten)]
    pub cut: CutArgs,
}

/// How a model is cut.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Blocks")]
pub struct CutArgs {
    /// Triangles of a block [default: as many as let two fit the memory]
    #[arg(long, value_name = "COUNT")]
    pub block_triangles: Option<u64>,
    /// How the model is cut [default: cells]
    #[arg(long, value_name = "HOW")]
    pub cut: Option<Cut>,
}

/// How a model is cut.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum Cut {
    /// Cubes: short borders
    Cells,
    /// Slabs across the longest axis that are as much work each
    Sweep,
    /// Slabs of as many triangles each
    Slabs,
}

impl CutArgs {
    /// Refuses to cut what is not to be cut.
    pub fn refuse(&self) -> Result<()> {
        if self.block_triangles.is_none() && self.cut.is_none() {
            return Ok(());
        }
        let message = "--block-triangles and --cut need --memory-limit";
        Err(Failure::input(message).into())
    }
}

/// Taken where nothing is said.
const MEMORY: u64 = 1 << 30;

impl BlockArgs {
    /// Bytes that may be taken.
    pub fn memory(&self) -> u64 {
        self.memory_limit.unwrap_or(MEMORY)
    }

    /// With a target, all of a plan's options.
    pub fn options(&self, target: &TargetArgs) -> PlanOptions {
        let fitting = || PlanOptions::block_triangles_for(self.memory());
        PlanOptions {
            triangles: target.triangles,
            ratio: target.ratio,
            error: target.error,
            block_triangles: self.cut.block_triangles.unwrap_or_else(fitting),
            scheme: match self.cut.cut {
                None | Some(Cut::Cells) => Scheme::Cells,
                Some(Cut::Sweep) => Scheme::Sweep,
                Some(Cut::Slabs) => Scheme::Slabs,
            },
            tiles: None,
        }
    }
}

/// Bytes: a number with a unit, 1024 to a KiB and 1000 to a kB.
pub fn memory(text: &str) -> Result<u64, String> {
    let end = text
        .find(|c: char| !c.is_ascii_digit() && c != '.')
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let unit = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "k" | "kib" => 1024.0,
        "m" | "mib" => 1_048_576.0,
        "g" | "gib" => 1_073_741_824.0,
        "t" | "tib" => 1_099_511_627_776.0,
        other => return Err(format!("`{other}` is no unit; try MiB or GiB")),
    };
    let number: f64 = number.parse().map_err(|_| "no number".to_owned())?;
    Ok((number * unit) as u64)
}

#[cfg(test)]
mod tests {
    use super::memory;

    #[test]
    fn sizes_with_units() {
        assert_eq!(memory("1GiB"), Ok(1 << 30));
        assert_eq!(memory("1.5 kB"), Ok(1500));
        assert_eq!(memory("42"), Ok(42));
        assert!(memory("GiB").is_err() && memory("1 apple").is_err());
    }
}
