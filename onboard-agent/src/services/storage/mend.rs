//! Recordings that an earlier process has left torn are mended when the next one starts, beside the new recording.

use super::disk::{stored, sync_folder};
use super::writer::Inlet;
use recording::{Ending, Level, repair};
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Mends the recordings of a folder that are not whole, on a thread of its own; the log tells which.
pub fn begin(folder: &Path, inlet: Inlet) {
    let torn = torn(folder);
    if torn.is_empty() {
        return;
    }
    let mending = std::thread::Builder::new().name("mend recordings".into()).spawn(move || {
        for path in torn {
            tell(&path, mend(&path), &inlet);
        }
    });
    if let Err(error) = mending {
        tracing::warn!("torn recordings stay as they are: {error}");
    }
}

/// The recordings that don't end as they should.
fn torn(folder: &Path) -> Vec<PathBuf> {
    let recordings = stored(folder).unwrap_or_default().into_iter();
    recordings.map(|s| folder.join(s.name)).filter(|path| !is_whole(path).unwrap_or(true)).collect()
}

fn is_whole(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(recording::END_BYTES)))?;
    let mut end = Vec::new();
    file.take(recording::END_BYTES).read_to_end(&mut end)?;
    Ok(recording::is_end(&end))
}

/// Writes what a recording holds into a whole one, which takes its place; gives the bytes that could not be used.
fn mend(path: &Path) -> io::Result<u64> {
    let whole = path.with_extension("tmp");
    let mended = write_whole(path, &whole);
    if mended.is_err() {
        // the torn one is as good as it was
        let _ = fs::remove_file(&whole);
    }
    mended
}

fn write_whole(path: &Path, whole: &Path) -> io::Result<u64> {
    let torn = File::open(path)?;
    let mut out = BufWriter::new(File::create(whole)?);
    let contents = repair(BufReader::new(&torn), &mut out)?;
    if contents.ending == Ending::Foreign && contents.bytes > 0 {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "it does not begin as a recording"));
    }
    let out = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    out.set_modified(torn.metadata()?.modified()?)?;
    out.sync_all()?;
    fs::rename(whole, path)?;
    sync_folder(path.parent().unwrap_or(Path::new(".")))?;
    Ok(match contents.ending {
        Ending::Torn { good_bytes } => contents.bytes.saturating_sub(good_bytes),
        Ending::Finished | Ending::Foreign => 0,
    })
}

fn tell(path: &Path, mended: io::Result<u64>, inlet: &Inlet) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (level, message) = match mended {
        Ok(lost) => {
            (Level::Info, format!("{name} was torn and is mended; its last {lost} bytes could not be used"))
        }
        Err(error) => (Level::Warning, format!("{name} is torn and could not be mended: {error}")),
    };
    tracing::info!("{message}");
    inlet.line(level, message);
}
