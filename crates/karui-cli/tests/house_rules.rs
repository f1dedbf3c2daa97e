//! Limits that review should not have to count: lengths of functions and files,
//! unfinished code, printing libraries.

use std::{
    fs,
    path::{Path, PathBuf},
};
use syn::{ItemFn, ItemMod, Macro, spanned::Spanned, visit::Visit};

const FUNCTION_LINES: usize = 120;
const FILE_LINES: usize = 800;
const UNFINISHED: [&str; 3] = ["todo", "unimplemented", "dbg"];
const PRINTING: [&str; 4] = ["print", "println", "eprint", "eprintln"];

#[test]
fn sources_keep_the_house_rules() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files = Vec::new();
    for folder in ["crates", "examples", "fuzz"] {
        rust_files(&root.join(folder), &mut files);
    }
    files.sort();
    assert!(files.len() > 20, "only {} files found", files.len());
    let mut report = Report::default();
    for file in &files {
        let text = fs::read_to_string(file).expect("readable source");
        report.check(&file.display().to_string(), &text, is_library(file));
    }
    let lengths = &mut report.function_lines;
    lengths.sort_unstable();
    println!(
        "{} files, {} functions: median {} lines, 90 % within {}, longest {}",
        files.len(),
        lengths.len(),
        lengths[lengths.len() / 2],
        lengths[lengths.len() * 9 / 10],
        lengths[lengths.len() - 1],
    );
    assert_eq!(report.broken, Vec::<String>::new());
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("readable folder").path();
        if path.is_dir() && !path.ends_with("target") {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Whether the file ends up in a library: binaries, tests and examples may print.
fn is_library(file: &Path) -> bool {
    let has = |name: &str| file.components().any(|c| c.as_os_str() == name);
    let tests = file.file_stem().is_some_and(|s| s == "tests");
    has("src") && !has("karui-cli") && !has("bin") && !tests
}

#[derive(Default)]
struct Report {
    function_lines: Vec<usize>,
    broken: Vec<String>,
    file: String,
    library: bool,
}

impl Report {
    fn check(&mut self, name: &str, text: &str, library: bool) {
        (self.file, self.library) = (name.to_owned(), library);
        let lines = text.lines().count();
        if lines > FILE_LINES {
            self.broken.push(format!("{name}: {lines} lines"));
        }
        let syntax = syn::parse_file(text).expect("valid Rust");
        self.visit_file(&syntax);
    }

    fn function(&mut self, name: &syn::Ident, start: usize, end: usize) {
        let lines = end + 1 - start;
        self.function_lines.push(lines);
        if lines > FUNCTION_LINES {
            let file = &self.file;
            self.broken
                .push(format!("{file}: {name} has {lines} lines"));
        }
    }
}

impl<'ast> Visit<'ast> for Report {
    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        let (start, end) = (item.sig.span().start(), item.block.span().end());
        self.function(&item.sig.ident, start.line, end.line);
        syn::visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        let (start, end) = (item.sig.span().start(), item.block.span().end());
        self.function(&item.sig.ident, start.line, end.line);
        syn::visit::visit_impl_item_fn(self, item);
    }

    /// Tests inside a library may print, e.g. why they were skipped.
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        let outside = self.library;
        self.library &= item.ident != "tests";
        syn::visit::visit_item_mod(self, item);
        self.library = outside;
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        let unfinished = UNFINISHED.iter().any(|name| call.path.is_ident(name));
        let prints = PRINTING.iter().any(|name| call.path.is_ident(name));
        if unfinished || (prints && self.library) {
            let (file, line) = (&self.file, call.span().start().line);
            self.broken.push(format!("{file}:{line}: forbidden macro"));
        }
        syn::visit::visit_macro(self, call);
    }
}

fn broken(text: &str, library: bool) -> Vec<String> {
    let mut report = Report::default();
    report.check("f.rs", text, library);
    report.broken
}

#[test]
fn long_functions_and_files_are_found() {
    let body = "    call();\n".repeat(FUNCTION_LINES - 1);
    let function = format!("fn f() {{\n{body}}}\n");
    assert_eq!(broken(&function, true), ["f.rs: f has 121 lines"]);
    assert_eq!(broken(&format!("impl S {{ {function} }}"), true).len(), 1);
    let file = "const A: u8 = 1;\n".repeat(FILE_LINES + 1);
    assert_eq!(broken(&file, true), ["f.rs: 801 lines"]);
}

#[test]
fn forbidden_macros_are_found() {
    assert_eq!(broken("fn f() { todo!() }", false).len(), 1);
    assert_eq!(broken("\nfn f() { println!(\"x\"); }", true).len(), 1);
    assert!(broken("fn f() { println!(\"x\"); }", false).is_empty());
    assert!(broken("mod tests { fn f() { println!(\"x\"); } }", true).is_empty());
}
