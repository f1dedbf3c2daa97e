//! Live refinement over a real socket: the library's cut arrives, the latest camera wins,
//! nonsense is answered, strangers are not.

#[allow(dead_code, reason = "each test file uses a part of it")]
mod replay;

use karui::Scene;
use karui::geom::Camera;
use karui::hierarchy::{Budget, Hierarchy, HierarchyOptions, ViewAndLight};
use karui::mesh::shapes;
use karui_viewer::{Viewer, ViewerOptions};
use replay::{Page, word};
use serde_json::{Value, json};
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Error, Message, WebSocket, client};

/// A viewer of one ball, on a thread of its own.
struct Server {
    folder: TempDir,
    url: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let ball = folder.path().join("ball.ply");
        karui_io::write(&ball, &Scene::from_mesh(shapes::icosphere(5))).expect("writes");
        let cage = folder.path().join("cage.obj");
        std::fs::write(&cage, CAGE).expect("writes");
        let options = ViewerOptions::default();
        let viewer = Viewer::open(&[ball, cage], &options).expect("opens");
        let (url, stop) = (viewer.url(), Arc::new(AtomicBool::new(false)));
        let stopped = Arc::clone(&stop);
        let run = move || {
            viewer
                .run(&|| stopped.load(Ordering::Relaxed))
                .expect("runs")
        };
        let thread = Some(std::thread::spawn(run));
        Self {
            folder,
            url,
            stop,
            thread,
        }
    }

    fn ball(&self) -> PathBuf {
        self.folder.path().join("ball.ply")
    }

    fn open(&self, address: &str, origin: Option<&str>) -> Result<Socket, Error> {
        let host = self.url.trim_start_matches("http://");
        let at = host.split('/').next().expect("a host");
        let mut request = format!("ws://{host}api/{address}").into_client_request()?;
        if let Some(origin) = origin {
            let origin = origin.parse().expect("a header");
            request.headers_mut().insert("Origin", origin);
        }
        let stream = TcpStream::connect(at).expect("connects");
        let wait = Some(Duration::from_secs(60));
        stream.set_read_timeout(wait).expect("a socket");
        let opened = client(request, stream).map_err(|e| match e {
            tungstenite::HandshakeError::Failure(error) => error,
            tungstenite::HandshakeError::Interrupted(_) => Error::ConnectionClosed,
        });
        opened.map(|(socket, _)| Socket(socket))
    }

    fn end(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().expect("ends well");
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end();
    }
}

const CAGE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

struct Socket(WebSocket<TcpStream>);

impl Socket {
    fn send(&mut self, text: &str) {
        self.0.send(Message::text(text)).expect("sends");
    }

    /// The next frame, or text that is not about progress.
    fn next(&mut self) -> Result<Vec<u8>, Value> {
        loop {
            match self.0.read().expect("a message") {
                Message::Binary(bytes) => return Ok(bytes.to_vec()),
                Message::Text(text) => {
                    let value: Value = serde_json::from_str(&text).expect("JSON");
                    if value.get("progress").is_none() {
                        return Err(value);
                    }
                }
                other => panic!("{other:?}"),
            }
        }
    }

    fn ready(&mut self) -> Value {
        let told = self.next().expect_err("text");
        told.get("ready").expect("ready").clone()
    }

    fn error(&mut self) -> String {
        let told = self.next().expect_err("text");
        told["error"].as_str().expect("an error").to_owned()
    }
}

fn eye(i: u32) -> [f32; 3] {
    [
        3.0 * (0.2 * i as f32).sin(),
        0.3,
        3.0 * (0.2 * i as f32).cos(),
    ]
}

fn message(i: u32) -> String {
    json!({
        "seq": i, "size": [400, 300],
        "frame": { "camera": { "eye": eye(i), "target": [0, 0, 0], "fov": 40 }, "lights": [] },
    })
    .to_string()
}

#[test]
fn the_latest_camera_wins_and_is_the_librarys_cut() {
    let server = Server::start();
    let mut socket = server
        .open("files/0/live?kind=half-edge", None)
        .expect("opens");
    let about = socket.ready();
    let scene = karui_io::read(server.ball()).expect("reads");
    let mesh = scene.into_single_mesh().expect("a mesh");
    assert_eq!(about["triangles"], mesh.triangles.len());
    for i in 1..=60 {
        socket.send(&message(i));
    }
    let mut page = Page::default();
    let mut answers = 0;
    loop {
        let frame = socket.next().expect("a frame");
        page.apply(&frame);
        answers += 1;
        if word(&frame, 2) == 60 {
            break;
        }
    }
    assert!(answers <= 60);
    let options = HierarchyOptions {
        alpha: f64::INFINITY,
        ..HierarchyOptions::default()
    };
    let hierarchy = Hierarchy::build(&mesh, &options).expect("builds");
    let mut cut = hierarchy.finest();
    let camera = Camera {
        eye: eye(60).into(),
        target: [0.0; 3].into(),
        projection: karui::geom::Projection::Perspective {
            fov_y: 40f32.to_radians(),
        },
        ..ViewAndLight::default().camera
    };
    let criteria = ViewAndLight {
        camera,
        size: [400, 300],
        ..ViewAndLight::default()
    };
    cut.refine(&criteria, Budget::UNLIMITED).expect("refines");
    let place = |v: u32| mesh.positions[v as usize].to_array().map(f32::to_bits);
    let mut expected: Vec<_> = cut.indices().iter().map(|t| t.map(place)).collect();
    expected.sort_unstable();
    assert!(page.triangles() == expected);
}

#[test]
fn nonsense_is_answered_and_two_pages_do_not_mind() {
    let server = Server::start();
    let mut first = server
        .open("files/0/live?kind=clusters", None)
        .expect("opens");
    let mut second = server
        .open("files/0/live?kind=clusters", None)
        .expect("opens");
    assert_eq!(first.ready()["kind"], "clusters");
    assert!(second.ready()["slot"].as_u64().is_some_and(|s| s > 0));
    let mut page = Page::default();
    second.send(&message(1));
    page.apply(&second.next().expect("a frame"));
    first.send("{]");
    assert!(first.error().contains("not a message"));
    first
        .0
        .send(Message::binary(vec![0u8; 100]))
        .expect("sends");
    assert!(first.error().contains("not a message"));
    first.send(&message(5));
    assert!(first.next().is_ok());
    first.send(&message(5));
    assert!(first.error().contains("not newer"));
    // More than any message is: the socket closes, and only this one.
    let _gone = first.0.send(Message::text(" ".repeat(100_000)));
    assert!((0..10).any(|_| first.0.read().is_err()));
    second.send(&message(2));
    page.apply(&second.next().expect("a frame"));
}

#[test]
fn control_meshes_become_smooth() {
    let server = Server::start();
    let mut socket = server.open("files/1/adaptive", None).expect("opens");
    let about = socket.ready();
    assert_eq!(
        (&about["faces"], &about["vertices"]),
        (&json!(6), &json!(8))
    );
    assert_eq!(about["cage"]["edges"].as_array().map(Vec::len), Some(24));
    let mut page = Page::default();
    socket.send(&message(1));
    page.apply(&socket.next().expect("a frame"));
    assert!(page.triangles().len() > 100);
}

#[test]
fn strangers_are_turned_away() {
    let server = Server::start();
    let refused = |address: &str, origin: Option<&str>| match server.open(address, origin) {
        Err(Error::Http(response)) => response.status().as_u16(),
        other => panic!("{:?}", other.map(|_| "opened")),
    };
    assert_eq!(
        refused("files/0/live?kind=half-edge", Some("http://evil.example")),
        403
    );
    assert_eq!(refused("files/9/live?kind=half-edge", None), 404);
    assert_eq!(refused("files/9/adaptive", None), 404);
    assert_eq!(refused("files/0/live?kind=other", None), 400);
    let own = server.url.trim_end_matches('/');
    let own = own.rsplit_once('/').expect("a token").0;
    assert!(
        server
            .open("files/0/live?kind=half-edge", Some(own))
            .is_ok()
    );
}

#[test]
fn too_many_pages_are_told_so() {
    let server = Server::start();
    let open = || server.open("files/0/live?kind=clusters", None);
    let mut all: Vec<Socket> = (0..16).map(|_| open().expect("opens")).collect();
    all.iter_mut().for_each(|s| drop(s.ready()));
    let mut refused = open().expect("opens, to be told");
    let told = refused.next().expect_err("text");
    assert_eq!(told["fatal"], true);
    assert!(told["error"].as_str().expect("why").contains("16 pages"));
    match refused.0.read() {
        Ok(Message::Close(Some(last))) => assert_eq!(u16::from(last.code), 1013),
        other => panic!("{other:?}"),
    }
    drop(all);
    let end = Instant::now() + Duration::from_secs(20);
    let is_open = || {
        let told = open().expect("opens").next().expect_err("text");
        told.get("ready").is_some()
    };
    while !is_open() {
        assert!(Instant::now() < end, "places become free again");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_server_that_ends_lets_go() {
    let mut server = Server::start();
    let mut socket = server
        .open("files/0/live?kind=half-edge", None)
        .expect("opens");
    socket.ready();
    let started = Instant::now();
    server.end();
    assert!(started.elapsed() < Duration::from_secs(5));
    assert!((0..10).any(|_| socket.0.read().is_err()));
}
