//! A viewer from its start to its end.

use crate::api::router;
use crate::error::{Error, Result};
use crate::file::{Content, File};
use crate::shared::Shared;
use axum::serve::ListenerExt as _;
use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Time between two looks at whether to stop.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Time that work has to end once the viewer does.
const LAST_WORK: Duration = Duration::from_secs(1);

/// How to open a viewer.
#[derive(Debug, Clone)]
pub struct ViewerOptions {
    /// Port on 127.0.0.1; 0, the default, takes any that is free.
    pub port: u16,
    /// Largest file that may be dropped on the page, bytes; 512 MiB by default.
    pub upload_bytes: usize,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            port: 0,
            upload_bytes: 512 << 20,
        }
    }
}

/// A server that listens but does not answer yet.
#[derive(Debug)]
pub struct Viewer {
    listener: TcpListener,
    shared: Arc<Shared>,
}

impl Viewer {
    /// Reads the files (models, or tilesets if their names end in `.json`) and takes a port.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::NoTriangles`], [`Error::Model`], [`Error::Folder`] and
    /// [`Error::TooManyFiles`] for files; [`Error::Listen`] if the port is taken;
    /// [`Error::Random`].
    pub fn open(files: &[PathBuf], options: &ViewerOptions) -> Result<Self> {
        let files: Vec<File> = files.iter().map(|f| File::open(f)).collect::<Result<_>>()?;
        let port = options.port;
        let listen = |error| Error::Listen { port, error };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(listen)?;
        listener.set_nonblocking(true).map_err(listen)?;
        let port = listener.local_addr().map_err(listen)?.port();
        let shared = Arc::new(Shared::new(files, port, options.upload_bytes)?);
        Ok(Self { listener, shared })
    }

    /// The address of the page.
    #[must_use]
    pub fn url(&self) -> String {
        let Shared { port, token, .. } = &*self.shared;
        format!("http://127.0.0.1:{port}/{token}/")
    }

    /// What the readers of the files passed over, by the file's name.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for file in self.shared.files() {
            if let Content::Model(model) = &file.content {
                let name = &file.name;
                warnings.extend(model.warnings.iter().map(|w| format!("{name}: {w}")));
            }
        }
        warnings
    }

    /// Answers until `stopped`, which is asked every 50 ms, says so. Work that is not done
    /// by then is cancelled.
    ///
    /// # Errors
    /// [`Error::Serve`] if the operating system does not let it go on.
    pub fn run(self, stopped: &(dyn Fn() -> bool + Sync)) -> Result<()> {
        let Self { listener, shared } = self;
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .build()?;
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            // A frame that waits for more to send with it comes late; without it, it comes.
            let listener = listener.tap_io(|io| drop(io.set_nodelay(true)));
            let server = axum::serve(listener, router(Arc::clone(&shared)));
            tokio::select! {
                ended = server.into_future() => ended,
                () = until(stopped) => Ok(()),
            }
        });
        shared.jobs.cancel_all();
        runtime.shutdown_timeout(LAST_WORK);
        Ok(served?)
    }
}

async fn until(stopped: &(dyn Fn() -> bool + Sync)) {
    while !stopped() {
        tokio::time::sleep(LOOK_EVERY).await;
    }
}
