//! A viewer of one model, and a page that talks to it over a socket.

use karui_viewer::{Viewer, ViewerOptions};
use serde_json::Value;
use std::error::Error;
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use tungstenite::{Message, WebSocket, client};

/// A viewer on a thread of its own.
pub struct Server {
    url: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<karui_viewer::Result<()>>>,
}

impl Server {
    /// Begins to serve.
    pub fn start(model: &str) -> karui_viewer::Result<Self> {
        let viewer = Viewer::open(&[PathBuf::from(model)], &ViewerOptions::default())?;
        let (url, stop) = (viewer.url(), Arc::new(AtomicBool::new(false)));
        let stopped = Arc::clone(&stop);
        let run = move || viewer.run(&|| stopped.load(Ordering::Relaxed));
        let thread = Some(std::thread::spawn(run));
        Ok(Self { url, stop, thread })
    }

    /// Opens a socket; what the server says once it may be asked.
    pub fn open(&self, kind: &str) -> Result<(Page, Value), Box<dyn Error>> {
        let host = self.url.trim_start_matches("http://");
        let at = host.split('/').next().unwrap_or_default();
        let stream = TcpStream::connect(at)?;
        // As browsers have it.
        stream.set_nodelay(true)?;
        let address = format!("ws://{host}api/files/0/live?kind={kind}");
        let (socket, _) = client(address, stream)?;
        let mut page = Page(socket);
        let ready = page.ready()?;
        Ok((page, ready))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ended = self.thread.take().map(JoinHandle::join);
    }
}

/// What a browser's end of the socket does.
pub struct Page(WebSocket<TcpStream>);

impl Page {
    fn ready(&mut self) -> Result<Value, Box<dyn Error>> {
        loop {
            if let Message::Text(text) = self.0.read()? {
                let mut told: Value = serde_json::from_str(&text)?;
                if told.get("progress").is_none() {
                    let ready = told.get_mut("ready").map(Value::take);
                    return Ok(ready.ok_or_else(|| told.to_string())?);
                }
            }
        }
    }

    /// Sends a message and waits for the frame that answers it.
    pub fn answer(&mut self, message: &str) -> Result<Vec<u8>, Box<dyn Error>> {
        self.0.send(Message::text(message))?;
        loop {
            match self.0.read()? {
                Message::Binary(frame) => return Ok(frame.to_vec()),
                Message::Text(text) => return Err(text.to_string().into()),
                Message::Close(_) => return Err("the server has closed the socket".into()),
                Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
            }
        }
    }
}
