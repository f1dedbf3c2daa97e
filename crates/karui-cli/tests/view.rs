//! `karui view`: begins, answers, ends.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, karui};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};

/// A viewer of a family, and the line it prints.
fn viewer(folder: &Folder, args: &[&str]) -> (Child, String) {
    folder.family("family.glb");
    let mut child = karui()
        .args(["view", "--no-open"])
        .args(args)
        .arg(folder.path("family.glb"))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let out = child.stdout.as_mut().unwrap();
    BufReader::new(out).read_line(&mut line).unwrap();
    (child, line.trim_end().to_owned())
}

fn get(url: &str) -> String {
    let (host, path) = url
        .strip_prefix("http://")
        .unwrap()
        .split_once('/')
        .unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let request = format!("GET /{path} HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

#[cfg(unix)]
#[test]
fn it_answers_until_it_is_interrupted() {
    let folder = Folder::new();
    let before = folder.files().len();
    let (mut child, url) = viewer(&folder, &["--quiet"]);
    assert!(get(&url).contains("<title>Karui</title>"));
    assert!(get(&format!("{url}api/state")).contains("family.glb"));
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(folder.files().len(), before + 1, "nothing is written");
}

#[test]
fn the_address_is_one_line_also_as_json() {
    let folder = Folder::new();
    let (mut child, line) = viewer(&folder, &["--json"]);
    child.kill().unwrap();
    child.wait().unwrap();
    let told: serde_json::Value = serde_json::from_str(&line).unwrap();
    assert!(
        told["url"]
            .as_str()
            .unwrap()
            .starts_with("http://127.0.0.1:")
    );
}

#[test]
fn what_cannot_be_shown_is_said_at_once() {
    let folder = Folder::new();
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\n");
    folder.write("broken.glb", "glTF");
    for name in ["none.obj", "points.obj", "broken.glb", "none.json"] {
        let ran = folder.fails(2, &format!("view --no-open {name}"));
        assert!(ran.err.contains(name), "{ran:?}");
    }
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let ran = folder.fails(2, &format!("view --no-open --port {port}"));
    assert!(
        ran.err.contains(&port.to_string()) && ran.err.contains("hint: "),
        "{ran:?}"
    );
}
