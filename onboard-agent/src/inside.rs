//! The vehicle's own way to its hub: a Unix socket that only this user reaches. What happens at the port for everybody
//! else locks no service of the vehicle out.

use anyhow::Context;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A connection to the hub.
#[cfg(unix)]
pub type Stream = tokio::net::UnixStream;
/// A connection to the hub. Without Unix sockets it has a port of its own, which only this machine reaches.
#[cfg(not(unix))]
pub type Stream = tokio::net::TcpStream;

#[cfg(unix)]
const PROTOCOL: &str = "unixsock-stream";
#[cfg(not(unix))]
const PROTOCOL: &str = "tcp";

/// Longer paths are no names of Unix sockets, bytes.
#[cfg(unix)]
const PATH_MAX: usize = 100;
/// Folders for what lives as long as a process, the best first: systemd's for the unit, the one of the user's session.
const RUNTIME_FOLDERS: [&str; 2] = ["RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"];

/// Where the hub listens for the vehicle's own services.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address(PathBuf);

impl Address {
    /// A socket's path; without Unix sockets `host:port`.
    pub fn new(address: impl Into<PathBuf>) -> Self {
        Self(address.into())
    }

    /// As it is given on a command line.
    pub fn as_path(&self) -> &Path {
        &self.0
    }

    /// As a session is told it.
    pub fn endpoint(&self) -> String {
        format!("{PROTOCOL}/{}", self.0.display())
    }

    /// A connection to it.
    ///
    /// # Errors
    /// Nobody listens there.
    pub async fn connect(&self) -> std::io::Result<Stream> {
        #[cfg(unix)]
        return Stream::connect(&self.0).await;
        #[cfg(not(unix))]
        return Stream::connect(self.0.display().to_string()).await;
    }
}

/// A place for the hub to listen, gone when it is dropped.
#[derive(Debug)]
pub struct Inside {
    address: Address,
    _folder: TempDir,
}

impl Inside {
    /// A new one, in a folder that only this user can enter.
    ///
    /// # Errors
    /// No such folder can be made, or its path is too long for a socket.
    pub fn new() -> anyhow::Result<Self> {
        let parent = RUNTIME_FOLDERS.iter().filter_map(std::env::var_os).map(PathBuf::from);
        let parent = parent.into_iter().find(|path| path.is_dir()).unwrap_or_else(std::env::temp_dir);
        let mut named = tempfile::Builder::new();
        named.prefix("legwork-");
        #[cfg(unix)]
        named.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        let folder = named.tempdir_in(&parent);
        let folder =
            folder.with_context(|| format!("a folder for the hub's socket in {}", parent.display()))?;
        Ok(Self { address: address_in(folder.path())?, _folder: folder })
    }

    /// Where it is.
    pub fn address(&self) -> &Address {
        &self.address
    }
}

#[cfg(unix)]
fn address_in(folder: &Path) -> anyhow::Result<Address> {
    let path = folder.join("hub.sock");
    let text =
        path.to_str().context("the path of the hub's socket is no UTF-8: set TMPDIR to another folder")?;
    anyhow::ensure!(
        text.len() <= PATH_MAX && !text.contains(['?', '#', ';']),
        "{text} can't be the hub's socket: set TMPDIR to a folder with a shorter, plain path"
    );
    Ok(Address(path))
}

#[cfg(not(unix))]
fn address_in(_: &Path) -> anyhow::Result<Address> {
    let free = std::net::TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr());
    Ok(Address::new(free.context("a free port for the hub")?.to_string()))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn only_this_user_reaches_the_hubs_socket_and_nothing_is_left_of_it() {
        let inside = Inside::new().unwrap();
        let folder = inside.address().as_path().parent().unwrap().to_owned();
        assert_eq!(folder.metadata().unwrap().permissions().mode() & 0o777, 0o700);
        assert!(inside.address().endpoint().starts_with("unixsock-stream//"), "{inside:?}");
        drop(inside);
        assert!(!folder.exists());
    }

    #[test]
    fn a_path_that_can_be_no_socket_is_refused_with_the_remedy() {
        for folder in ["/tmp/a?b".into(), format!("/tmp/{}", "x".repeat(100))] {
            let refused = address_in(Path::new(&folder)).unwrap_err().to_string();
            assert!(refused.contains("TMPDIR"), "{refused}");
        }
    }
}
