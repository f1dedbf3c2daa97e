//! `docs/cli.md` is what `--help` says; a test keeps it so.

use crate::args::Cli;
use clap::{Command, CommandFactory};

const HEAD: &str = "\
# Command line

What `karui --help` and `karui <command> --help` say. Written by
`KARUI_BLESS=1 cargo test -p karui-cli --bin karui reference`; a test fails if it is out of date.
";

fn reference() -> String {
    let mut root = Cli::command().term_width(100);
    root.build();
    let mut text = HEAD.to_owned();
    section(&mut root, "##", &mut text);
    text
}

fn section(command: &mut Command, level: &str, text: &mut String) {
    let name = command.get_bin_name().unwrap_or("karui").to_owned();
    let help = command
        .clone()
        .term_width(100)
        .render_long_help()
        .to_string();
    let lines: Vec<&str> = help.lines().map(str::trim_end).collect();
    *text += &format!(
        "\n{level} {name}\n```text\n{}\n```\n",
        lines.join("\n").trim_end()
    );
    for sub in command.get_subcommands_mut() {
        if !sub.is_hide_set() && sub.get_name() != "help" {
            section(sub, "###", text);
        }
    }
}

#[test]
fn reference_is_up_to_date() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/cli.md");
    let now = reference();
    if std::env::var_os("KARUI_BLESS").is_some() {
        std::fs::write(file, &now).unwrap();
    }
    let written = std::fs::read_to_string(file).unwrap();
    assert!(
        written == now,
        "docs/cli.md is out of date; its head says how to write it anew"
    );
}

#[test]
fn arguments_are_consistent() {
    Cli::command().debug_assert();
}
