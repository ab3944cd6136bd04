//! PMTiles version 3: one file of tiles with directories that lead to them. The crate `pmtiles` knows header and numbering;
//! directories are read here, so that none becomes larger than it may.

use super::mbtiles::plain;
use super::picture::{self, MAX_BYTES};
use super::{About, Answer, MAX_ZOOM, Reader, Wanted};
use flate2::read::MultiGzDecoder;
use geometry::LatLon;
use pmtiles::{Compression, Header, TileCoord, TileId, TileType};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes of a header.
const HEADER: u64 = 127;
/// Most bytes of a directory, and of what the file says of itself, in the file and as they become.
const MAX_PACKED: u64 = 1 << 20;
const MAX_UNPACKED: u64 = 8 << 20;
/// A directory leads to another one at most so often.
const MAX_DEPTH: usize = 5;

/// A file of tiles.
pub struct PmTiles {
    file: File,
    packed: bool,
    tiles_packed: bool,
    leaves: Section,
    tiles: Section,
    root: Vec<Entry>,
    /// The leaf that was read last, and where it is.
    leaf: (u64, Vec<Entry>),
}

/// A part of the file.
#[derive(Debug, Clone, Copy)]
struct Section {
    offset: u64,
    length: u64,
}

impl Section {
    /// A part of this part.
    fn part(self, offset: u64, length: u64) -> Option<Self> {
        let end = offset.checked_add(length)?;
        let offset = self.offset.checked_add(offset)?;
        (end <= self.length).then_some(Self { offset, length })
    }
}

/// A directory's entry: tiles from `first` on, or another directory if it is for none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Entry {
    first: u64,
    offset: u64,
    length: u64,
    tiles: u64,
}

impl PmTiles {
    /// Opens a file and reads what it says of itself.
    ///
    /// # Errors
    /// A sentence: it is none, or its tiles are no pictures.
    pub fn open(path: &Path) -> Result<(Self, About), String> {
        let unreadable = |why: String| format!("it can't be read as PMTiles ({why}): get it again");
        let mut file = File::open(path).map_err(|error| unreadable(error.to_string()))?;
        let damaged = || unreadable("it is damaged".into());
        let bytes = bytes(&mut file, Section { offset: 0, length: HEADER }).ok_or_else(damaged)?;
        let section = |at: usize| {
            let number = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
            Some(Section { offset: number(at)?, length: number(at + 8)? })
        };
        let header =
            Header::try_from_bytes(bytes.clone().into()).map_err(|error| unreadable(error.to_string()))?;
        if !matches!(header.tile_type, TileType::Png | TileType::Jpeg | TileType::Webp) {
            let kind = header.tile_type;
            return Err(format!(
                "its tiles are {kind:?} and no pictures that can be shown: convert it to tiles of PNG, JPEG or WebP"
            ));
        }
        let packed = is_packed(header.internal_compression()).ok_or_else(damaged)?;
        let tiles_packed = is_packed(header.tile_compression).ok_or_else(damaged)?;
        let root = section(8).and_then(|root| directory(&mut file, root, packed)).ok_or_else(damaged)?;
        let about = about(&header, section(24).and_then(|meta| unpacked(&mut file, meta, packed)));
        let (leaves, tiles) = (section(40).ok_or_else(damaged)?, section(56).ok_or_else(damaged)?);
        Ok((Self { file, packed, tiles_packed, leaves, tiles, root, leaf: (u64::MAX, Vec::new()) }, about))
    }

    /// The bytes of a tile; the outer `None`: the file is damaged there.
    fn tile(&mut self, id: u64) -> Option<Option<Vec<u8>>> {
        let Some(mut entry) = find(&self.root, id) else { return Some(None) };
        for _ in 0..MAX_DEPTH {
            if entry.tiles > 0 {
                let section = self.tiles.part(entry.offset, entry.length)?;
                let small = section.length <= MAX_BYTES as u64;
                let bytes = small.then(|| unpacked(&mut self.file, section, self.tiles_packed))?;
                return bytes.map(Some);
            }
            if self.leaf.0 != entry.offset {
                let section = self.leaves.part(entry.offset, entry.length)?;
                self.leaf = (entry.offset, directory(&mut self.file, section, self.packed)?);
            }
            match find(&self.leaf.1, id) {
                Some(next) => entry = next,
                None => return Some(None),
            }
        }
        None
    }
}

impl Reader for PmTiles {
    fn read(&mut self, wanted: Wanted) -> Answer {
        let tile = wanted.tile;
        let Ok(coordinates) = TileCoord::new(tile.zoom, tile.x, tile.y) else { return Answer::Nothing };
        match self.tile(TileId::from(coordinates).value()) {
            Some(Some(bytes)) => picture::decode(&bytes).map_or(Answer::Unreadable, Answer::Picture),
            Some(None) => Answer::Nothing,
            None => Answer::Unreadable,
        }
    }
}

fn about(header: &Header, metadata: Option<Vec<u8>>) -> About {
    let most = header.max_zoom.min(MAX_ZOOM);
    let metadata = metadata.and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok());
    let attribution = metadata.as_ref().and_then(|m| m.get("attribution")?.as_str());
    let south_west = LatLon::new(header.min_latitude, header.min_longitude);
    let north_east = LatLon::new(header.max_latitude, header.max_longitude);
    About {
        zooms: header.min_zoom.min(most)..=most,
        bounds: (south_west.is_valid() && north_east.is_valid()).then_some((south_west, north_east)),
        attribution: attribution.map(plain).unwrap_or_default(),
        themed: false,
    }
}

/// `None`: compressed in a way that is not understood.
fn is_packed(compression: Compression) -> Option<bool> {
    match compression {
        Compression::None => Some(false),
        Compression::Gzip => Some(true),
        _ => None,
    }
}

/// A part of the file as it is; no more than the largest tile, whatever was claimed.
fn bytes(file: &mut File, section: Section) -> Option<Vec<u8>> {
    if section.length > MAX_BYTES as u64 {
        return None;
    }
    file.seek(SeekFrom::Start(section.offset)).ok()?;
    let mut bytes = Vec::new();
    file.take(section.length).read_to_end(&mut bytes).ok()?;
    (bytes.len() as u64 == section.length).then_some(bytes)
}

/// A part of the file, unpacked as far as it may become.
fn unpacked(file: &mut File, section: Section, packed: bool) -> Option<Vec<u8>> {
    let bytes = bytes(file, section)?;
    if !packed {
        return Some(bytes);
    }
    let mut unpacked = Vec::new();
    MultiGzDecoder::new(bytes.as_slice()).take(MAX_UNPACKED + 1).read_to_end(&mut unpacked).ok()?;
    (unpacked.len() as u64 <= MAX_UNPACKED).then_some(unpacked)
}

fn directory(file: &mut File, section: Section, packed: bool) -> Option<Vec<Entry>> {
    if section.length > MAX_PACKED {
        return None;
    }
    entries(&unpacked(file, section, packed)?)
}

/// A directory's entries: their number, then first tiles, numbers of tiles, lengths and offsets.
fn entries(bytes: &[u8]) -> Option<Vec<Entry>> {
    let mut rest = bytes;
    let number = usize::try_from(varint(&mut rest)?).ok()?;
    // each takes four bytes at least
    if number > rest.len() / 4 {
        return None;
    }
    let mut entries = vec![Entry::default(); number];
    let mut first = 0u64;
    for entry in &mut entries {
        first = first.checked_add(varint(&mut rest)?)?;
        entry.first = first;
    }
    for entry in &mut entries {
        entry.tiles = varint(&mut rest)?;
    }
    for entry in &mut entries {
        entry.length = varint(&mut rest)?;
    }
    let mut end = 0u64;
    for entry in &mut entries {
        // 0: where the one before it ends
        let offset = varint(&mut rest)?;
        entry.offset = offset.checked_sub(1).unwrap_or(end);
        end = entry.offset.checked_add(entry.length)?;
    }
    Some(entries)
}

/// The entry of a tile: one for tiles up to it, or a directory that may have it.
fn find(entries: &[Entry], id: u64) -> Option<Entry> {
    let after = entries.partition_point(|entry| entry.first <= id);
    let entry = *entries.get(after.checked_sub(1)?)?;
    (entry.tiles == 0 || id - entry.first < entry.tiles).then_some(entry)
}

/// A number of 7 bits a byte, the lowest first.
fn varint(rest: &mut &[u8]) -> Option<u64> {
    let mut value = 0u64;
    for shift in (0..70).step_by(7) {
        let (byte, tail) = rest.split_first()?;
        *rest = tail;
        value |= u64::from(byte & 0x7f).checked_shl(shift)?;
        if *byte < 0x80 {
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::TileId as Tile;
    use crate::tiles::picture::tests::tile;
    use flate2::{Compression as Level, write::GzEncoder};
    use image::ImageFormat;
    use proptest::prelude::*;
    use std::io::Write;

    fn number(mut value: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        while value > 127 {
            bytes.push((value & 127) as u8 | 128);
            value >>= 7;
        }
        bytes.push(value as u8);
        bytes
    }

    /// A directory: first tile, tiles, length and offset of each entry.
    fn packed_directory(entries: &[(u64, u64, u64, u64)]) -> Vec<u8> {
        let mut bytes = number(entries.len() as u64);
        let mut before = 0;
        for (first, ..) in entries {
            bytes.extend(number(first - before));
            before = *first;
        }
        bytes.extend(entries.iter().flat_map(|(_, tiles, ..)| number(*tiles)));
        bytes.extend(entries.iter().flat_map(|(_, _, length, _)| number(*length)));
        bytes.extend(entries.iter().flat_map(|(.., offset)| number(offset + 1)));
        packed(&bytes)
    }

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Level::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    /// An archive of PNG tiles of levels 0 to 1.
    pub(crate) fn archive(root: &[u8], leaves: &[u8], tiles: &[u8]) -> Vec<u8> {
        let metadata = packed(br#"{"attribution":"<a href='x'>&copy; Somebody</a>"}"#);
        let mut bytes = b"PMTiles\x03".to_vec();
        let mut offset = HEADER;
        for section in [root, &metadata, leaves, tiles] {
            bytes.extend(offset.to_le_bytes());
            bytes.extend((section.len() as u64).to_le_bytes());
            offset += section.len() as u64;
        }
        bytes.extend([0; 24]);
        // clustered, directories packed, tiles not, PNG, levels 0 to 1
        bytes.extend([1, 2, 1, 2, 0, 1]);
        for corner in [-10.0, 35.0, 30.0, 60.0f64] {
            bytes.extend(((corner * 1e7) as i32).to_le_bytes());
        }
        bytes.extend([0; 9]);
        assert_eq!(bytes.len() as u64, HEADER);
        [bytes, root.to_vec(), metadata, leaves.to_vec(), tiles.to_vec()].concat()
    }

    fn open(bytes: &[u8]) -> Result<(PmTiles, About), String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        PmTiles::open(file.path())
    }

    fn wanted(zoom: u8, x: u32, y: u32) -> Wanted {
        Wanted { tile: Tile { zoom, x, y }, dark: false }
    }

    #[test]
    fn tiles_are_found_through_root_and_leaf() {
        let picture = tile(8, [10, 200, 30, 255], ImageFormat::Png);
        let length = picture.len() as u64;
        let leaf = packed_directory(&[(1, 2, length, 0)]);
        let root = packed_directory(&[(0, 1, length, 0), (1, 0, leaf.len() as u64, 0)]);
        let (mut reader, about) = open(&archive(&root, &leaf, &picture)).unwrap();
        assert_eq!((about.zooms, about.attribution.as_str()), (0..=1, "© Somebody"));
        assert!(about.bounds.unwrap().0.distance_m(LatLon::new(35.0, -10.0)) < 1.0);
        for (place, found) in [((0, 0, 0), true), ((1, 0, 0), true), ((1, 0, 1), true), ((1, 1, 1), false)] {
            let answer = reader.read(wanted(place.0, place.1, place.2));
            assert_eq!(matches!(answer, Answer::Picture(_)), found, "{place:?} {answer:?}");
        }
    }

    #[test]
    fn of_a_file_of_a_gigabyte_only_what_is_shown_is_read() {
        const GIGABYTE: u64 = 1 << 30;
        let picture = tile(8, [10, 200, 30, 255], ImageFormat::Png);
        let last = GIGABYTE - picture.len() as u64;
        // the world in one tile of 900 MB, and a good one at the very end
        let root = packed_directory(&[(0, 1, 900 << 20, 0), (1, 1, picture.len() as u64, last)]);
        let mut bytes = archive(&root, &[], &[]);
        bytes[64..72].copy_from_slice(&GIGABYTE.to_le_bytes());
        let from = bytes.len() as u64;
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(&bytes).unwrap();
        // a hole on the disk
        file.as_file().set_len(from + GIGABYTE).unwrap();
        file.seek(SeekFrom::Start(from + last)).unwrap();
        file.write_all(&picture).unwrap();
        let (mut tiles, _) = PmTiles::open(file.path()).unwrap();
        assert!(matches!(tiles.read(wanted(0, 0, 0)), Answer::Unreadable));
        assert!(matches!(tiles.read(wanted(1, 0, 0)), Answer::Picture(_)));
        assert!(matches!(tiles.read(wanted(1, 1, 1)), Answer::Nothing));
    }

    #[test]
    fn a_loop_of_directories_and_a_bomb_are_unreadable() {
        // a leaf that leads to itself
        let leaf = packed_directory(&[(0, 0, 40, 0)]);
        let leaf = packed_directory(&[(0, 0, leaf.len() as u64, 0)]);
        let root = packed_directory(&[(0, 0, leaf.len() as u64, 0)]);
        let (mut reader, _) = open(&archive(&root, &leaf, b"")).unwrap();
        assert!(matches!(reader.read(wanted(0, 0, 0)), Answer::Unreadable));
        // a kilobyte for a thousand times as much, and more than may be
        let bomb = packed(&vec![0; 3 * MAX_UNPACKED as usize]);
        assert!(bomb.len() < 1 << 16);
        let root = packed_directory(&[(0, 0, bomb.len() as u64, 0)]);
        let (mut reader, _) = open(&archive(&root, &bomb, b"")).unwrap();
        assert!(matches!(reader.read(wanted(0, 0, 0)), Answer::Unreadable));
        // a tile that would be a gigabyte
        let root = packed_directory(&[(0, 1, 1 << 30, 0)]);
        let (mut reader, _) = open(&archive(&root, b"", b"x")).unwrap();
        assert!(matches!(reader.read(wanted(0, 0, 0)), Answer::Unreadable));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn damaged_bytes_never_panic(cut in 0usize..400, changes in prop::collection::vec((0usize..600, any::<u8>()), 0..6)) {
            let picture = tile(4, [9, 9, 9, 255], ImageFormat::Png);
            let root = packed_directory(&[(0, 5, picture.len() as u64, 0)]);
            let mut bytes = archive(&root, b"", &picture);
            let length = bytes.len();
            changes.into_iter().for_each(|(at, value)| bytes[at % length] = value);
            bytes.truncate(length - cut % length);
            if let Ok((mut reader, _)) = open(&bytes) {
                let _ = reader.read(wanted(1, 1, 0));
            }
        }
    }
}
