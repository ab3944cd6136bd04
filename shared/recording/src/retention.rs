//! Which files go so that the disk never fills: the oldest first, the current one never.

use std::time::Duration;

/// What may be kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// All recordings together, bytes.
    pub quota_bytes: u64,
    /// What stays free on the disk for everybody else, bytes.
    pub reserve_bytes: u64,
}

/// A recording on the disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stored {
    /// Its name.
    pub name: String,
    /// Its size, bytes.
    pub bytes: u64,
    /// When it was last written, since 1970 by the machine's clock.
    pub modified: Duration,
}

/// What is to be done about the room on the disk.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Room {
    /// Files to be removed, in this order.
    pub remove: Vec<String>,
    /// Even then there is too little: nothing may be written.
    pub full: bool,
}

/// What has to go before `wanted_bytes` more are written. `free_bytes`: on the disk; `None`: nobody knows.
pub fn excess(
    mut stored: Vec<Stored>,
    current: Option<&str>,
    free_bytes: Option<u64>,
    wanted_bytes: u64,
    limits: Limits,
) -> Room {
    stored.sort_by(|a, b| (a.modified, &a.name).cmp(&(b.modified, &b.name)));
    let mut kept: u64 = stored.iter().fold(wanted_bytes, |sum, file| sum.saturating_add(file.bytes));
    let mut free = free_bytes.unwrap_or(u64::MAX);
    let needed = limits.reserve_bytes.saturating_add(wanted_bytes);
    stored.retain(|file| Some(file.name.as_str()) != current);
    let all_free = stored.iter().fold(free, |sum, file| sum.saturating_add(file.bytes));
    // where others fill the disk, no recording is sacrificed in vain
    let mut room = Room { remove: Vec::new(), full: all_free < needed };
    for file in stored {
        if kept <= limits.quota_bytes && (free >= needed || room.full) {
            break;
        }
        kept = kept.saturating_sub(file.bytes);
        free = free.saturating_add(file.bytes);
        room.remove.push(file.name);
    }
    room
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LIMITS: Limits = Limits { quota_bytes: 100, reserve_bytes: 50 };

    fn stored(files: &[(&str, u64, u64)]) -> Vec<Stored> {
        let file = |(name, bytes, at): &(&str, u64, u64)| Stored {
            name: (*name).to_owned(),
            bytes: *bytes,
            modified: Duration::from_secs(*at),
        };
        files.iter().map(file).collect()
    }

    #[test]
    fn oldest_go_first_and_only_as_many_as_must() {
        let files = stored(&[("new", 40, 3), ("old", 40, 1), ("middle", 40, 2)]);
        let room = excess(files.clone(), None, None, 10, LIMITS);
        assert_eq!(room, Room { remove: vec!["old".into()], full: false });
        let room = excess(files.clone(), None, None, 50, LIMITS);
        assert_eq!(room.remove, ["old", "middle"]);
        assert_eq!(excess(files, None, Some(20), 10, LIMITS).remove, ["old"], "for the reserve as well");
    }

    #[test]
    fn current_file_never_goes() {
        let files = stored(&[("current", 500, 1), ("other", 10, 2)]);
        let room = excess(files, Some("current"), Some(55), 10, LIMITS);
        assert_eq!(room, Room { remove: vec!["other".into()], full: false });
    }

    #[test]
    fn disk_that_others_have_filled_costs_no_recording() {
        let files = stored(&[("old", 20, 1), ("new", 20, 2)]);
        let room = excess(files, None, Some(0), 11, LIMITS);
        assert_eq!(room, Room { remove: vec![], full: true });
    }

    proptest! {
        #[test]
        fn what_is_left_fits_or_only_the_current_is_left(
            sizes in proptest::collection::vec((0u64..60, 0u64..9), 0..12), free in 0u64..200, wanted in 0u64..40,
        ) {
            let names: Vec<String> = (0..sizes.len()).map(|i| i.to_string()).collect();
            let files: Vec<(&str, u64, u64)> =
                names.iter().zip(&sizes).map(|(name, (bytes, at))| (name.as_str(), *bytes, *at)).collect();
            let room = excess(stored(&files), Some("0"), Some(free), wanted, LIMITS);
            prop_assert!(!room.remove.contains(&"0".to_owned()));
            let gone: u64 = files.iter().filter(|f| room.remove.iter().any(|r| r == f.0)).map(|f| f.1).sum();
            let kept: u64 = files.iter().map(|f| f.1).sum::<u64>() - gone;
            let all_gone = room.remove.len() + 1 >= files.len();
            prop_assert!(kept + wanted <= LIMITS.quota_bytes || all_gone);
            let removable: u64 = files.iter().skip(1).map(|f| f.1).sum();
            prop_assert_eq!(room.full, free + removable < LIMITS.reserve_bytes + wanted);
            prop_assert!(room.full || free + gone >= LIMITS.reserve_bytes + wanted);
        }
    }
}
