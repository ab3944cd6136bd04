//! Bytes as text: UTF-8, or the one-byte encoding of older Western programs, which says so.

use crate::Error;
use crate::note::Notes;
use std::borrow::Cow;

/// What Windows-1252 has where Latin-1 has control characters, 0x80 to 0x9f; what is not there is a replacement character.
const WINDOWS: [char; 32] = [
    '€', '\u{fffd}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{fffd}', 'Ž', '\u{fffd}',
    '\u{fffd}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{fffd}', 'ž', 'Ÿ',
];

/// The text without a byte order mark. What is not UTF-8 is taken as Latin-1 (as Windows writes it), with a note.
///
/// # Errors
/// It is no text in either of them.
pub fn text_of<'a>(bytes: &'a [u8], notes: &mut Notes) -> Result<Cow<'a, str>, Error> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(Cow::Borrowed(text.trim_start_matches('\u{feff}'))),
        Err(_) if bytes.contains(&0) => {
            Err(Error::malformed("file", "this is no text, or text in UTF-16: save the file as UTF-8"))
        }
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
        assert!(text_of(b"\xff\xfe<\0k\0", &mut notes).is_err());
        assert_eq!(notes.into_vec(), []);
        let mut notes = Notes::default();
        assert_eq!(text_of(b"H\xf6he \x80\x9f\xa0", &mut notes).unwrap(), "Höhe €Ÿ\u{a0}");
        assert_eq!(notes.into_vec()[0].code, "encoding");
    }
}
