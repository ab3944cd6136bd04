//! A router of our own, for the moment in which a client is opened while its hub is absent.
//!
//! A Zenoh client cannot be opened without a router, but it finds one that it has lost. For good, though: all its life it looks for
//! every router that it was opened with. So the stand-in has no port, which somebody else would get after it, but a socket that is
//! nobody's: a client that found another's router behind its own stand-in's port stayed there, and its hub never heard of it.

use crate::session::zenoh_config;
#[cfg(unix)]
use tempfile::TempDir;
use zenoh::session::ZenohId;

/// A router that nobody else reaches. It is gone when closed.
pub struct StandIn {
    zenoh: zenoh::Session,
    endpoint: String,
    /// Of its socket.
    #[cfg(unix)]
    _folder: Option<TempDir>,
}

impl StandIn {
    /// Opens one: with a socket in the folder for temporary files, in `/tmp` where that can't be had (a path of more than 107 bytes, or
    /// nothing may be written), else with a port.
    ///
    /// # Errors
    /// Nor is there a free port.
    pub async fn open() -> zenoh::Result<Self> {
        #[cfg(unix)]
        for folder in [std::env::temp_dir(), "/tmp".into()] {
            match Self::in_folder(&folder).await {
                Ok(stand_in) => return Ok(stand_in),
                Err(why) => tracing::debug!("no stand-in in {}: {why}", folder.display()),
            }
        }
        Self::on_a_port().await
    }

    #[cfg(unix)]
    async fn in_folder(parent: &std::path::Path) -> zenoh::Result<Self> {
        let folder = tempfile::Builder::new().prefix("legwork-").tempdir_in(parent)?;
        let endpoint = format!("unixsock-stream/{}", folder.path().join("stand-in.sock").display());
        let zenoh = zenoh::open(zenoh_config("router", &[&endpoint], &[])?).await?;
        Ok(Self { zenoh, endpoint, _folder: Some(folder) })
    }

    async fn on_a_port() -> zenoh::Result<Self> {
        let zenoh = zenoh::open(zenoh_config("router", &["tcp/127.0.0.1:0"], &[])?).await?;
        let endpoint = zenoh.info().locators().await.into_iter().next().map(|l| l.to_string());
        Ok(Self {
            zenoh,
            endpoint: endpoint.unwrap_or_default(),
            #[cfg(unix)]
            _folder: None,
        })
    }

    /// Where it listens.
    pub fn endpoint(&self) -> &str {
        &self.endpoint
    }

    /// Its name among routers.
    pub fn id(&self) -> ZenohId {
        self.zenoh.zid()
    }

    /// Ends it.
    ///
    /// # Errors
    /// It can't be closed.
    pub async fn close(self) -> zenoh::Result<()> {
        self.zenoh.close().await
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[tokio::test(flavor = "multi_thread")]
    async fn a_stand_in_takes_no_port_and_leaves_nothing() {
        let stand_in = StandIn::open().await.unwrap();
        let socket = stand_in.endpoint().strip_prefix("unixsock-stream/").unwrap().to_owned();
        assert!(std::path::Path::new(&socket).exists());
        stand_in.close().await.unwrap();
        assert!(!std::path::Path::new(&socket).exists());
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn where_no_socket_can_be_made_there_is_a_port() {
        let parent = tempfile::tempdir().unwrap();
        let long = parent.path().join("a".repeat(120));
        std::fs::create_dir(&long).unwrap();
        assert!(StandIn::in_folder(&long).await.is_err());
        assert!(StandIn::in_folder(&parent.path().join("absent")).await.is_err());
        let stand_in = StandIn::on_a_port().await.unwrap();
        assert!(stand_in.endpoint().starts_with("tcp/127.0.0.1:"), "{}", stand_in.endpoint());
        stand_in.close().await.unwrap();
    }
}
