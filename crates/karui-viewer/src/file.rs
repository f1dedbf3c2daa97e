//! Files by number.

use crate::error::{Error, Result};
use crate::model::Model;
use crate::refusal::Refusal;
use crate::tileset::Tileset;
use axum::body::Bytes;
use karui_io::ReadOptions;
use std::path::{Path, PathBuf};

/// A file that was named on the command line or dropped on the page.
#[derive(Debug)]
pub struct File {
    /// Its name without folders.
    pub name: String,
    /// What it holds.
    pub content: Content,
}

/// What a file holds.
#[derive(Debug)]
pub enum Content {
    /// A model.
    Model(Box<Model>),
    /// The root of 3D Tiles.
    Tileset(Tileset),
}

/// Where a file is, for what reads it anew.
#[derive(Debug)]
pub enum Origin {
    /// On the disk, as named on the command line.
    Disk(PathBuf),
    /// In memory, as dropped.
    Memory(Bytes),
}

impl Origin {
    /// Size of the file; 0 if it has gone from the disk.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Disk(path) => std::fs::metadata(path).map_or(0, |m| m.len()),
            Self::Memory(bytes) => bytes.len() as u64,
        }
    }
}

impl File {
    /// Reads a file: a tileset if it is JSON, else a model.
    pub fn open(path: &Path) -> Result<Self> {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let is_json = path.extension().is_some_and(|e| e == "json");
        let content = match is_json {
            true => Content::Tileset(Tileset::open(path)?),
            false => Content::Model(Box::new(model(path)?)),
        };
        let name = name.to_string_lossy().into_owned();
        Ok(Self { name, content })
    }

    /// Reads a file that was dropped. Its name tells the format and is shown, nothing else.
    pub fn dropped(name: &str, bytes: Bytes) -> Result<Self, Refusal> {
        let loaded = karui_io::read_sent(name, &bytes, &ReadOptions::default())?;
        if loaded.scene.triangle_count() == 0 {
            return Err(Refusal::unusable(format!(
                "{name}: the model has no triangles"
            )));
        }
        let model = Model::new(loaded, Origin::Memory(bytes))?;
        Ok(Self {
            name: name.to_owned(),
            content: Content::Model(Box::new(model)),
        })
    }

    /// The model.
    ///
    /// # Errors
    /// A [`Refusal`] for a tileset.
    pub fn model(&self) -> Result<&Model, Refusal> {
        match &self.content {
            Content::Model(model) => Ok(model),
            Content::Tileset(_) => {
                let message = format!("{} is a tileset, not a model", self.name);
                Err(Refusal::missing(message))
            }
        }
    }
}

fn model(path: &Path) -> Result<Model> {
    let loaded = karui_io::read_with(path, &ReadOptions::default())?;
    if loaded.scene.triangle_count() == 0 {
        return Err(Error::NoTriangles(path.to_owned()));
    }
    let (path, origin) = (path.to_owned(), Origin::Disk(path.to_owned()));
    Model::new(loaded, origin).map_err(|error| Error::Model { path, error })
}
