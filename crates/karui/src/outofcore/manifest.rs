//! Manifests: the tasks of one phase, each by reference, and what came of them.
//!
//! JSON lines. The first line of `NN-KIND.tasks` is the phase, which all its rows share; one
//! line a row follows. `NN-KIND.done` has one line a row with its result; it is written once
//! all are there, and closes the phase. The last line of both is the checksum of those before.

use super::checksum::checksum;
use super::keys::Keys;
use super::tiles::TileCut;
use super::{Error, Plan, Result, Store};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// What the rows of a phase do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Finds the box around a range of vertices.
    Bounds,
    /// Finds which vertices portions of faces use, where these are scattered.
    Scan,
    /// Reads ranges of vertices for all portions that use some.
    Fetch,
    /// Reads portions of faces with their vertices, and sorts them by key.
    Read,
    /// Finds places that several regions share.
    Borders,
    /// Simplifies regions.
    Simplify,
    /// Cuts triangles at the faces of the smallest tiles.
    Pieces,
    /// Gathers the triangles of the smallest tiles.
    Leaves,
    /// Finds places that tiles share.
    Edges,
    /// Simplifies tiles: what their children have together.
    Parents,
}

impl Kind {
    /// Whether its rows put blocks into the store.
    pub(super) fn makes_blocks(self) -> bool {
        match self {
            Self::Read | Self::Simplify | Self::Pieces | Self::Leaves | Self::Parents => true,
            Self::Bounds | Self::Scan | Self::Fetch | Self::Borders | Self::Edges => false,
        }
    }

    /// Its name, as in the names of manifests and blocks.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Bounds => "bounds",
            Self::Scan => "scan",
            Self::Fetch => "fetch",
            Self::Read => "read",
            Self::Borders => "borders",
            Self::Simplify => "simplify",
            Self::Pieces => "pieces",
            Self::Leaves => "leaves",
            Self::Edges => "edges",
            Self::Parents => "parents",
        }
    }
}

/// What the rows of a manifest share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// Number of the phase, from 0; a phase needs those before.
    pub number: u32,
    /// What its rows do.
    pub kind: Kind,
    /// Level of simplification, 0 while reading; of tiles, how often the root is halved.
    pub level: u32,
    /// Triangles of the model; 0 while that is not known.
    pub whole: u64,
    /// Triangles before this level.
    pub triangles: u64,
    /// Triangles after it, if no error bound is met before.
    pub target: u64,
    /// Whether what it makes is the result.
    pub last: bool,
    /// Bound on the error of this level, model units.
    pub(super) error: Option<f64>,
    /// Vertices of a range, while reading.
    pub(super) range: u64,
    /// Triangles of a sample of the blocks that it makes.
    pub(super) sample: u64,
    /// Keys by which its input is sorted; none while reading.
    pub(super) keys: Option<Keys>,
    /// Keys by which its output is sorted.
    pub(super) next: Option<Keys>,
    /// First key of every region.
    pub(super) cuts: Vec<u64>,
    /// Blocks that hold borders.
    pub(super) borders: Vec<String>,
    /// Whether tiles lie within their cells.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) aligned: bool,
}

/// A task: what it reads, what it makes, what it is told.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Number of the row in its manifest, from 0.
    pub id: u64,
    /// What it reads from the store: block, first page, one past the last.
    pub inputs: Vec<(String, u32, u32)>,
    /// What it puts into the store.
    pub output: String,
    /// First vertex, portion, bucket or region.
    pub first: u64,
    /// One past the last.
    pub end: u64,
    /// Triangles that it reads, where that is known.
    pub triangles: u64,
    /// Triangles that should be left.
    pub target: u64,
}

/// The tasks of one phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// What they share.
    pub phase: Phase,
    /// The tasks.
    pub rows: Vec<Row>,
}

/// What came of a row. Says nothing of when or where, so that it is the same each time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RowResult {
    /// Number of the row.
    pub id: u64,
    /// What it has put into the store.
    pub output: String,
    /// Checksum of that, or of what holds the checksums of all.
    pub checksum: u64,
    /// Triangles in it.
    pub triangles: u64,
}

impl Phase {
    /// Name of a file of this phase in the store.
    #[must_use]
    pub fn name(&self, rest: &str) -> String {
        format!("{:02}-{}{rest}", self.number, self.kind.name())
    }
}

impl Manifest {
    /// Name in the store.
    #[must_use]
    pub fn name(&self) -> String {
        self.phase.name(".tasks")
    }

    /// Name of what closes the phase.
    #[must_use]
    pub fn done_name(&self) -> String {
        self.phase.name(".done")
    }

    /// The row of this number.
    ///
    /// # Errors
    /// [`Error::NoRow`].
    pub fn row(&self, row: u64) -> Result<&Row> {
        let rows = self.rows.len() as u64;
        self.rows
            .get(row as usize)
            .ok_or(Error::NoRow { row, rows })
    }

    /// Puts the manifest into the store.
    ///
    /// # Errors
    /// Those of the store.
    pub fn save(&self, store: &dyn Store) -> Result<()> {
        let mut text = line(&self.phase);
        self.rows.iter().for_each(|row| text += &line(row));
        store.put(&self.name(), sealed(text).as_bytes())
    }

    /// Reads the manifest of this name.
    ///
    /// # Errors
    /// [`Error::Manifest`]; those of the store.
    pub fn load(store: &dyn Store, name: &str) -> Result<Self> {
        let text = unsealed(name, store.get(name)?)?;
        let mut lines = text.lines().zip(1..);
        let (first, _) = lines.next().unwrap_or_default();
        let phase = parsed(name, 1, first)?;
        let rows: Vec<Row> = lines
            .map(|(text, number)| parsed(name, number, text))
            .collect::<Result<_>>()?;
        match rows.iter().zip(0..).find(|(row, id)| row.id != *id) {
            None => Ok(Self { phase, rows }),
            Some((row, id)) => Err(Error::Manifest {
                name: name.into(),
                line: id as usize + 2,
                problem: format!("row {} where {id} should be", row.id),
            }),
        }
    }

    /// Closes the phase. Results may come in any order; of several for a row, which are the
    /// same, one counts.
    ///
    /// # Errors
    /// [`Error::NotDone`] if one is missing; those of the store.
    pub fn commit(&self, store: &dyn Store, mut results: Vec<RowResult>) -> Result<()> {
        results.sort_by_key(|result| result.id);
        results.dedup_by_key(|result| result.id);
        let rows = self.rows.len() as u64;
        let is_same = |row: &Row| {
            let result = results.get(row.id as usize);
            result.is_some_and(|r| r.id == row.id && r.output == row.output)
        };
        if let Some(row) = self.rows.iter().find(|row| !is_same(row)) {
            return Err(Error::NotDone { row: row.id, rows });
        }
        let text: String = results.iter().take(rows as usize).map(line).collect();
        store.put(&self.done_name(), sealed(text).as_bytes())
    }

    /// The results, if the phase is closed.
    ///
    /// # Errors
    /// [`Error::Manifest`]; those of the store.
    pub fn results(&self, store: &dyn Store) -> Result<Option<Vec<RowResult>>> {
        let name = self.done_name();
        if !store.exists(&name)? {
            return Ok(None);
        }
        let text = unsealed(&name, store.get(&name)?)?;
        let lines = text.lines().zip(1..);
        let results: Vec<RowResult> = lines
            .map(|(text, number)| parsed(&name, number, text))
            .collect::<Result<_>>()?;
        if results.len() == self.rows.len() {
            return Ok(Some(results));
        }
        Err(Error::Manifest {
            problem: format!("{} rows instead of {}", results.len(), self.rows.len()),
            line: results.len(),
            name,
        })
    }
}

fn line(value: &impl Serialize) -> String {
    // Plain data: there is nothing that could fail.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

/// With a last line that holds the checksum of those before.
fn sealed(text: String) -> String {
    let seal = checksum(text.as_bytes());
    format!("{text}\"{seal:016x}\"\n")
}

/// The lines before the checksum, if it is theirs.
///
/// # Errors
/// [`Error::Damaged`].
fn unsealed(name: &str, bytes: Vec<u8>) -> Result<String> {
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let end = text.trim_end().rfind('\n').map_or(0, |at| at + 1);
    let whole = &text[..end];
    if sealed(whole.to_owned()) == text {
        return Ok(whole.to_owned());
    }
    Err(Error::Damaged {
        name: name.into(),
        problem: "the checksum in its last line is another",
    })
}

fn parsed<T: DeserializeOwned>(name: &str, line: usize, text: &str) -> Result<T> {
    serde_json::from_str(text).map_err(|error| Error::Manifest {
        name: name.into(),
        line,
        problem: error.to_string(),
    })
}

/// Triangles of a portion, about ([`Source::chunks`](super::Source::chunks)).
pub(super) const PORTION: u64 = 1 << 16;
/// Samples of a model, about, so that a plan of any size fits into memory.
const SAMPLES: u64 = 1 << 21;
/// Triangles of a sample at least.
const LEAST_SAMPLE: u64 = 128;

/// Samples of a tile at least.
const TILE_SAMPLES: u64 = 32;

fn least_sample(plan: &Plan) -> u64 {
    let of_tile = |cut: TileCut| (cut.triangles / TILE_SAMPLES).max(1);
    let tiles = plan.options.tiles.map_or(LEAST_SAMPLE, of_tile);
    tiles.min(LEAST_SAMPLE)
}

/// A first phase, of a plan of which nothing has been done.
pub(super) fn bounds(plan: &Plan) -> Manifest {
    let phase = Phase {
        number: 0,
        kind: Kind::Bounds,
        level: 0,
        whole: 0,
        triangles: 0,
        target: 0,
        last: false,
        error: None,
        range: 0,
        sample: (plan.chunks * PORTION / SAMPLES).max(least_sample(plan)),
        keys: None,
        next: None,
        cuts: Vec::new(),
        borders: Vec::new(),
        aligned: false,
    };
    let step = plan.options.block_triangles.max(1);
    rows(phase, plan.vertices, step, ".json")
}

/// A manifest whose rows take `step` of `count` things each.
pub(super) fn rows(phase: Phase, count: u64, step: u64, kind: &str) -> Manifest {
    let row = |id| Row {
        id,
        output: phase.name(&format!("-{id:06}{kind}")),
        first: id * step,
        end: ((id + 1) * step).min(count),
        ..Row::default()
    };
    let rows = (0..count.div_ceil(step)).map(row).collect();
    Manifest { phase, rows }
}
