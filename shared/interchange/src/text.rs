//! Bytes as text: UTF-8, UTF-16 by its mark, or the one-byte encoding of older Western programs; the last two are told.

use crate::Error;
use crate::note::Notes;
use std::borrow::Cow;

/// What Windows-1252 has where Latin-1 has control characters, 0x80 to 0x9f; what is not there is a replacement character.
const WINDOWS: [char; 32] = [
    '€', '\u{fffd}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{fffd}', 'Ž', '\u{fffd}',
    '\u{fffd}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{fffd}', 'ž', 'Ÿ',
];

/// The text without a byte order mark. UTF-16 is known by its mark; what is neither that nor UTF-8 is taken as Latin-1 (as Windows
/// writes it). Both are noted.
///
/// # Errors
/// It is no text in any of them.
pub fn text_of<'a>(bytes: &'a [u8], notes: &mut Notes) -> Result<Cow<'a, str>, Error> {
    if let Some(text) = utf_16(bytes) {
        let text = text.ok_or_else(|| {
            Error::malformed(
                "file",
                "this begins as text in UTF-16 and is cut off or damaged: save the file as UTF-8",
            )
        })?;
        notes.push("encoding", "file", "the text is UTF-16 and is read as that: save the file as UTF-8");
        return Ok(Cow::Owned(text));
    }
    let as_utf_8 = std::str::from_utf8(bytes);
    if has_zeros(bytes) || (as_utf_8.is_err() && bytes.contains(&0)) {
        let reason = "this is no text, or text in UTF-16 without a mark: save the file as UTF-8";
        return Err(Error::malformed("file", reason));
    }
    match as_utf_8 {
        Ok(text) => Ok(Cow::Borrowed(text.trim_start_matches('\u{feff}'))),
        Err(error) => {
            let message = format!(
                "the text is not UTF-8 (byte {}) and is read as Latin-1: look at the names, or save the file as UTF-8",
                error.valid_up_to()
            );
            notes.push("encoding", "file", message);
            Ok(Cow::Owned(bytes.iter().map(|byte| western(*byte)).collect()))
        }
    }
}

/// Letters of ASCII, each with a zero beside it: that is UTF-8, too, and means nothing.
fn has_zeros(bytes: &[u8]) -> bool {
    bytes.iter().take(4).any(|byte| *byte == 0)
}

/// A part of a file as it may be looked into, whatever its encoding; `of`: what the file begins with.
pub fn glimpse<'a>(part: &'a [u8], of: &[u8]) -> Cow<'a, str> {
    match order_of(of) {
        Some(unit) => {
            let units = part.as_chunks::<2>().0.iter().map(|pair| unit(*pair));
            Cow::Owned(char::decode_utf16(units).map(|c| c.unwrap_or('\u{fffd}')).collect())
        }
        None => String::from_utf8_lossy(part),
    }
}

/// The text behind a mark of UTF-16; `Some(None)`: it is not whole; `None`: there is no such mark.
fn utf_16(bytes: &[u8]) -> Option<Option<String>> {
    let unit = order_of(bytes)?;
    let (pairs, rest) = bytes.get(2..)?.as_chunks::<2>();
    let text = char::decode_utf16(pairs.iter().map(|pair| unit(*pair))).collect::<Result<String, _>>();
    Some(text.ok().filter(|_| rest.is_empty()))
}

/// How two bytes are a unit of UTF-16, by the mark at the beginning.
fn order_of(bytes: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    match bytes {
        [0xff, 0xfe, ..] => Some(u16::from_le_bytes),
        [0xfe, 0xff, ..] => Some(u16::from_be_bytes),
        _ => None,
    }
}

fn western(byte: u8) -> char {
    let windows = byte.checked_sub(0x80).and_then(|index| WINDOWS.get(usize::from(index)));
    windows.copied().unwrap_or(char::from(byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_older_programs_is_read_and_told() {
        let mut notes = Notes::default();
        assert_eq!(text_of("\u{feff}Höhe".as_bytes(), &mut notes).unwrap(), "Höhe");
        assert!(text_of(b"<\0k\0\xff", &mut notes).is_err());
        assert_eq!(notes.into_vec(), []);
        let mut notes = Notes::default();
        assert_eq!(text_of(b"H\xf6he \x80\x9f\xa0", &mut notes).unwrap(), "Höhe €Ÿ\u{a0}");
        assert_eq!(notes.into_vec()[0].code, "encoding");
    }

    #[test]
    fn text_in_utf_16_is_read_in_either_order_and_told() {
        for (mark, bytes_of) in
            [(b"\xff\xfe", u16::to_le_bytes as fn(u16) -> [u8; 2]), (b"\xfe\xff", u16::to_be_bytes)]
        {
            let mut bytes = mark.to_vec();
            bytes.extend("Höhe €".encode_utf16().flat_map(bytes_of));
            let mut notes = Notes::default();
            assert_eq!(text_of(&bytes, &mut notes).unwrap(), "Höhe €");
            assert_eq!(notes.into_vec()[0].code, "encoding");
            assert!(glimpse(&bytes, &bytes).ends_with("Höhe €"));
            bytes.push(0);
            let cut_off = text_of(&bytes, &mut Notes::default()).unwrap_err();
            assert!(cut_off.to_string().contains("UTF-16"), "{cut_off}");
        }
    }
}
