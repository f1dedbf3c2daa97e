//! Who is answered.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[allow(dead_code, reason = "each test file uses a part of it")]
mod common;

use common::{Answer, Running};

fn ask(viewer: &Running, path: &str, headers: &[String]) -> Answer {
    let lines: String = headers.iter().map(|h| format!("{h}\r\n")).collect();
    let request = format!("GET {path} HTTP/1.1\r\n{lines}connection: close\r\n\r\n");
    viewer.raw(request.as_bytes())
}

#[test]
fn only_who_knows_the_token() {
    let (viewer, other) = (Running::of(&[]), Running::of(&[]));
    assert_ne!(viewer.root, other.root);
    let host = format!("host: 127.0.0.1:{}", viewer.port);
    let status = |path: &str| ask(&viewer, path, std::slice::from_ref(&host)).status;
    let root = &viewer.root;
    assert_eq!(status(&format!("{root}/")), 200);
    assert_eq!(status(&format!("{root}/api/state")), 200);
    let almost = format!("{}x", &root[..root.len() - 1]);
    for wrong in [
        "",
        &other.root,
        &almost,
        &root[..8],
        "/%00",
        &root.to_uppercase(),
    ] {
        assert_eq!(status(&format!("{wrong}/api/state")), 404, "{wrong}");
    }
    assert_eq!(status("/"), 404);
}

#[test]
fn only_by_its_own_name() {
    let viewer = Running::of(&[]);
    let (port, path) = (viewer.port, format!("{}/api/state", viewer.root));
    let status = |headers: &[String]| ask(&viewer, &path, headers).status;
    let host = |name: &str| format!("host: {name}:{port}");
    assert_eq!(status(&[host("127.0.0.1")]), 200);
    assert_eq!(status(&[host("localhost")]), 200);
    assert_eq!(status(&[host("evil.example")]), 403);
    assert_eq!(status(&[host("127.0.0.1.evil.example")]), 403);
    assert_eq!(status(&["host: 127.0.0.1".into()]), 403);
    assert_eq!(status(&[]), 403);
    let from = |origin: String| status(&[host("127.0.0.1"), format!("origin: {origin}")]);
    assert_eq!(from(format!("http://127.0.0.1:{port}")), 200);
    assert_eq!(from(format!("http://localhost:{port}")), 403);
    assert_eq!(from("http://evil.example".into()), 403);
    assert_eq!(from("null".into()), 403);
}

#[test]
fn every_answer_says_how_it_may_be_used() {
    let viewer = Running::of(&[]);
    let root = &viewer.root;
    let host = format!("host: 127.0.0.1:{}", viewer.port);
    for path in [
        format!("{root}/"),
        format!("{root}/api/state"),
        "/none".into(),
    ] {
        let head = ask(&viewer, &path, std::slice::from_ref(&host)).head;
        for line in [
            "content-security-policy: default-src 'self';",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cache-control: no-store",
        ] {
            assert!(head.contains(line), "{path}: {line}: {head}");
        }
        assert!(!head.contains("access-control"), "{head}");
    }
}

#[test]
fn the_page_is_in_the_program() {
    let viewer = Running::of(&[]);
    let page = viewer.get("");
    let html = String::from_utf8(page.body).unwrap();
    assert!(page.head.contains("text/html"), "{}", page.head);
    for name in ["assets/index.js", "assets/index.css"] {
        assert!(html.contains(name), "{html}");
        assert_eq!(viewer.get(name).status, 200);
    }
    for path in [
        "assets/../index.html",
        "assets/..%2findex.html",
        "assets/none.js",
        "index.html",
    ] {
        assert_eq!(viewer.get(path).status, 404, "{path}");
    }
}
