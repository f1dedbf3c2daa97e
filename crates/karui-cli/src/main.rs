//! The `karui` command line.

fn main() {}
