//! KMZ: a zip file whose first KML file is the drawing. What is unpacked is bounded, even if the file claims otherwise.

use crate::drawing::Drawing;
use crate::{Error, MAX_BYTES, kml};
use std::io::{Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// Most files in it.
const MAX_FILES: usize = 10_000;

/// What an entry of the directory begins with (APPNOTE 4.3.12).
const ENTRY: &[u8] = b"PK\x01\x02";

/// Reads a file.
pub fn read(bytes: &[u8]) -> Result<Drawing, Error> {
    // before the directory is read: each entry takes memory
    if bytes.windows(ENTRY.len()).filter(|window| *window == ENTRY).count() > MAX_FILES {
        return Err(Error::TooMany { what: "packed files", limit: MAX_FILES });
    }
    let broken = |error: &dyn std::fmt::Display| {
        Error::malformed("file", format!("this zip file can't be read: {error}"))
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| broken(&e))?;
    let names: Vec<String> = archive
        .file_names()
        .map(|name| name.map(std::borrow::Cow::into_owned))
        .collect::<Result<_, _>>()
        .map_err(|e| broken(&e))?;
    let is_kml = |name: &str| name.rsplit('.').next().is_some_and(|e| e.eq_ignore_ascii_case("kml"));
    // doc.kml by convention, else the first one
    let main = names.iter().position(|n| n == "doc.kml").or(names.iter().position(|n| is_kml(n)));
    let index = main.ok_or_else(|| Error::malformed("file", "there is no KML file in this KMZ"))?;
    let mut document = Vec::new();
    let file = archive.by_index(index).map_err(|e| broken(&e))?;
    file.take(MAX_BYTES as u64 + 1).read_to_end(&mut document).map_err(|e| broken(&e))?;
    if document.len() > MAX_BYTES {
        return Err(Error::TooLong);
    }
    let mut drawing = kml::read(&document)?;
    for name in names.iter().enumerate().filter(|(i, n)| *i != index && !n.ends_with('/')).map(|(_, n)| n) {
        let name: String = name.chars().take(100).collect();
        drawing.notes.push("file-not-carried", name, "this packed file is left out");
    }
    Ok(drawing)
}

/// Writes a file.
pub fn write(drawing: &Drawing) -> Result<Vec<u8>, Error> {
    let failed =
        |error: &dyn std::fmt::Display| Error::malformed("file", format!("can't be packed: {error}"));
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    writer.start_file("doc.kml", SimpleFileOptions::default()).map_err(|e| failed(&e))?;
    writer.write_all(&kml::write(drawing)).map_err(|e| failed(&e))?;
    Ok(writer.finish().map_err(|e| failed(&e))?.into_inner())
}
