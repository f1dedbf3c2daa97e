//! `karui bench solo`: one contestant in a process of its own, for figures
//! that another would spoil.

use super::super::child;
use super::super::clock::{Costs, Watch};
use super::contestants::Contestant;
use super::inputs::{Kind, Model, land_name};
use super::rounds::race;
use crate::console::{Console, to_stderr};
use anyhow::{Context as _, Result, bail};
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Run one contestant (used by `karui bench simplify`)
#[derive(Debug, clap::Args)]
#[command(hide = true)]
pub struct Args {
    /// The model, or `land:N` for land of N triangles
    input: PathBuf,
    #[arg(long, value_enum)]
    kind: Kind,
    #[arg(long)]
    contestant: String,
    #[arg(long)]
    workers: usize,
    #[arg(long)]
    target: f64,
    #[arg(long)]
    runs: usize,
    /// Measure memory too
    #[arg(long)]
    memory: bool,
}

/// What the process says.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Told {
    triangles: usize,
    left: usize,
    costs: Costs,
}

/// The figures of one contestant on land of one size.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub name: String,
    pub ours: bool,
    pub threads: usize,
    pub triangles: usize,
    pub left: usize,
    pub costs: Costs,
}

impl Row {
    fn is_of(&self, contestant: &Contestant) -> bool {
        self.name == contestant.name && self.threads == contestant.threads
    }
}

/// Runs in the process of its own.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let contestant = Contestant::named(&args.contestant, args.workers)?;
    let model = Model::read(&args.input, Path::new(""))?;
    let mesh = model.mesh(args.kind)?.clone();
    drop(model);
    let triangles = mesh.triangles.len();
    let wanted = (args.target * triangles as f64).round() as usize;
    let watch = match args.memory {
        true => Watch::TimeAndMemory,
        false => Watch::Time,
    };
    let mut entries = race(&[contestant], &mesh, wanted, args.runs, watch)?;
    let (result, costs) = entries.pop().context("no run")?;
    console.document(&Told {
        triangles,
        left: result.triangles.len(),
        costs,
    })
}

/// How much memory a contestant takes at most, bytes.
pub fn growth(
    args: &super::Args,
    source: &Path,
    kind: Kind,
    contestant: &Contestant,
    target: f64,
) -> Result<Option<u64>> {
    if args.no_memory {
        return Ok(None);
    }
    let told = ask(source, kind, contestant, target, Ask::Memory)?;
    Ok(told.costs.growth)
}

/// What to find out.
#[derive(Clone, Copy)]
enum Ask {
    /// How long so many runs take.
    Time(usize),
    /// How much memory one run takes.
    Memory,
}

/// Makes the C library give memory back as soon as it is free, which takes
/// time but leaves none that a later rise could hide in.
const GIVE_BACK: [(&str, &str); 2] = [
    ("MALLOC_MMAP_THRESHOLD_", "65536"),
    ("MALLOC_TRIM_THRESHOLD_", "65536"),
];

/// No contestant takes this long, seconds.
const LIMIT: u64 = 24 * 3600;

fn ask(source: &Path, kind: Kind, contestant: &Contestant, target: f64, what: Ask) -> Result<Told> {
    let kind = match kind {
        Kind::Geometry => "geometry",
        Kind::Attributes => "attributes",
    };
    let (runs, set) = match what {
        Ask::Time(runs) => (runs, &[][..]),
        Ask::Memory => (1, &GIVE_BACK[..]),
    };
    let options = [
        ("--kind", kind.to_owned()),
        ("--contestant", contestant.name.clone()),
        ("--workers", contestant.threads.to_string()),
        ("--target", target.to_string()),
        ("--runs", runs.to_string()),
    ];
    let mut words = ["bench", "solo", "--json", "--quiet"]
        .map(OsString::from)
        .to_vec();
    for (option, value) in options {
        words.extend([option.into(), value.into()]);
    }
    words.extend(matches!(what, Ask::Memory).then(|| "--memory".into()));
    words.push(source.into());
    let ended = child::run(&words, set, Duration::from_secs(LIMIT))?;
    match ended.code {
        Some(0) => serde_json::from_str(&ended.out).context("reading figures"),
        _ => bail!("{} {}: {}", contestant.name, source.display(), ended.error),
    }
}

/// Share of its triangles that land is simplified to.
const LAND_TARGET: f64 = 0.1;

/// Who took longer on some land is spared larger, seconds.
const PATIENCE: f64 = 60.0;

/// Every contestant on land of every size.
pub fn scaling(
    args: &super::Args,
    contestants: &[Contestant],
    console: &Console,
) -> Result<Vec<Row>> {
    let mut rows: Vec<Row> = Vec::new();
    for &size in &args.sizes {
        let source = land_name(size);
        for contestant in contestants {
            if rows
                .iter()
                .any(|r| r.is_of(contestant) && r.costs.wall.least > PATIENCE)
            {
                continue;
            }
            if !console.quiet {
                to_stderr(&format!("{} {}", source.display(), contestant.name));
            }
            let kind = Kind::Geometry;
            let told = ask(&source, kind, contestant, LAND_TARGET, Ask::Time(args.runs))?;
            let growth = growth(args, &source, kind, contestant, LAND_TARGET)?;
            rows.push(Row {
                name: contestant.name.clone(),
                ours: contestant.is_ours(),
                threads: contestant.threads,
                triangles: told.triangles,
                left: told.left,
                costs: Costs {
                    growth,
                    ..told.costs
                },
            });
        }
    }
    Ok(rows)
}
