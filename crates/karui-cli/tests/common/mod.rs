//! Runs the binary and looks at what it left behind.
#![allow(dead_code, reason = "every test binary uses its own part")]

use karui::mesh::{NamedMesh, Node, Scene, Transform, shapes};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// The binary, ready for arguments.
pub fn karui() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_karui"));
    command.env_remove("KARUI_MODELS").env("NO_COLOR", "1");
    command
}

/// What a run said, and its exit code.
#[derive(Debug)]
pub struct Ran {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        Self {
            code: output.status.code(),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    }
}

impl Ran {
    /// The one JSON document on standard output.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }
}

/// A folder of its own for every test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs the binary in this folder; arguments are separated by spaces.
    pub fn run(&self, args: &str) -> Ran {
        let args = args.split_whitespace();
        karui()
            .current_dir(&self.0)
            .args(args)
            .output()
            .unwrap()
            .into()
    }

    /// Runs the binary and insists on success.
    pub fn ok(&self, args: &str) -> Ran {
        let ran = self.run(args);
        assert_eq!(ran.code, Some(0), "karui {args}: {ran:?}");
        ran
    }

    /// Runs the binary and insists on an exit code, an error line, and that no
    /// file came to be or changed.
    pub fn fails(&self, code: i32, args: &str) -> Ran {
        let before = self.files();
        let ran = self.run(args);
        assert_eq!(ran.code, Some(code), "karui {args}: {ran:?}");
        assert!(ran.err.contains("error: "), "karui {args}: {ran:?}");
        assert!(!ran.err.contains("panicked"), "karui {args}: {ran:?}");
        assert_eq!(self.files(), before, "karui {args}");
        ran
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.read(name)).unwrap()
    }

    /// All files and folders below, with the files' content.
    pub fn files(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut files = Vec::new();
        list(self.0.path(), &mut files);
        files.sort();
        files
    }

    /// Names of the files right in `folder`, in order.
    pub fn names(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).unwrap();
        let name = |e: std::io::Result<std::fs::DirEntry>| e.unwrap().file_name();
        let mut names: Vec<_> = entries
            .map(name)
            .map(|n| n.into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    pub fn scene(&self, name: &str, scene: &Scene) {
        karui_io::write(self.path(name), scene).unwrap();
    }

    /// Two meshes; one of them stands in two places.
    pub fn family(&self, name: &str) {
        let named = |name: &str, mesh| NamedMesh {
            name: Some(name.to_owned()),
            mesh,
        };
        let node = |mesh, x| Node {
            mesh: Some(mesh),
            transform: Transform::Trs {
                translation: glam::Vec3::X * x,
                rotation: glam::Quat::IDENTITY,
                scale: glam::Vec3::ONE,
            },
            ..Node::default()
        };
        let scene = Scene {
            meshes: vec![
                named("ball", shapes::textured_sphere(24, 32)),
                named("ring", shapes::torus(1.0, 0.4, 48, 24)),
            ],
            nodes: vec![node(0, 0.0), node(1, 3.0), node(1, 6.0)],
            roots: vec![0, 1, 2],
            ..Scene::default()
        };
        self.scene(name, &scene);
    }

    /// A terrain of 2 * 40 * 30 triangles.
    pub fn terrain(&self, name: &str) {
        self.scene(name, &Scene::from_mesh(shapes::terrain(40, 30, 1)));
    }
}

fn list(folder: &Path, files: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            list(&path, files);
            files.push((path, Vec::new()));
        } else {
            let content = std::fs::read(&path).unwrap();
            files.push((path, content));
        }
    }
}
