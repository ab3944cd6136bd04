//! What the programs of a test log: kept aside, and shown when the test fails.

use std::{
    fmt::Write,
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
    process::Stdio,
};

/// How much of the end of each log is shown.
const SHOWN_BYTES: u64 = 6000;

/// A folder with a log of each program. If the test fails it is kept, and the end of each log printed.
pub struct Logs {
    folder: tempfile::TempDir,
}

impl Logs {
    /// None yet.
    ///
    /// # Errors
    /// There is no room for temporary files.
    pub fn new() -> io::Result<Self> {
        Ok(Self { folder: tempfile::Builder::new().prefix("legwork-test-logs-").tempdir()? })
    }

    /// Where the standard error of a program goes. One that is started again goes on in the same log.
    ///
    /// # Errors
    /// The log can't be opened.
    pub fn of(&self, program: &str) -> io::Result<Stdio> {
        let path = self.folder.path().join(program);
        Ok(File::options().create(true).append(true).open(path)?.into())
    }

    /// The end of each log, for a failure's message.
    pub fn ends(&self) -> String {
        let entries = std::fs::read_dir(self.folder.path()).into_iter().flatten().flatten();
        let mut logs: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        logs.sort();
        logs.iter().fold(String::new(), |mut text, log| {
            let end = end_of(log).unwrap_or_else(|e| e.to_string());
            // writing to a String can't fail
            let _ = writeln!(text, "--- end of {}\n{end}", log.display());
            text
        })
    }
}

impl Drop for Logs {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.folder.disable_cleanup(true);
            eprintln!("{}", self.ends());
        }
    }
}

fn end_of(log: &Path) -> io::Result<String> {
    let mut file = File::open(log)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(SHOWN_BYTES)))?;
    let mut end = Vec::new();
    file.take(SHOWN_BYTES).read_to_end(&mut end)?;
    Ok(String::from_utf8_lossy(&end).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    fn say(logs: &Logs, program: &str, script: &str) {
        let status =
            Command::new("sh").args(["-c", script]).stderr(logs.of(program).unwrap()).status().unwrap();
        assert!(status.success());
    }

    #[test]
    fn only_the_end_is_shown_and_a_program_started_again_goes_on() {
        let logs = Logs::new().unwrap();
        say(&logs, "b", "for i in $(seq 5000); do echo line $i >&2; done");
        say(&logs, "b", "echo again >&2");
        say(&logs, "a", "echo other >&2");
        let ends = logs.ends();
        assert!(ends.contains("line 5000\nagain\n") && !ends.contains("line 1\n"), "{ends}");
        assert!(ends.find("other") < ends.find("again"), "{ends}");
        assert!(ends.len() < 7000, "{}", ends.len());
    }

    #[test]
    fn logs_outlive_a_failure_and_nothing_else() {
        let logs = Logs::new().unwrap();
        let quiet = logs.folder.path().to_owned();
        drop(logs);
        assert!(!quiet.exists());
        let logs = Logs::new().unwrap();
        let kept = logs.folder.path().to_owned();
        let failed = std::thread::spawn(move || {
            let _logs = logs;
            panic!("as meant");
        });
        assert!(failed.join().is_err());
        assert!(kept.exists());
        std::fs::remove_dir_all(kept).unwrap();
    }
}
