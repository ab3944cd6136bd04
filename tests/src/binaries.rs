//! The real programs: built once, started, listened to, ended.

use crate::logs::Logs;
use anyhow::{Context, bail};
use std::{
    ffi::OsString,
    io::{BufRead, BufReader},
    path::PathBuf,
    process::{Child, Command, ExitStatus, Stdio},
    sync::{LazyLock, mpsc},
    time::{Duration, Instant},
};

/// Folder of the binaries, built with the profile of this test.
static BINARIES: LazyLock<Result<PathBuf, String>> = LazyLock::new(|| build().map_err(|e| format!("{e:#}")));

fn build() -> anyhow::Result<PathBuf> {
    let test = std::env::current_exe().context("where am I?")?;
    let folder = test.ancestors().nth(2).context("target folder")?.to_owned();
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "-p", "sim", "-p", "onboard-agent", "--bins"]);
    if folder.ends_with("release") {
        cargo.arg("--release");
    }
    cargo.current_dir(env!("CARGO_MANIFEST_DIR"));
    // what Cargo tells a test of its own package: build scripts that look at it would run anew, and half of the rest with them
    let of_this_package = |name: &OsString| {
        let name = name.to_string_lossy();
        name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_")
    };
    for (name, _) in std::env::vars_os().filter(|(name, _)| of_this_package(name)) {
        cargo.env_remove(name);
    }
    anyhow::ensure!(cargo.status().context("cargo")?.success(), "the binaries don't build");
    Ok(folder)
}

/// A binary.
pub fn path(name: &str) -> anyhow::Result<PathBuf> {
    let folder = BINARIES.as_ref().map_err(|e| anyhow::anyhow!("{e}"))?;
    Ok(folder.join(name))
}

/// How long a program may take to say something on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running program; killed when dropped.
pub struct Program {
    name: &'static str,
    child: Child,
    lines: mpsc::Receiver<String>,
}

impl Program {
    /// Starts a binary, which logs as `log`.
    pub fn start(name: &'static str, arguments: &[&str], logs: &Logs, log: &str) -> anyhow::Result<Self> {
        let mut child = Command::new(path(name)?)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(logs.of(log).context("its log")?)
            .spawn()
            .with_context(|| format!("starting {name}"))?;
        let output = child.stdout.take().context("standard output")?;
        let (sender, lines) = mpsc::channel();
        std::thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    // nobody waits for a line any more: keep the pipe empty
                    continue;
                }
            }
        });
        Ok(Self { name, child, lines })
    }

    /// What follows `prefix` on the first line that has it.
    pub fn wait_for(&self, prefix: &str) -> anyhow::Result<String> {
        let end = Instant::now() + PATIENCE;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let Ok(line) = self.lines.recv_timeout(left) else {
                bail!("{} never said {prefix:?}", self.name)
            };
            if let Some((_, rest)) = line.split_once(prefix) {
                return Ok(rest.trim().to_owned());
            }
        }
    }

    /// Its process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// SIGKILL, as by a crash.
    pub fn kill(&mut self) -> anyhow::Result<()> {
        self.child.kill().context("kill")?;
        self.child.wait().context("wait")?;
        Ok(())
    }

    /// SIGTERM.
    pub fn ask_to_end(&self) -> anyhow::Result<()> {
        self.signal("-TERM")
    }

    /// SIGSTOP: it does nothing, and nothing of it is gone.
    pub fn freeze(&self) -> anyhow::Result<()> {
        self.signal("-STOP")
    }

    /// SIGCONT.
    pub fn thaw(&self) -> anyhow::Result<()> {
        self.signal("-CONT")
    }

    fn signal(&self, signal: &str) -> anyhow::Result<()> {
        let sent = Command::new("kill").args([signal, &self.id().to_string()]).status().context("kill")?;
        anyhow::ensure!(sent.success(), "{} can't be sent {signal}", self.name);
        Ok(())
    }

    /// Its exit status, once it has ended by itself.
    pub fn ended(&mut self) -> anyhow::Result<ExitStatus> {
        let end = Instant::now() + PATIENCE;
        loop {
            if let Some(status) = self.child.try_wait().context("wait")? {
                return Ok(status);
            }
            anyhow::ensure!(Instant::now() < end, "{} does not end", self.name);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Writes a line to its standard input.
    pub fn send_line(&mut self, line: &str) -> anyhow::Result<()> {
        use std::io::Write;
        let input = self.child.stdin.as_mut().context("standard input")?;
        writeln!(input, "{line}").context("writing to standard input")?;
        input.flush().context("writing to standard input")
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // it may have ended already
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
