//! How triangles are removed; the same for every command that does.

use crate::console::Console;
use crate::failure::Failure;
use crate::input::Input;
use crate::saliency::{self, Kind, PresetArg};
use crate::weights::{self, MeshWeights};
use anyhow::Result;
use clap::ValueEnum;
use karui::lod::Method;
use karui::saliency::WeightMap;
use karui::simplify::{
    AttributeWeights, Border, Cost, Placement, Quality, SimplifyOptions, Topology,
};

/// How triangles are removed.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Simplification")]
pub struct SimplifyArgs {
    /// How much time to spend for how small an error
    #[arg(long, value_enum, default_value_t = QualityArg::Balanced)]
    quality: QualityArg,
    /// What happens to open borders
    #[arg(long, value_enum, default_value_t = BorderArg::Preserve)]
    border: BorderArg,
    /// Leave open borders untouched (short for --border lock)
    #[arg(long, conflicts_with = "border")]
    lock_border: bool,
    /// Keep more detail where this is larger than 1: a vertex attribute of the model (a custom
    /// name, or a colour channel such as COLOR_0.r) or a text file with one number a vertex
    #[arg(long, value_name = "ATTR|FILE")]
    weights: Option<String>,
    /// Keep more detail where this says that it matters
    #[arg(long, value_enum, value_name = "KIND", conflicts_with = "weights")]
    saliency: Option<Kind>,
    /// Keep more detail where a published way says that it matters, with its weights and, unless
    /// --cost says otherwise, its cost of a collapse
    #[arg(long, value_enum, value_name = "NAME", conflicts_with_all = ["weights", "saliency"])]
    saliency_preset: Option<PresetArg>,
    /// How many times as much a collapse costs where it matters most; 1 or more
    #[arg(
        long,
        value_name = "X",
        default_value_t = 300.0,
        requires = "saliency",
        conflicts_with = "saliency_preset"
    )]
    saliency_weight: f32,
    /// Power of the saliency that the cost grows with: the larger, the less counts what is but
    /// half salient
    #[arg(long, value_name = "N", default_value_t = 8, requires = "saliency",
          conflicts_with = "saliency_preset", value_parser = clap::value_parser!(u32).range(1..=64))]
    saliency_power: u32,
    /// Where new vertices may lie
    #[arg(long, value_enum, default_value_t = PlacementArg::Optimal)]
    placement: PlacementArg,
    /// What a collapse costs [default: memoryless, or as the preset of --saliency-preset]
    #[arg(long, value_enum)]
    cost: Option<CostArg>,
    /// Influence of normals; 1 is neutral, 0 is none
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    normal_weight: f64,
    /// Influence of texture coordinates
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    uv_weight: f64,
    /// Influence of vertex colours
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    color_weight: f64,
    /// Influence of skin weights
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    skin_weight: f64,
    /// Join parts closer than this, in model units; parts may fuse and holes close
    #[arg(long, value_name = "DISTANCE")]
    pairs: Option<f64>,
    /// Prefer even triangles: a way along the surface counts this much of one off it; 0.1 is mild,
    /// 0.5 strong
    #[arg(long, value_name = "X", default_value_t = 0.0)]
    regularity: f64,
    /// Keep every part, hole and handle; otherwise they go once they have come down to a few
    /// triangles and that costs no more than the collapses before
    #[arg(long)]
    keep_topology: bool,
    /// Remove connected parts up to this size (diagonal of their box) first, in model units; the
    /// size of the largest counts as an error
    #[arg(long, value_name = "SIZE")]
    prune: Option<f64>,
    /// Cluster vertices on a grid instead of collapsing edges: fast, reaches any target, keeps no
    /// topology
    #[arg(long, conflicts_with_all = SHAPING)]
    sloppy: bool,
    /// Where edge collapse stops before the target, cluster the vertices of what is left
    #[arg(long, conflicts_with = "sloppy")]
    sloppy_fallback: bool,
    /// Take connected parts of up to N triangles for leaf cards [default: 16]: fewer are left, each
    /// enlarged, so that the area they cover stays; larger parts are simplified as usual
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "16",
          require_equals = true, conflicts_with_all = ["sloppy", "sloppy_fallback"])]
    foliage: Option<usize>,
}

/// Options that clustering has no use for.
const SHAPING: [&str; 15] = [
    "quality",
    "border",
    "lock_border",
    "weights",
    "saliency",
    "saliency_preset",
    "placement",
    "cost",
    "normal_weight",
    "uv_weight",
    "color_weight",
    "skin_weight",
    "pairs",
    "keep_topology",
    "regularity",
];

#[derive(Debug, Clone, Copy, ValueEnum)]
enum QualityArg {
    /// Fewest rounds, looks back at the input where it has to
    Fast,
    /// More rounds, checked against the input near the target
    Balanced,
    /// One collapse at a time, each checked against the input; the reference, many times slower
    Exact,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum BorderArg {
    /// Simplified along themselves, held in place
    Preserve,
    /// Not touched
    Lock,
    /// Not held
    Free,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum PlacementArg {
    /// Where the error is least
    Optimal,
    /// On vertices of the input
    HalfEdge,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum CostArg {
    /// Distance to the surface as it is now, volume kept; closest on average
    Memoryless,
    /// Distance to all planes met so far (Garland & Heckbert 1997); slower
    Accumulated,
    /// The same, but a new vertex takes the mean of both quadrics (An 2014); slower
    Averaged,
}

impl SimplifyArgs {
    /// As the library wants it; stop, weights and progress are left open.
    pub fn resolve(&self) -> SimplifyOptions<'static> {
        SimplifyOptions {
            quality: match self.quality {
                QualityArg::Fast => Quality::Fast,
                QualityArg::Balanced => Quality::Balanced,
                QualityArg::Exact => Quality::Exact,
            },
            placement: match self.placement {
                PlacementArg::Optimal => Placement::Optimal,
                PlacementArg::HalfEdge => Placement::HalfEdge,
            },
            cost: self.cost(),
            border: self.border(),
            attributes: AttributeWeights {
                normal: self.normal_weight,
                uv: self.uv_weight,
                color: self.color_weight,
                skin: self.skin_weight,
            },
            pairs: self.pairs,
            regularity: self.regularity,
            topology: match self.keep_topology {
                true => Topology::Preserve,
                false => Topology::Simplify,
            },
            ..SimplifyOptions::default()
        }
    }

    /// One weight a vertex of every mesh; none if all are 1.
    pub fn weights(&self, input: &Input, console: &Console) -> Result<MeshWeights> {
        let most = self.saliency_weight;
        match (&self.weights, self.saliency) {
            (Some(name), _) => weights::load(name, input),
            (_, Some(_)) if !(1.0..=f32::MAX).contains(&most) => {
                let message = format!("--saliency-weight is {most}; it must be 1 or more");
                Err(Failure::input(message).into())
            }
            (_, Some(kind)) => {
                let (least, power) = (1.0, self.saliency_power);
                let map = WeightMap::Power { least, most, power };
                saliency::weights(kind, map, input, console)
            }
            _ => match self.saliency_preset {
                Some(preset) => saliency::preset_weights(preset.resolve(), input, console),
                None => Ok(MeshWeights::new()),
            },
        }
    }

    /// What makes the levels.
    pub fn method(&self) -> Method {
        match (self.foliage, self.sloppy, self.sloppy_fallback) {
            (Some(card), ..) => Method::Foliage { card },
            (_, true, _) => Method::Cluster,
            (.., true) => Method::CollapseElseCluster,
            _ => Method::Collapse,
        }
    }

    /// Size up to which parts are removed, model units.
    pub fn prune(&self) -> Result<Option<f64>> {
        match self.prune {
            Some(size) if !(0.0..=f64::MAX).contains(&size) => {
                Err(Failure::input(format!("--prune is {size}; it must be 0 or more")).into())
            }
            size => Ok(size),
        }
    }

    fn cost(&self) -> Cost {
        match (self.cost, self.saliency_preset) {
            (Some(CostArg::Memoryless), _) => Cost::Memoryless,
            (Some(CostArg::Accumulated), _) => Cost::Accumulated,
            (Some(CostArg::Averaged), _) => Cost::Averaged,
            (None, Some(preset)) => preset.resolve().cost(),
            (None, None) => Cost::default(),
        }
    }

    fn border(&self) -> Border {
        match self.border {
            _ if self.lock_border => Border::Lock,
            BorderArg::Preserve => Border::Preserve,
            BorderArg::Lock => Border::Lock,
            BorderArg::Free => Border::Free,
        }
    }
}
