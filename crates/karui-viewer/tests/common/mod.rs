//! A viewer that runs while a test does, and a client that says whatever it is told to.

use karui_viewer::{Viewer, ViewerOptions};
use serde_json::Value;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A viewer on a thread of its own.
pub struct Running {
    /// Port it listens on.
    pub port: u16,
    /// `/TOKEN`.
    pub root: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<karui_viewer::Result<()>>>,
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    /// Status.
    pub status: u16,
    /// Status line and headers, in lower case.
    pub head: String,
    /// Body.
    pub body: Vec<u8>,
}

impl Answer {
    /// The body as JSON.
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }

    /// What the error says.
    pub fn error(&self) -> String {
        self.json()["error"].as_str().expect("an error").to_owned()
    }
}

impl Running {
    /// Begins to serve.
    pub fn of(files: &[PathBuf]) -> Self {
        Self::with(files, &ViewerOptions::default())
    }

    /// The same with options.
    pub fn with(files: &[PathBuf], options: &ViewerOptions) -> Self {
        let viewer = Viewer::open(files, options).expect("a viewer");
        let url = viewer.url();
        let rest = url
            .strip_prefix("http://127.0.0.1:")
            .expect("on this machine");
        let (port, token) = rest.split_once('/').expect("a token");
        let (port, root) = (
            port.parse().unwrap(),
            format!("/{}", token.trim_end_matches('/')),
        );
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        let serve = move || viewer.run(&|| asked.load(Ordering::SeqCst));
        let thread = Some(std::thread::spawn(serve));
        Self {
            port,
            root,
            stop,
            thread,
        }
    }

    /// Sends a request as it is written and reads to the end.
    pub fn raw(&self, request: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a server");
        stream
            .set_read_timeout(Some(Duration::from_secs(120)))
            .unwrap();
        // A server that refuses may close before all is sent.
        let _ = stream.write_all(request);
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        let end = bytes
            .windows(4)
            .position(|w| w == b"\r\n\r\n")
            .expect("headers");
        let head = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
        let status = head
            .split(' ')
            .nth(1)
            .and_then(|s| s.parse().ok())
            .expect("a status");
        let body = bytes[end + 4..].to_vec();
        Answer { status, head, body }
    }

    /// A request to `path` below the token.
    pub fn send(&self, method: &str, path: &str, body: &[u8]) -> Answer {
        let head = self.head(method, path, body.len());
        self.raw(&[head.as_bytes(), body].concat())
    }

    /// Sends a request without a body, whose answer nobody has waited for yet.
    pub fn begin(&self, method: &str, path: &str) -> TcpStream {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a server");
        let head = self.head(method, path, 0);
        stream.write_all(head.as_bytes()).expect("sends");
        stream
    }

    fn head(&self, method: &str, path: &str, length: usize) -> String {
        let (root, port) = (&self.root, self.port);
        format!(
            "{method} {root}/{path} HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\nconnection: close\r\n\
             content-type: application/json\r\ncontent-length: {length}\r\n\r\n"
        )
    }

    /// `GET`.
    pub fn get(&self, path: &str) -> Answer {
        self.send("GET", path, &[])
    }

    /// Waits for a job to end and tells how it did.
    pub fn ended(&self, job: u64) -> Value {
        let begun = Instant::now();
        loop {
            let report = self.get(&format!("api/jobs/{job}")).json();
            if report["state"] != "running" {
                return report;
            }
            assert!(begun.elapsed() < Duration::from_secs(120), "{report}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let ended = thread.join();
            assert!(
                matches!(ended, Ok(Ok(()))) || std::thread::panicking(),
                "{ended:?}"
            );
        }
    }
}
