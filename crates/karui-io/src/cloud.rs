//! Blocks in the object stores of clouds.

use karui::outofcore::{Error, Result, Store};
use object_store::{
    GetOptions, ListResult, ObjectStore, ObjectStoreExt as _, aws, azure, client::ClientConfigKey,
    gcp, path::Path,
};
use std::{fmt, future::Future, io, ops::Range, path::PathBuf, sync::Arc, sync::mpsc};
use tokio::runtime::{Builder, Runtime};

/// How long a request may take if the environment does not say: a block can be a hundred
/// megabytes, more than fits the usual half minute on a slow line.
const TIMEOUT: &str = "10 minutes";

/// A prefix of a bucket as a store: `s3://BUCKET/PREFIX`, `gs://BUCKET/PREFIX` or
/// `az://CONTAINER/PREFIX`.
///
/// Who asks, and where, is said by the environment (`AWS_*`, `GOOGLE_*`, `AZURE_*`), as for the
/// crate `object_store`; requests that fail for a while are repeated as it does by default.
/// An object is put by one request, so it is there as a whole or not at all; one that is there
/// already is put over, which is how a damaged block is made anew. Two that put the same at the
/// same time put the same bytes. Names may have folders in them, which [`Store::list`] passes over.
///
/// The connections live on a thread of their own, so that this may be used from any other,
/// those of an asynchronous program included, which it blocks.
pub struct Cloud {
    bucket: Arc<dyn ObjectStore>,
    prefix: Path,
    url: String,
    /// Taken away when dropped.
    runtime: Option<Runtime>,
}

impl fmt::Debug for Cloud {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Cloud").field(&self.url).finish()
    }
}

impl Cloud {
    /// Whether a name is that of a place in a cloud.
    #[must_use]
    pub fn is_url(name: &str) -> bool {
        parts(name).is_some()
    }

    /// Opens a place. Nothing is asked of the network yet.
    ///
    /// # Errors
    /// [`Error::Store`] if the URL or the environment make no sense, or the URL names all of a
    /// bucket: a store is swept and cleared as a whole.
    pub fn open(url: &str) -> Result<Self> {
        let url = url.trim_end_matches('/');
        let invalid = |problem: &str| {
            let cause = io::Error::new(io::ErrorKind::InvalidInput, problem.to_owned());
            failed(url, cause)
        };
        let Some((scheme, bucket, prefix)) = parts(url) else {
            return Err(invalid("a URL is s3://, gs:// or az://BUCKET/PREFIX"));
        };
        if bucket.is_empty() || prefix.is_empty() {
            return Err(invalid("a bucket and a prefix are needed"));
        }
        // Another part of the program may have chosen one, which does as well.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let bucket = opened(scheme, url).map_err(|e| failed(url, told(e)))?;
        let prefix = Path::from_url_path(prefix).map_err(|e| failed(url, told(e.into())))?;
        Self::over(bucket, prefix, url)
    }

    /// A prefix of any store.
    fn over(bucket: Arc<dyn ObjectStore>, prefix: Path, url: &str) -> Result<Self> {
        let mut runtime = Builder::new_multi_thread();
        let runtime = runtime.worker_threads(1).enable_all().build();
        Ok(Self {
            bucket,
            prefix,
            url: url.to_owned(),
            runtime: Some(runtime.map_err(|e| failed(url, e))?),
        })
    }

    /// A prefix of a store that tests keep.
    #[cfg(test)]
    pub(crate) fn in_memory(bucket: Arc<dyn ObjectStore>, prefix: &str) -> Self {
        let url = format!("s3://bucket/{prefix}");
        Self::over(bucket, Path::from(prefix), &url).expect("opened")
    }

    /// The URL, without a slash at its end.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Does a request on the thread of the connections.
    fn wait<T, F>(&self, request: F) -> object_store::Result<T>
    where
        T: Send + 'static,
        F: Future<Output = object_store::Result<T>> + Send + 'static,
    {
        let (sender, receiver) = mpsc::channel();
        let answer = async move {
            // Nobody has gone away: the other end waits below.
            let _ = sender.send(request.await);
        };
        if let Some(runtime) = &self.runtime {
            runtime.spawn(answer);
        }
        receiver.recv().unwrap_or_else(|gone| {
            Err(object_store::Error::Generic {
                store: "cloud",
                source: Box::new(gone),
            })
        })
    }

    /// Names of all objects, those with folders in their names as well, in order.
    ///
    /// # Errors
    /// [`Error::Store`].
    pub fn list_below(&self) -> Result<Vec<String>> {
        let (mut names, mut folders) = (Vec::new(), vec![self.prefix.clone()]);
        while let Some(folder) = folders.pop() {
            let found = self.listed(folder)?;
            folders.extend(found.common_prefixes);
            let below = |at: &Path| {
                let parts = at.prefix_match(&self.prefix)?;
                let parts: Vec<_> = parts.map(|part| part.as_ref().to_owned()).collect();
                Some(parts.join("/"))
            };
            names.extend(found.objects.iter().filter_map(|o| below(&o.location)));
        }
        names.sort_unstable();
        Ok(names)
    }

    /// What is in one folder.
    fn listed(&self, folder: Path) -> Result<ListResult> {
        let bucket = Arc::clone(&self.bucket);
        let found = self.wait(async move { bucket.list_with_delimiter(Some(&folder)).await });
        found.map_err(|e| self.failed("", e))
    }

    fn object(&self, name: &str) -> (Arc<dyn ObjectStore>, Path) {
        let parts = name.split('/');
        let at = parts.fold(self.prefix.clone(), |at, part| at.join(part));
        (Arc::clone(&self.bucket), at)
    }

    fn size(&self, name: &str) -> object_store::Result<u64> {
        let (bucket, at) = self.object(name);
        let meta = self.wait(async move { bucket.head(&at).await })?;
        Ok(meta.size)
    }

    fn error(&self, name: &str, error: object_store::Error) -> Error {
        match error {
            object_store::Error::NotFound { .. } => Error::Missing { name: name.into() },
            other => self.failed(name, other),
        }
    }

    fn failed(&self, name: &str, error: object_store::Error) -> Error {
        failed(&format!("{}/{name}", self.url), told(error))
    }
}

impl Drop for Cloud {
    fn drop(&mut self) {
        // Plainly dropped, it would panic on a thread of an asynchronous program.
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

impl Store for Cloud {
    fn get(&self, name: &str) -> Result<Vec<u8>> {
        let (bucket, at) = self.object(name);
        let bytes = self.wait(async move { bucket.get(&at).await?.bytes().await });
        bytes.map(Vec::from).map_err(|e| self.error(name, e))
    }

    fn get_range(&self, name: &str, range: Range<u64>) -> Result<Vec<u8>> {
        let expected = range.end.saturating_sub(range.start);
        let (bucket, at) = self.object(name);
        let wanted = range.clone();
        let options = GetOptions::new().with_range(Some(wanted));
        let read = match expected {
            // There is no such request.
            0 => self.size(name).map(|_| Vec::new()),
            _ => self
                .wait(async move { bucket.get_opts(&at, options).await?.bytes().await })
                .map(Vec::from),
        };
        match read {
            Ok(bytes) if bytes.len() as u64 == expected => Ok(bytes),
            Err(error @ object_store::Error::NotFound { .. }) => Err(self.error(name, error)),
            // Stores differ in what they say of a range that goes past the end.
            read => match (self.size(name), read) {
                (Ok(size), Err(error)) if size >= range.end => Err(self.error(name, error)),
                (Err(error), _) => Err(self.error(name, error)),
                _ => Err(Error::Damaged {
                    name: name.into(),
                    problem: "it ends early",
                }),
            },
        }
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let (bucket, at) = self.object(name);
        let bytes = bytes.to_vec();
        let put = self.wait(async move { bucket.put(&at, bytes.into()).await });
        put.map(drop).map_err(|e| self.failed(name, e))
    }

    fn exists(&self, name: &str) -> Result<bool> {
        match self.size(name) {
            Ok(_) => Ok(true),
            Err(object_store::Error::NotFound { .. }) => Ok(false),
            Err(error) => Err(self.failed(name, error)),
        }
    }

    fn list(&self) -> Result<Vec<String>> {
        let found = self.listed(self.prefix.clone())?;
        let names = found.objects.iter().filter_map(|o| o.location.filename());
        let mut names: Vec<String> = names.map(str::to_owned).collect();
        names.sort_unstable();
        Ok(names)
    }

    fn remove(&self, name: &str) -> Result<()> {
        let (bucket, at) = self.object(name);
        match self.wait(async move { bucket.delete(&at).await }) {
            Ok(()) | Err(object_store::Error::NotFound { .. }) => Ok(()),
            Err(error) => Err(self.failed(name, error)),
        }
    }
}

/// A kind of cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scheme {
    S3,
    Google,
    Azure,
}

/// Scheme, bucket and prefix of a URL.
fn parts(url: &str) -> Option<(Scheme, &str, &str)> {
    let (scheme, rest) = url.split_once("://")?;
    let scheme = match scheme {
        "s3" => Scheme::S3,
        "gs" => Scheme::Google,
        "az" => Scheme::Azure,
        _ => return None,
    };
    let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
    Some((scheme, bucket, prefix.trim_matches('/')))
}

/// The bucket of a URL, as the environment says; what it does not say, by default.
fn opened(scheme: Scheme, url: &str) -> object_store::Result<Arc<dyn ObjectStore>> {
    let says = |variable: &str| std::env::var_os(variable).is_some();
    Ok(match scheme {
        Scheme::S3 => {
            let mut builder = aws::AmazonS3Builder::from_env().with_url(url);
            if !says("AWS_TIMEOUT") {
                let key = aws::AmazonS3ConfigKey::Client(ClientConfigKey::Timeout);
                builder = builder.with_config(key, TIMEOUT);
            }
            Arc::new(builder.build()?)
        }
        Scheme::Google => {
            let mut builder = gcp::GoogleCloudStorageBuilder::from_env().with_url(url);
            if !says("GOOGLE_TIMEOUT") {
                let key = gcp::GoogleConfigKey::Client(ClientConfigKey::Timeout);
                builder = builder.with_config(key, TIMEOUT);
            }
            Arc::new(builder.build()?)
        }
        Scheme::Azure => {
            let mut builder = azure::MicrosoftAzureBuilder::from_env().with_url(url);
            if !says("AZURE_TIMEOUT") {
                let key = azure::AzureConfigKey::Client(ClientConfigKey::Timeout);
                builder = builder.with_config(key, TIMEOUT);
            }
            Arc::new(builder.build()?)
        }
    })
}

fn failed(url: &str, cause: io::Error) -> Error {
    Error::Store {
        path: PathBuf::from(url),
        cause,
    }
}

/// The error in the words of the system, so far as it has such.
fn told(error: object_store::Error) -> io::Error {
    use object_store::Error as Cloudy;
    let kind = match &error {
        Cloudy::NotFound { .. } => io::ErrorKind::NotFound,
        Cloudy::PermissionDenied { .. } | Cloudy::Unauthenticated { .. } => {
            io::ErrorKind::PermissionDenied
        }
        Cloudy::InvalidPath { .. } | Cloudy::UnknownConfigurationKey { .. } => {
            io::ErrorKind::InvalidInput
        }
        Cloudy::Generic { .. } => answered(&error.to_string()),
        _ => io::ErrorKind::Other,
    };
    io::Error::new(kind, error)
}

/// What a server has answered to a list, which the crate keeps in the words of HTTP only. A list
/// of what there is not is empty, so that only a bucket can be missing.
fn answered(said: &str) -> io::ErrorKind {
    let kinds = [
        ("404 Not Found", io::ErrorKind::NotFound),
        ("403 Forbidden", io::ErrorKind::PermissionDenied),
        ("401 Unauthorized", io::ErrorKind::PermissionDenied),
    ];
    let found = kinds.iter().find(|(status, _)| said.contains(status));
    found.map_or(io::ErrorKind::Other, |(_, kind)| *kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use object_store::memory::InMemory;

    fn cloud() -> Cloud {
        let bucket: Arc<dyn ObjectStore> = Arc::new(InMemory::new());
        Cloud::in_memory(bucket, "some/where")
    }

    #[test]
    fn objects_are_put_read_listed_and_taken_away() {
        let cloud = cloud();
        assert!(!cloud.exists("a.block").expect("asked"));
        for (name, bytes) in [("b.block", b"12345".as_slice()), ("a.block", b"")] {
            cloud.put(name, b"before").expect("put");
            cloud.put(name, bytes).expect("put over");
            assert_eq!(cloud.get(name).expect("read"), bytes);
            assert!(cloud.exists(name).expect("asked"));
        }
        assert_eq!(cloud.get_range("b.block", 1..3).expect("read"), b"23");
        assert_eq!(cloud.get_range("b.block", 2..2).expect("read"), b"");
        assert_eq!(cloud.list().expect("listed"), ["a.block", "b.block"]);
        for _ in 0..2 {
            cloud.remove("b.block").expect("removed");
        }
        assert_eq!(cloud.list().expect("listed"), ["a.block"]);
    }

    #[test]
    fn what_is_not_there_and_what_ends_early_are_told_apart() {
        let cloud = cloud();
        cloud.put("short", b"12345").expect("put");
        for range in [0..6, 3..9, 5..6, 7..9] {
            let error = cloud.get_range("short", range).expect_err("short");
            assert!(matches!(error, Error::Damaged { .. }), "{error}");
            assert_eq!(error.lost(), Some("short"));
        }
        let gone = [
            cloud.get("gone").map(drop),
            cloud.get_range("gone", 0..1).map(drop),
            cloud.get_range("gone", 1..1).map(drop),
        ];
        for error in gone {
            let error = error.expect_err("gone");
            assert!(
                matches!(&error, Error::Missing { name } if name == "gone"),
                "{error}"
            );
        }
    }

    #[test]
    fn several_threads_may_ask_at_once() {
        let cloud = cloud();
        std::thread::scope(|scope| {
            for i in 0..8u8 {
                let cloud = &cloud;
                scope.spawn(move || {
                    let name = format!("{i}");
                    cloud.put(&name, &[i; 1000]).expect("put");
                    assert_eq!(cloud.get(&name).expect("read"), [i; 1000]);
                });
            }
        });
        assert_eq!(cloud.list().expect("listed").len(), 8);
    }

    #[test]
    fn it_works_from_within_an_asynchronous_program() {
        let outer = Builder::new_current_thread().build().expect("runtime");
        outer.block_on(async {
            let cloud = cloud();
            cloud.put("a", b"b").expect("put");
            assert_eq!(cloud.get("a").expect("read"), b"b");
        });
    }

    #[test]
    fn what_a_server_answers_to_a_list_is_told_by_kind() {
        let kind = |said: &str| {
            let source = said.to_owned().into();
            told(object_store::Error::Generic {
                store: "S3",
                source,
            })
            .kind()
        };
        let status = |status: &str| kind(&format!("non-2xx status code: {status}: <Error/>"));
        assert_eq!(status("404 Not Found"), io::ErrorKind::NotFound);
        assert_eq!(status("403 Forbidden"), io::ErrorKind::PermissionDenied);
        assert_eq!(status("500 Internal"), io::ErrorKind::Other);
    }

    #[test]
    fn urls_that_make_no_sense_are_refused_with_the_url() {
        assert!(!Cloud::is_url("folder/s3") && !Cloud::is_url("C:\\s3"));
        for url in [
            "s3://",
            "s3://bucket",
            "s3://bucket/",
            "gs:///a",
            "http://a/b",
            "x",
        ] {
            let error = Cloud::open(url).expect_err("refused").to_string();
            assert!(error.contains(url.trim_end_matches('/')), "{error}");
        }
        let cloud = Cloud::open("s3://bucket/some/where/").expect("opened");
        assert_eq!(cloud.url(), "s3://bucket/some/where");
    }

    #[test]
    fn a_server_that_is_not_there_is_told_with_url_and_name() {
        let bucket = aws::AmazonS3Builder::new()
            .with_bucket_name("bucket")
            .with_endpoint("http://127.0.0.1:9")
            .with_allow_http(true)
            .with_access_key_id("a")
            .with_secret_access_key("b")
            .with_retry(object_store::RetryConfig {
                max_retries: 0,
                ..object_store::RetryConfig::default()
            });
        let _ = rustls::crypto::ring::default_provider().install_default();
        let bucket = Arc::new(bucket.build().expect("built"));
        let cloud = Cloud::over(bucket, Path::from("p"), "s3://bucket/p").expect("opened");
        for error in [
            cloud.put("a", b"b").expect_err("put"),
            cloud.get("a").expect_err("read"),
            cloud.exists("a").map(drop).expect_err("asked"),
            cloud.remove("a").expect_err("removed"),
        ] {
            assert!(matches!(&error, Error::Store { .. }), "{error:?}");
            assert!(
                error.to_string().starts_with("s3://bucket/p/a: "),
                "{error}"
            );
        }
    }
}
