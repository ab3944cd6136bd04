//! Recordings: what a crash, a broken disk or another program has left.

use ::recording::{Contents, Ending, from_cbor, repair, scan};

/// Any bytes as a recording: read, and mended into one that is whole and holds the same. As CBOR: JSON or an error.
///
/// # Panics
/// Messages that are made up, a place outside of the file, or a mended file that is not whole.
pub fn recording(bytes: &[u8]) {
    let contents = read(bytes);
    assert!(contents.findings.iter().all(|f| f.offset <= contents.bytes));
    assert!(contents.bytes == bytes.len() as u64 || contents.ending != Ending::Finished);
    let mut mended = Vec::new();
    repair(bytes, &mut mended).unwrap();
    let again = read(&mended);
    assert_eq!((again.ending, again.messages), (Ending::Finished, contents.messages));
    assert_eq!(again.span_ns, contents.span_ns);
    if let Ok(text) = from_cbor(bytes) {
        assert!(std::str::from_utf8(&text).is_ok(), "JSON is text");
    }
}

fn read(bytes: &[u8]) -> Contents {
    let mut messages = 0;
    let contents = scan(bytes, &mut |_| messages += 1).unwrap();
    assert_eq!(contents.messages, messages);
    contents
}
