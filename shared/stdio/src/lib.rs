//! Shell: standard output and the command line, the same for every program.
//!
//! A result that can't be written (a full disk) is a failure of the command: an empty table must not look like an
//! answer. A reader that has gone away (`| head`) has read what it wanted and is none.

use clap::Parser;
use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

/// Wrong usage, or a file or standard output that can't be read or written.
pub const USAGE: u8 = 2;

/// A line on standard output.
///
/// # Errors
/// It can't be written; the sentence names standard output.
pub fn line(text: Arguments<'_>) -> io::Result<()> {
    write_to(&mut io::stdout().lock(), |out| writeln!(out, "{text}"))
}

/// Bytes on standard output, as they are.
///
/// # Errors
/// They can't be written; the sentence names standard output.
pub fn bytes(bytes: &[u8]) -> io::Result<()> {
    write_to(&mut io::stdout().lock(), |out| out.write_all(bytes))
}

/// The command line of a program; or, when it is wrong or asks for help, the exit status after everything was said.
///
/// # Errors
/// Help and version were printed (a success), or the command line is wrong.
pub fn arguments<C: Parser>() -> Result<C, ExitCode> {
    C::try_parse().map_err(|refused| {
        if refused.use_stderr() {
            // nothing is left to say it on
            let _ = refused.print();
            return ExitCode::from(USAGE);
        }
        // clap writes it itself, with colours where they are wanted
        match write_to(&mut io::stdout(), |_| refused.print()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("{}: {error}", C::command().get_name());
                ExitCode::from(USAGE)
            }
        }
    })
}

/// Writes at once: what waits in a buffer is lost without a word when the program ends.
fn write_to<W: Write>(out: &mut W, write: impl FnOnce(&mut W) -> io::Result<()>) -> io::Result<()> {
    match write(out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(io::Error::new(error.kind(), format!("standard output can't be written: {error}")))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Failing(ErrorKind);

    impl Write for Failing {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Err(self.0.into())
        }
    }

    #[test]
    fn full_disk_is_a_failure_and_an_absent_reader_is_none() {
        let write = |kind| write_to(&mut Failing(kind), |out| out.write_all(b"a line without an end"));
        let error = write(ErrorKind::StorageFull).unwrap_err();
        assert!(error.to_string().starts_with("standard output can't be written"), "{error}");
        assert!(write(ErrorKind::BrokenPipe).is_ok());
        // a buffer takes everything; only the flush shows it
        assert!(write_to(&mut Failing(ErrorKind::StorageFull), |_| Ok(())).is_err());
    }
}
