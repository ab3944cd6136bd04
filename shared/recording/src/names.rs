//! Names of files.

use std::time::Duration;

/// Extension of a recording.
const EXTENSION: &str = ".mcap";

/// The name of the `number`-th file of a run: vehicle, the time at which it begins (UTC), number.
pub fn file_name(vehicle: &str, unix: Duration, number: u32) -> String {
    format!("{}{EXTENSION}", stem(vehicle, unix, number))
}

/// The same without its extension.
pub fn stem(vehicle: &str, unix: Duration, number: u32) -> String {
    let seconds = i64::try_from(unix.as_secs()).unwrap_or(i64::MAX);
    let began = jiff::Timestamp::from_second(seconds).unwrap_or(jiff::Timestamp::MAX);
    format!("{vehicle}-{}-{number:03}", began.strftime("%Y%m%dT%H%M%SZ"))
}

/// A file of this name is a recording.
pub fn is_recording(name: &str) -> bool {
    name.len() > EXTENSION.len() && name.ends_with(EXTENSION)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_sort_by_time() {
        let name = file_name("uav1", Duration::from_secs(1_763_884_800), 2);
        assert_eq!(name, "uav1-20251123T080000Z-002.mcap");
        assert!(is_recording(&name) && !is_recording(".mcap") && !is_recording("uav1.tmp"));
        assert!(
            file_name("uav1", Duration::MAX, 1).ends_with("-001.mcap"),
            "a clock that is mad has a name, too"
        );
    }
}
