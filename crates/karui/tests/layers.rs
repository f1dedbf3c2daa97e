//! Holds the modules to the layers drawn in `ARCHITECTURE.md`.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};
use syn::{Item, ItemMod, ItemUse, UseTree, visit::Visit};

/// Modules below every row, which any module may use.
const GROUND: [&str; 2] = ["error", "progress"];

#[test]
fn modules_use_lower_rows_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let drawing = fs::read_to_string(root.join("../../ARCHITECTURE.md")).expect("drawing");
    let layers = Layers::new(&drawing, &parse(&root.join("src/lib.rs")));
    let mut files = Vec::new();
    rust_files(&root.join("src"), &mut files);
    files.sort();
    let mut uses = 0;
    let mut broken = Vec::new();
    for file in files.iter().filter(|f| !f.ends_with("lib.rs")) {
        let module = module_of(file.strip_prefix(root.join("src")).expect("below src"));
        for used in uses_of(&parse(file), &module) {
            uses += 1;
            broken.extend(layers.complaint(&module[0], &used));
        }
    }
    assert!(uses > 20, "only {uses} uses found");
    assert_eq!(broken, Vec::<String>::new());
}

/// Row of every module, and which module a name re-exported at the root is of.
struct Layers {
    rows: BTreeMap<String, usize>,
    root_names: BTreeMap<String, String>,
}

impl Layers {
    fn new(drawing: &str, lib: &syn::File) -> Self {
        let (_, section) = drawing.split_once("## Layers of `karui`").expect("section");
        let block = section.split("```").nth(1).expect("block");
        let mut rows = BTreeMap::new();
        for (row, line) in block.lines().filter(|l| !l.trim().is_empty()).enumerate() {
            rows.extend(line.split('|').map(|m| (m.trim().to_owned(), row + 1)));
        }
        rows.extend(GROUND.map(|m| (m.to_owned(), 0)));
        let mut root_names = BTreeMap::new();
        for item in &lib.items {
            if let Item::Use(item) = item {
                let mut paths = Vec::new();
                flatten(&item.tree, &mut Vec::new(), &mut paths);
                root_names.extend(paths.into_iter().filter_map(by_last_name));
            }
        }
        Self { rows, root_names }
    }

    fn complaint(&self, user: &str, used: &str) -> Option<String> {
        let used = self.root_names.get(used).map_or(used, String::as_str);
        if used == user {
            return None;
        }
        match (self.rows.get(user), self.rows.get(used)) {
            (Some(user_row), Some(used_row)) if used_row < user_row || *used_row == 0 => None,
            (Some(_), Some(_)) => Some(format!("{user} uses {used}")),
            (None, _) => Some(format!("{user} is not in the drawing")),
            (_, None) => Some(format!("{user} uses {used}, which is not in the drawing")),
        }
    }
}

fn by_last_name(path: Vec<String>) -> Option<(String, String)> {
    Some((path.last()?.clone(), path.first()?.clone()))
}

fn parse(file: &Path) -> syn::File {
    let text = fs::read_to_string(file).expect("readable source");
    syn::parse_file(&text).expect("valid Rust")
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("folder") {
        let path = entry.expect("entry").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// `mesh/shapes/cube.rs` is `mesh::shapes::cube`, `mesh/mod.rs` is `mesh`.
fn module_of(file: &Path) -> Vec<String> {
    let path = file.with_extension("");
    let names = path.components().map(|c| c.as_os_str().to_string_lossy());
    names
        .filter(|name| name != "mod")
        .map(|n| n.into_owned())
        .collect()
}

/// First names below the crate root that `file` uses, its tests excepted.
fn uses_of(file: &syn::File, module: &[String]) -> Vec<String> {
    let mut collector = Collector {
        module: module.to_vec(),
        found: Vec::new(),
    };
    if module.last().is_none_or(|name| name != "tests") {
        collector.visit_file(file);
    }
    collector.found
}

struct Collector {
    module: Vec<String>,
    found: Vec<String>,
}

impl Collector {
    /// Follows `crate`, `self` and `super`; other paths stay inside or leave
    /// the crate.
    fn note(&mut self, path: &[String]) {
        let supers = path.iter().take_while(|name| *name == "super").count();
        let inside = self.module.len().saturating_sub(supers);
        let below_root = match path.first().map(String::as_str) {
            Some("crate") => path.get(1),
            Some("super") if inside == 0 => path.get(supers),
            _ => None,
        };
        self.found.extend(below_root.cloned());
    }
}

impl<'ast> Visit<'ast> for Collector {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if item.ident != "tests" {
            self.module.push(item.ident.to_string());
            syn::visit::visit_item_mod(self, item);
            self.module.pop();
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let mut paths = Vec::new();
        flatten(&item.tree, &mut Vec::new(), &mut paths);
        paths.iter().for_each(|path| self.note(path));
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<_> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        self.note(&names);
        syn::visit::visit_path(self, path);
    }
}

fn flatten(tree: &UseTree, prefix: &mut Vec<String>, paths: &mut Vec<Vec<String>>) {
    let name = match tree {
        UseTree::Path(part) => &part.ident,
        UseTree::Name(last) => &last.ident,
        UseTree::Rename(last) => &last.ident,
        UseTree::Glob(_) => return paths.push(prefix.clone()),
        UseTree::Group(group) => {
            return group.items.iter().for_each(|t| flatten(t, prefix, paths));
        }
    };
    prefix.push(name.to_string());
    match tree {
        UseTree::Path(part) => flatten(&part.tree, prefix, paths),
        _ => paths.push(prefix.clone()),
    }
    prefix.pop();
}

fn complaints(module: &str, text: &str) -> Vec<String> {
    let drawing = "## Layers of `karui`\n```\ngeom\nmesh\nsimplify | metrics\n```\n";
    let lib = syn::parse_str("pub use error::Error; pub use mesh::{PolyMesh, TriMesh};");
    let lib = lib.expect("valid Rust");
    let layers = Layers::new(drawing, &lib);
    let module: Vec<_> = module.split("::").map(str::to_owned).collect();
    let file = syn::parse_str(text).expect("valid Rust");
    uses_of(&file, &module)
        .iter()
        .filter_map(|used| layers.complaint(&module[0], used))
        .collect()
}

#[test]
fn every_way_up_is_found() {
    assert!(complaints("metrics", "use crate::{Error, TriMesh, geom::Aabb};").is_empty());
    assert_eq!(
        complaints("mesh", "use crate::{geom::A, metrics::B};").len(),
        1
    );
    assert_eq!(complaints("metrics", "use crate::simplify::A;").len(), 1);
    assert_eq!(
        complaints("geom", "fn f() -> crate::TriMesh { g() }").len(),
        1
    );
    assert_eq!(complaints("mesh::a", "use super::super::metrics;").len(), 1);
    assert_eq!(complaints("mesh::a", "use super::metrics;").len(), 0);
    assert_eq!(
        complaints("mesh", "mod b { use super::super::metrics; }").len(),
        1
    );
    assert_eq!(
        complaints("mesh", "mod tests { use crate::metrics; }").len(),
        0
    );
    assert_eq!(complaints("new", "use crate::mesh;").len(), 1);
}
