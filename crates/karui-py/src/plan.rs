//! Models larger than memory, for Python: a plan, and its tasks one by one.

use crate::choice::choice;
use crate::errors::{FileError, InputError, Raise};
use crate::progress::run;
use crate::result::Summary;
use karui::outofcore::{
    self as lib, Folder, Manifest, Next, PlanOptions, Result, RowResult, RunOptions, Scheme, Source,
};
use karui_io::{Format, slices::PlyWriter};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use std::path::{Path, PathBuf, absolute};
use std::sync::{Arc, Mutex, PoisonError};

const SCHEMES: [(&str, Scheme); 3] = [
    ("cells", Scheme::Cells),
    ("sweep", Scheme::Sweep),
    ("slabs", Scheme::Slabs),
];
/// Times that lost inputs of a task are made anew before it is given up.
const TRIES: usize = 100;

impl Raise for lib::Error {
    fn raise(self) -> PyErr {
        let said = self.to_string();
        match self {
            Self::Source(cause) | Self::Sink(cause) => match cause.downcast::<karui_io::Error>() {
                Ok(cause) => cause.raise(),
                Err(_) => InputError::new_err(said),
            },
            Self::Block(error) => error.raise(),
            Self::Store { .. } | Self::Missing { .. } | Self::Damaged { .. } => {
                FileError::new_err(said)
            }
            _ => InputError::new_err(said),
        }
    }
}

/// What is to be made of a model that may be larger than memory: phases of tasks that do not need
/// each other, over blocks in a folder. What comes out depends on the model and the options only.
///
/// `run` does all of it here, `karui.cluster.run` on many machines; either goes on from what is
/// there. The other methods are what these are made of.
#[pyclass(frozen, module = "karui")]
pub struct Plan {
    store: Folder,
    plan: lib::Plan,
    source: Box<dyn Source + Send>,
    /// The manifest that was used last.
    manifest: Mutex<Option<(String, Arc<Manifest>)>>,
}

impl Plan {
    fn of(store: Folder, plan: lib::Plan, source: Box<dyn Source + Send>) -> Self {
        let manifest = Mutex::default();
        Self {
            store,
            plan,
            source,
            manifest,
        }
    }

    fn manifest(&self, phase: &str) -> Result<Arc<Manifest>> {
        let mut last = self.manifest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((name, manifest)) = &*last
            && name == phase
        {
            return Ok(Arc::clone(manifest));
        }
        let loaded = Arc::new(Manifest::load(&self.store, &format!("{phase}.tasks"))?);
        *last = Some((phase.to_owned(), Arc::clone(&loaded)));
        Ok(loaded)
    }

    /// Does something; as long as that fails for an output of an earlier task, makes that anew.
    fn mended<T>(&self, what: impl Fn() -> Result<T>) -> Result<T> {
        let mut outcome = what();
        for _ in 0..TRIES {
            let Some(lost) = outcome.as_ref().err().and_then(lib::Error::lost) else {
                break;
            };
            if !lib::rebuild(&self.store, &*self.source, lost)? {
                break;
            }
            outcome = what();
        }
        outcome
    }
}

#[pymethods]
impl Plan {
    /// A plan for a model (PLY, OBJ, binary STL, glTF or raw; not gzipped), kept in the folder `store`, which is made if need
    /// be. If there is a plan already, it must be the same.
    ///
    /// ratio (0 to 1), triangles, error (model units): what is to be left, as in `simplify`.
    /// memory_limit: bytes, from which the size of blocks follows. block_triangles: that size
    /// itself; by default 1,048,576. scheme: how blocks are cut: "cells", "sweep"
    /// (slabs of as much work each) or "slabs" (of as many triangles each).
    ///
    /// Raises FileError and InputError.
    #[staticmethod]
    #[pyo3(signature = (store, model, *, ratio=None, triangles=None, error=None, memory_limit=None,
        block_triangles=None, scheme="cells"))]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are keywords of a Python function"
    )]
    fn create(
        py: Python<'_>,
        store: PathBuf,
        model: PathBuf,
        ratio: Option<f64>,
        triangles: Option<u64>,
        error: Option<f64>,
        memory_limit: Option<u64>,
        block_triangles: Option<u64>,
        scheme: &str,
    ) -> PyResult<Self> {
        let usual = PlanOptions::default();
        let limited = memory_limit.map(PlanOptions::block_triangles_for);
        let options = PlanOptions {
            triangles,
            ratio,
            error,
            block_triangles: block_triangles.or(limited).unwrap_or(usual.block_triangles),
            scheme: choice("scheme", scheme, &SCHEMES)?,
            ..usual
        };
        let uri = absolute(&model)?;
        let source = opened(py, &uri)?;
        let plan = lib::Plan::new(&*source, &uri.to_string_lossy(), options);
        let plan = plan.map_err(Raise::raise)?;
        let store = run(py, None, |_| {
            let store = Folder::create(&absolute(&store).unwrap_or(store))?;
            plan.save(&store).map(|()| store)
        })?;
        Ok(Self::of(store, plan, source))
    }

    /// The plan that a folder has.
    ///
    /// Raises FileError if there is none, or the model cannot be read, and InputError.
    #[classmethod]
    fn open(_: &Bound<'_, PyType>, py: Python<'_>, store: PathBuf) -> PyResult<Self> {
        let store = Folder::open(&absolute(&store)?);
        let plan = run(py, None, |_| lib::Plan::load(&store))?;
        let source = opened(py, Path::new(&plan.source))?;
        Ok(Self::of(store, plan, source))
    }

    /// The folder, as an absolute path.
    #[getter]
    fn store(&self) -> PathBuf {
        self.store.root().to_owned()
    }

    /// The model, as an absolute path.
    #[getter]
    fn model(&self) -> &str {
        &self.plan.source
    }

    /// Does all that is not done yet, here. memory_limit: bytes, from which follows how many tasks
    /// run at the same time; by default one does. progress: called with a phase and a share of
    /// all of the work, writing included; returning False cancels.
    ///
    /// Called again, it goes on from there. Raises FileError, InputError and Cancelled.
    #[pyo3(signature = (*, memory_limit=None, progress=None))]
    fn run(
        &self,
        py: Python<'_>,
        memory_limit: Option<u64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let workers = memory_limit.map_or(1, |bytes| self.plan.options.workers_for(bytes));
        run(py, progress, |progress| {
            let options = RunOptions { workers, progress };
            lib::run(&self.store, &*self.source, &self.plan, &options).map(drop)
        })
    }

    /// Writes the result to a PLY file, piece by piece; all of it or nothing. progress: called with
    /// "write" and a share of the whole work; returning False cancels.
    ///
    /// Raises InputError if there are phases that are not done or it is no .ply, FileError and
    /// Cancelled.
    #[pyo3(signature = (path, *, progress=None))]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Summary> {
        let format = Format::from_path(&path).map_err(Raise::raise)?;
        if format != Format::Ply || path.extension().is_some_and(|e| e == "gz") {
            return Err(InputError::new_err("a result can be written as .ply only"));
        }
        let next = run(py, None, |_| {
            self.mended(|| lib::next(&self.store, &self.plan))
        })?;
        let Next::Done(last) = next else {
            return Err(InputError::new_err(
                "the plan is not done yet: `run` it first",
            ));
        };
        let writer = run(py, None, |_| PlyWriter::create(&path))?;
        let (summary, writer) = run(py, progress, |progress| {
            let mut writer = writer;
            lib::write(&self.store, &last, &mut writer, progress).map(|summary| (summary, writer))
        })?;
        run(py, None, |_| writer.finish())?;
        Ok(summary.into())
    }

    /// Names of outputs that are missing, damaged or not what they were.
    fn verify(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        run(py, None, |_| lib::verify(&self.store))
    }

    /// Name of the phase that is to be run, and how many rows it has; None if all is done.
    fn next(&self, py: Python<'_>) -> PyResult<Option<(String, usize)>> {
        let next = run(py, None, |_| {
            self.mended(|| lib::next(&self.store, &self.plan))
        })?;
        Ok(match next {
            Next::Run(manifest) => Some((manifest.phase.name(""), manifest.rows.len())),
            Next::Done(_) => None,
        })
    }

    /// Runs a row of a phase; run twice, anywhere, it makes the same. Outputs of earlier phases
    /// that are lost are made anew.
    ///
    /// Raises FileError and InputError.
    fn run_task<'py>(
        &self,
        py: Python<'py>,
        phase: &str,
        row: u64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let result = run(py, None, |progress| {
            let manifest = self.manifest(phase)?;
            self.mended(|| lib::run_task(&self.store, &*self.source, &manifest, row, progress))
        })?;
        dictionary(py, &result)
    }

    /// What `run_task` would return, if the output of the row is there and whole; else None.
    ///
    /// Raises FileError and InputError.
    fn verify_task<'py>(
        &self,
        py: Python<'py>,
        phase: &str,
        row: u64,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let found = run(py, None, |_| {
            let manifest = self.manifest(phase)?;
            match lib::verify_task(&self.store, &manifest, row) {
                Err(error) if error.lost().is_some() => Ok(None),
                found => found.map(Some),
            }
        })?;
        found.map(|result| dictionary(py, &result)).transpose()
    }

    /// Closes a phase, with the results of all its rows, in any order.
    ///
    /// Raises FileError, and InputError if a row is missing.
    fn commit(&self, py: Python<'_>, phase: &str, results: Vec<Bound<'_, PyDict>>) -> PyResult<()> {
        let results = results.iter().map(result_of).collect::<PyResult<_>>()?;
        run(py, None, |_| {
            self.manifest(phase)?.commit(&self.store, results)
        })
    }

    fn __repr__(&self) -> String {
        let (model, store) = (&self.plan.source, self.store.root().display());
        format!("<karui.Plan for {model} in {store}>")
    }
}

fn opened(py: Python<'_>, path: &Path) -> PyResult<Box<dyn Source + Send>> {
    run(py, None, |_| karui_io::slices::open(path))
}

fn dictionary<'py>(py: Python<'py>, result: &RowResult) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("id", result.id)?;
    found.set_item("output", &result.output)?;
    found.set_item("checksum", result.checksum)?;
    found.set_item("triangles", result.triangles)?;
    Ok(found)
}

fn result_of(found: &Bound<'_, PyDict>) -> PyResult<RowResult> {
    let value = |key: &str| {
        let value = found.get_item(key)?;
        value.ok_or_else(|| InputError::new_err(format!("a result has no `{key}`")))
    };
    Ok(RowResult {
        id: value("id")?.extract()?,
        output: value("output")?.extract()?,
        checksum: value("checksum")?.extract()?,
        triangles: value("triangles")?.extract()?,
    })
}
