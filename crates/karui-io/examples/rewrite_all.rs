//! Writes every model below a folder back as GLB (or `.gltf`), for the Khronos
//! validator to look at:
//!
//! ```text
//! cargo run --example rewrite_all -- MODELS OUT [--gltf] [--quantize] [--meshopt]
//! node tools/validate_gltf.mjs $(find OUT -name '*.glb')
//! ```
#![allow(clippy::print_stdout, reason = "it is a program")]

use karui_io::{Format, GltfOptions, WriteOptions};
use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};

fn main() -> Result<(), Box<dyn Error>> {
    let (flags, folders): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with("--"));
    let [models, out] = folders.as_slice() else {
        return Err("usage: rewrite_all MODELS OUT [--gltf] [--quantize] [--meshopt]".into());
    };
    let has = |flag: &str| flags.iter().any(|f| f == flag);
    let options = WriteOptions {
        gltf: GltfOptions {
            quantize: has("--quantize"),
            meshopt: has("--meshopt"),
            ..GltfOptions::default()
        },
        ..WriteOptions::default()
    };
    let extension = if has("--gltf") { "gltf" } else { "glb" };
    let (mut written, mut failed) = (0, 0);
    for file in files_below(Path::new(models))? {
        if Format::from_path(&file).is_err() {
            continue;
        }
        let target = target(Path::new(models), &file, Path::new(out), extension);
        match rewrite(&file, &target, &options) {
            Ok(()) => written += 1,
            Err(error) => {
                println!("FAILED {error}");
                failed += 1;
            }
        }
    }
    println!("{written} written, {failed} failed");
    Ok(())
}

fn rewrite(file: &Path, target: &Path, options: &WriteOptions) -> Result<(), Box<dyn Error>> {
    let scene = karui_io::read(file)?;
    if let Some(folder) = target.parent() {
        fs::create_dir_all(folder)?;
    }
    karui_io::write_with(target, &scene, options)?;
    Ok(())
}

/// `models/a/b.obj.gz` as `out/a/b.obj.gz.glb`.
fn target(models: &Path, file: &Path, out: &Path, extension: &str) -> PathBuf {
    let below = file.strip_prefix(models).unwrap_or(file);
    let mut name = out.join(below).into_os_string();
    name.push(".");
    name.push(extension);
    name.into()
}

fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
