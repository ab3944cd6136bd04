//! The file with the key of MAVLink 2 signing: nobody but its owner may read it, and what is in it is never shown. A credential
//! that systemd hands over (`LoadCredential=`) has its own protection, which shows as a group that may read.

use anyhow::{Context, bail};
use autopilot_link::signing::Key;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The variable by which systemd names the folder of a service's credentials.
const CREDENTIALS: &str = "CREDENTIALS_DIRECTORY";
/// A longer file holds no key, bytes.
const LONGEST: u64 = 1024;

/// Reads the key.
///
/// # Errors
/// There is no such file, others may read it, or there is no key in it. What is in it is not told.
pub fn read(path: &Path) -> anyhow::Result<Key> {
    let credentials = std::env::var_os(CREDENTIALS).map(PathBuf::from);
    read_from(path, credentials.as_deref()).with_context(|| format!("--signing-key {}", path.display()))
}

fn read_from(path: &Path, credentials: Option<&Path>) -> anyhow::Result<Key> {
    let file = File::open(path)?;
    check_permissions(&file, path, credentials.is_some_and(|folder| path.starts_with(folder)))?;
    let mut bytes = Vec::new();
    file.take(LONGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LONGEST {
        bail!("it is longer than {LONGEST} bytes, which no key is");
    }
    let Ok(text) = std::str::from_utf8(&bytes) else {
        bail!("it is no text; write the key as 64 hexadecimal digits")
    };
    Ok(Key::read(text)?)
}

#[cfg(unix)]
fn check_permissions(file: &File, path: &Path, is_credential: bool) -> anyhow::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let mode = file.metadata()?.permissions().mode() & 0o777;
    if mode & if is_credential { 0o037 } else { 0o077 } != 0 {
        bail!(
            "others than its owner may read or write it (mode {mode:03o}); do `chmod 600 {}`",
            path.display()
        );
    }
    Ok(())
}

#[cfg(not(unix))]
fn check_permissions(_: &File, _: &Path, _: bool) -> anyhow::Result<()> {
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_key_is_read_only_if_its_owner_alone_may_and_is_never_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("key");
        std::fs::write(&path, "my secret\n").unwrap();
        for (mode, readable) in [(0o600, true), (0o400, true), (0o640, false), (0o604, false), (0o620, false)]
        {
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).unwrap();
            match read(&path) {
                Ok(key) => assert!(readable && key == Key::read("my secret").unwrap(), "{mode:o}"),
                Err(error) => {
                    let told = format!("{error:#}");
                    assert!(!readable && told.contains("chmod 600") && !told.contains("secret"), "{told}");
                }
            }
        }
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
        for bad in [&b""[..], b"\n", &[0xFF; 32], &[b'x'; 2000]] {
            std::fs::write(&path, bad).unwrap();
            assert!(read(&path).is_err(), "{bad:?}");
        }
        assert!(format!("{:#}", read(&folder.path().join("none")).unwrap_err()).contains("none"));
    }
    #[test]
    fn a_credential_of_systemd_may_be_readable_by_its_group_and_no_other_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("signing-key");
        std::fs::write(&path, "my secret\n").unwrap();
        for (mode, credentials, readable) in [
            (0o440, true, true),
            (0o400, true, true),
            (0o460, true, false),
            (0o444, true, false),
            (0o440, false, false),
        ] {
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).unwrap();
            let credentials = credentials.then_some(folder.path());
            assert_eq!(read_from(&path, credentials).is_ok(), readable, "{mode:o}");
        }
    }
}
