//! What the desktop is asked to do.

use std::path::Path;
use std::process::{Command, Stdio};

/// Opens a file with the program that the desktop has for it.
///
/// # Errors
/// There is none; the sentence says where the file is.
pub fn open(path: &Path) -> Result<(), String> {
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        Command::new("explorer")
    } else {
        Command::new("xdg-open")
    };
    let done = command.arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    match done {
        // the explorer of Windows opens the file and fails all the same
        Ok(status) if status.success() || cfg!(windows) => Ok(()),
        _ => Err(format!("No program opens it here. Open {} in a browser.", path.display())),
    }
}
