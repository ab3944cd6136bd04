//! MBTiles 1.3: an SQLite database with a table of tiles. Opened to be read only.

use super::picture::{self, MAX_BYTES};
use super::{About, Answer, MAX_ZOOM, Reader, Wanted};
use geometry::LatLon;
use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags, OptionalExtension};
use std::path::Path;

/// Most bytes of a value of its metadata that are looked at.
const MAX_VALUE: usize = 4096;

/// Longest row or value, bytes: a tile and what belongs to it.
const MAX_LENGTH: i32 = 32 << 20;
/// Steps of SQLite's machine between two looks, and most looks of a query.
const STEPS: i32 = 10_000;
/// See [`STEPS`].
const MAX_ROUNDS: u32 = 2_000;

/// A database of tiles.
pub struct Mbtiles(Connection);

impl Mbtiles {
    /// Opens a database and reads what it says of itself.
    ///
    /// # Errors
    /// A sentence: it is none, or its tiles are no pictures.
    pub fn open(path: &Path) -> Result<(Self, About), String> {
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let unreadable =
            |error: rusqlite::Error| format!("it can't be read as MBTiles ({error}): get it again");
        let mut database = Connection::open_with_flags(path, flags).map_err(unreadable)?;
        limit(&mut database).map_err(unreadable)?;
        let mut about = About::default();
        let mut value =
            |name: &str| bounded(&mut database).and_then(|()| value(&database, name)).map_err(unreadable);
        if let Some(format) = value("format")?.filter(|f| f == "pbf" || f == "mvt") {
            return Err(format!(
                "its tiles are drawings ({format}) and no pictures: convert it to tiles of PNG, JPEG or WebP"
            ));
        }
        let zoom = |text: Option<String>| text.and_then(|t| t.trim().parse::<u8>().ok());
        let least = zoom(value("minzoom")?).unwrap_or(0);
        let most = zoom(value("maxzoom")?).unwrap_or(MAX_ZOOM).min(MAX_ZOOM);
        about.zooms = least.min(most)..=most;
        about.attribution = value("attribution")?.map(|text| plain(&text)).unwrap_or_default();
        about.bounds = value("bounds")?.and_then(|text| bounds(&text));
        // there is such a table
        database.prepare(SELECT).map_err(unreadable)?;
        Ok((Self(database), about))
    }
}

const SELECT: &str = "SELECT tile_data FROM tiles WHERE zoom_level = ?1 AND tile_column = ?2 AND tile_row = ?3 AND length(tile_data) <= ?4";

impl Reader for Mbtiles {
    fn read(&mut self, wanted: Wanted) -> Answer {
        let tile = wanted.tile;
        // its rows are counted from the south
        let row = (1u32 << tile.zoom.min(31)).saturating_sub(1).saturating_sub(tile.y);
        if bounded(&mut self.0).is_err() {
            return Answer::Unreadable;
        }
        let found = self.0.prepare(SELECT).and_then(|mut select| {
            let place = (tile.zoom, tile.x, row, MAX_BYTES as i64);
            select.query_row(place, |row| row.get::<_, Vec<u8>>(0)).optional()
        });
        match found {
            Ok(Some(bytes)) => picture::decode(&bytes).map_or(Answer::Unreadable, Answer::Picture),
            Ok(None) => Answer::Nothing,
            Err(_) => Answer::Unreadable,
        }
    }
}

/// Nothing is written, the memory is bounded, and what a foreign schema defines is not trusted.
fn limit(database: &mut Connection) -> rusqlite::Result<()> {
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, MAX_LENGTH)?;
    database.execute_batch(
        "PRAGMA trusted_schema = OFF; PRAGMA query_only = ON; PRAGMA cache_size = -4096; PRAGMA mmap_size = 0;
         PRAGMA temp_store = MEMORY;",
    )
}

/// A query ends after so many steps: tables may be views that never end.
fn bounded(database: &mut Connection) -> rusqlite::Result<()> {
    let mut rounds = 0;
    let is_enough = move || {
        rounds += 1;
        rounds > MAX_ROUNDS
    };
    database.progress_handler(STEPS, Some(is_enough))
}

/// A value of the table of metadata.
fn value(database: &Connection, name: &str) -> rusqlite::Result<Option<String>> {
    let mut select = database
        .prepare("SELECT CAST(substr(value, 1, ?2) AS TEXT) FROM metadata WHERE name = ?1 LIMIT 1")?;
    let found = select.query_row((name, MAX_VALUE as i64), |row| row.get::<_, Option<String>>(0)).optional();
    Ok(found?.flatten())
}

/// `west,south,east,north`.
fn bounds(text: &str) -> Option<(LatLon, LatLon)> {
    let numbers: Vec<f64> = text.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let [west, south, east, north] = numbers.as_slice() else { return None };
    let (south_west, north_east) = (LatLon::new(*south, *west), LatLon::new(*north, *east));
    (south_west.is_valid() && north_east.is_valid()).then_some((south_west, north_east))
}

/// Attributions are written as HTML: only the words of it, and not too many.
pub(super) fn plain(html: &str) -> String {
    let mut inside = false;
    let words = html.chars().filter(|c| {
        inside = (inside || *c == '<') && *c != '>';
        !inside && *c != '>'
    });
    let text: String = words.take(200).collect();
    text.replace("&copy;", "©").replace("&amp;", "&").split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::TileId;
    use crate::tiles::picture::tests::tile;
    use image::ImageFormat;

    /// A database with one tile of level 2 in the north-west, and one that is no picture.
    fn database(format: &str) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        let database = Connection::open(file.path()).unwrap();
        database
            .execute_batch(
                "CREATE TABLE metadata (name TEXT, value TEXT);
                 CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB);",
            )
            .unwrap();
        for (name, value) in [
            ("format", format),
            ("minzoom", "2"),
            ("maxzoom", "3"),
            ("bounds", "-180,0,-90,85"),
            ("attribution", "<b>&copy; Survey</b> of Somewhere"),
        ] {
            database.execute("INSERT INTO metadata VALUES (?1, ?2)", (name, value)).unwrap();
        }
        let insert = "INSERT INTO tiles VALUES (2, ?1, 3, ?2)";
        database.execute(insert, (0, tile(16, [250, 0, 0, 255], ImageFormat::Png))).unwrap();
        database.execute(insert, (1, b"no picture".to_vec())).unwrap();
        database.execute(insert, (2, vec![0u8; MAX_BYTES + 1])).unwrap();
        file
    }

    #[test]
    fn tiles_are_counted_from_the_north_and_unreadable_ones_said() {
        let file = database("png");
        let (mut reader, about) = Mbtiles::open(file.path()).unwrap();
        assert_eq!((about.zooms, about.attribution.as_str()), (2..=3, "© Survey of Somewhere"));
        assert_eq!(about.bounds, Some((LatLon::new(0.0, -180.0), LatLon::new(85.0, -90.0))));
        let mut read = |x, y| reader.read(Wanted { tile: TileId { zoom: 2, x, y }, dark: false });
        assert!(matches!(read(0, 0), Answer::Picture(picture) if picture.pixels[0].r() == 250));
        assert!(matches!(read(1, 0), Answer::Unreadable));
        assert!(matches!(read(2, 0), Answer::Nothing), "too large to be a tile");
        assert!(matches!(read(0, 3), Answer::Nothing));
    }

    #[test]
    fn tables_that_never_end_are_left() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let endless = "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c)";
        Connection::open(file.path())
            .unwrap()
            .execute_batch(&format!(
                "CREATE TABLE metadata (name TEXT, value TEXT);
                 CREATE VIEW tiles AS {endless} SELECT -x AS zoom_level, 1 AS tile_column, 2 AS tile_row, x'00' AS tile_data FROM c;"
            ))
            .unwrap();
        let (mut tiles, _) = Mbtiles::open(file.path()).unwrap();
        let wanted = Wanted { tile: TileId { zoom: 2, x: 1, y: 1 }, dark: false };
        assert!(matches!(tiles.read(wanted), Answer::Unreadable));
    }

    #[test]
    fn what_is_no_database_of_pictures_says_so() {
        let drawings = database("pbf");
        assert!(Mbtiles::open(drawings.path()).err().unwrap().contains("pbf"));
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), [b"SQLite format 3\0".as_slice(), &[7; 2000]].concat()).unwrap();
        assert!(Mbtiles::open(file.path()).err().unwrap().contains("get it again"));
        Connection::open(file.path().with_extension("empty"))
            .unwrap()
            .execute_batch("CREATE TABLE a (b)")
            .unwrap();
        assert!(Mbtiles::open(&file.path().with_extension("empty")).is_err(), "it has no tiles");
        std::fs::remove_file(file.path().with_extension("empty")).unwrap();
    }
}
