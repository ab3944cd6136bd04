//! Where a command's result goes: a new file, or standard output.

use crate::files::write_whole;
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};

/// Standard input or output on the command line.
pub const DASH: &str = "-";

/// Where a result goes.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Output {
    /// Overwrite an existing file.
    #[arg(long)]
    pub force: bool,
}

impl Output {
    /// Writes a whole file, or to standard output (`-`).
    ///
    /// # Errors
    /// The file exists and `--force` was not given, or it can't be written.
    pub fn write(&self, to: &Path, bytes: &[u8]) -> anyhow::Result<()> {
        if to.as_os_str() == DASH {
            return Ok(stdio::bytes(bytes)?);
        }
        self.allow(to)?;
        write_whole(to, bytes).map(drop).with_context(|| format!("can't write {}", to.display()))
    }

    /// Refuses to overwrite.
    ///
    /// # Errors
    /// The file exists and `--force` was not given.
    pub fn allow(&self, to: &Path) -> anyhow::Result<()> {
        // writing to a device or a pipe overwrites nothing; a dangling link counts as a file
        let is_kept = |is: std::fs::Metadata| is.is_file() || is.is_dir() || is.is_symlink();
        let there = to.metadata().or_else(|_| to.symlink_metadata());
        if !self.force && there.is_ok_and(is_kept) {
            bail!("{} is there already: choose another name, or give --force to overwrite it", to.display());
        }
        Ok(())
    }
}

/// The file named, else standard output.
pub fn or_stdout(file: Option<&PathBuf>) -> PathBuf {
    file.cloned().unwrap_or_else(|| DASH.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_overwritten_without_force() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("plan.xml");
        Output::default().write(&file, b"one").unwrap();
        let error = Output::default().write(&file, b"two").unwrap_err();
        assert!(error.to_string().contains("--force"), "{error}");
        assert_eq!(std::fs::read(&file).unwrap(), b"one");
        Output { force: true }.write(&file, b"two").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"two");
        #[cfg(unix)]
        {
            let (link, lost) = (folder.path().join("link.xml"), folder.path().join("lost.xml"));
            std::os::unix::fs::symlink(&file, &link).unwrap();
            std::os::unix::fs::symlink("nowhere", &lost).unwrap();
            assert!(Output::default().write(&link, b"three").is_err());
            assert!(Output::default().write(&lost, b"three").is_err());
            Output { force: true }.write(&link, b"three").unwrap();
            assert_eq!(std::fs::read(&file).unwrap(), b"three", "what the link leads to is written");
            assert!(link.is_symlink());
            Output::default().write(Path::new("/dev/null"), b"three").unwrap();
            assert!(!Path::new("/dev/null").is_file());
        }
        let nowhere = folder.path().join("missing").join("plan.xml");
        assert!(Output::default().write(&nowhere, b"x").is_err());
    }
}
