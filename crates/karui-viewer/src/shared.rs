//! What all requests share.

use crate::error::Result;
use crate::file::File;
use crate::job::Jobs;
use crate::live::MAX_SESSIONS;
use crate::refusal::Refusal;
use crate::token::random_token;
use axum::http::StatusCode;
use std::sync::{Arc, PoisonError, RwLock};
use tokio::sync::Semaphore;

/// Files that are kept, named and dropped ones together.
const MAX_FILES: usize = 256;

/// The state of a viewer.
#[derive(Debug)]
pub struct Shared {
    /// What an address has to contain.
    pub token: String,
    /// Port that is listened on.
    pub port: u16,
    /// Largest file that may be dropped, bytes.
    pub upload_bytes: usize,
    /// Long work.
    pub jobs: Jobs,
    /// Places for live refinement.
    pub sessions: Arc<Semaphore>,
    files: RwLock<Vec<Arc<File>>>,
}

impl Shared {
    /// The state at the start.
    pub fn new(files: Vec<File>, port: u16, upload_bytes: usize) -> Result<Self> {
        Ok(Self {
            token: random_token()?,
            port,
            upload_bytes,
            jobs: Jobs::default(),
            sessions: Arc::new(Semaphore::new(MAX_SESSIONS)),
            files: RwLock::new(files.into_iter().map(Arc::new).collect()),
        })
    }

    /// All files by their number.
    pub fn files(&self) -> Vec<Arc<File>> {
        self.files
            .read()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// The file of a number.
    pub fn file(&self, id: usize) -> Result<Arc<File>, Refusal> {
        let files = self.files();
        let file = files.get(id).cloned();
        file.ok_or_else(|| Refusal::missing(format!("there is no file {id}")))
    }

    /// Takes in another file and tells its number.
    pub fn add(&self, file: File) -> Result<usize, Refusal> {
        let mut files = self.files.write().unwrap_or_else(PoisonError::into_inner);
        if files.len() >= MAX_FILES {
            let message = format!("{MAX_FILES} files are open already; start the viewer anew");
            return Err(Refusal::new(StatusCode::INSUFFICIENT_STORAGE, message));
        }
        files.push(Arc::new(file));
        Ok(files.len() - 1)
    }
}
