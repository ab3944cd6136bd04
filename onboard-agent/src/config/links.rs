//! The options that are about the links to the autopilot.

use super::Options;
use crate::gateway::mirror::Mirror;
use crate::services::storage;
use crate::{gateway, key_file};
use anyhow::{Context, bail};
use autopilot_link::signing::Key;
use serde::Deserialize;

const DEFAULT_AUTOPILOT: &str = "udp:127.0.0.1:14550";
/// Folder of the telemetry logs in the state directory, and the room that they may take and leave.
const TLOGS: &str = "tlogs";
const TLOG_QUOTA_MIB: u64 = 1024;
const TLOG_RESERVE_MIB: u64 = 512;
/// More links to one autopilot are a mistake.
const LINKS_MAX: usize = 8;

impl Options {
    /// The links, the preferred one first.
    pub(super) fn autopilots(&self) -> anyhow::Result<Vec<gateway::Address>> {
        let default = [DEFAULT_AUTOPILOT.to_owned()];
        let given = if self.autopilot.is_empty() { &default[..] } else { &self.autopilot };
        let addresses: Vec<gateway::Address> =
            given.iter().map(|address| address.parse().context("--autopilot")).collect::<Result<_, _>>()?;
        if addresses.len() > LINKS_MAX {
            bail!("--autopilot: {} links; at most {LINKS_MAX} lead to one autopilot", addresses.len());
        }
        if addresses.len() > 1 && addresses.iter().any(gateway::Address::is_replay) {
            bail!("--autopilot: a log is played alone; give tlog:FILE and no other address");
        }
        Ok(addresses)
    }

    /// Where the links are logged.
    pub(super) fn tlogs(&self) -> anyhow::Result<Option<gateway::tlog::Config>> {
        if !self.tlog.unwrap_or_default() {
            return Ok(None);
        }
        let folder = self.state_dir.as_ref().context("--tlog: logs need a folder; give --state-dir")?;
        let mib = |mib: Option<u64>, usual: u64| mib.unwrap_or(usual).saturating_mul(1 << 20);
        let limits = storage::Limits {
            quota_bytes: mib(self.tlog_quota_mib, TLOG_QUOTA_MIB),
            reserve_bytes: mib(self.record_reserve_mib, TLOG_RESERVE_MIB),
        };
        let vehicle = self.vehicle().to_owned();
        Ok(Some(gateway::tlog::Config { folder: folder.join(TLOGS), limits, vehicle }))
    }

    /// The key with which messages are signed.
    pub(super) fn key(&self) -> anyhow::Result<Option<Key>> {
        self.signing_key.as_deref().map(key_file::read).transpose()
    }

    /// Where other programs may watch.
    pub(super) fn mirror(&self) -> anyhow::Result<Option<Mirror>> {
        let place = self.mirror.as_deref();
        place.map(|place| Mirror::parse(place, self.is_insecure())).transpose().context("--mirror")
    }
}

/// A text, or a list of them.
pub(super) fn one_or_more<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Given {
        One(String),
        More(Vec<String>),
    }
    Ok(match Given::deserialize(from)? {
        Given::One(one) => vec![one],
        Given::More(more) => more,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(change: impl FnOnce(&mut Options)) -> Options {
        let mut options = Options::default();
        change(&mut options);
        options
    }

    #[test]
    fn what_can_not_be_done_with_the_links_is_refused_in_words() {
        let links = |addresses: &[&str]| {
            with(|o| o.autopilot = addresses.iter().map(|a| (*a).to_owned()).collect()).autopilots()
        };
        assert_eq!(links(&[]).unwrap().len(), 1);
        assert_eq!(links(&["udp:127.0.0.1:1", "serial:/dev/ttyUSB0:57600"]).unwrap().len(), 2);
        assert!(links(&["tlog:flight.tlog"]).unwrap()[0].is_replay());
        let played = Options {
            autopilot: vec!["tlog:flight.tlog".into()],
            state_dir: Some("flight".into()),
            ..Options::default()
        };
        let plays = played.fp_manager().unwrap();
        assert!(plays.replay && plays.state_dir.is_none(), "nothing of it is a flight to go on with");
        for (bad, told) in [
            (vec!["tlog:flight.tlog", "udp:127.0.0.1:1"], "alone"),
            (vec!["udp:127.0.0.1:1"; 9], "at most"),
            (vec!["carrier-pigeon"], "serial:DEVICE:BAUD"),
        ] {
            let error = format!("{:#}", links(&bad).unwrap_err());
            assert!(error.contains(told), "{error}");
        }
        let error = with(|o| o.tlog = Some(true)).tlogs().unwrap_err().to_string();
        assert!(error.contains("--state-dir"), "{error}");
        let error = with(|o| o.mirror = Some("tcp:h:1".into())).mirror().unwrap_err();
        assert!(format!("{error:#}").contains("tcp-listen"), "{error:#}");
    }

    #[test]
    fn a_file_names_one_link_or_several() {
        for (file, count) in [
            (r#"{"autopilot": "tcp:h:1"}"#, 1),
            (r#"{"autopilot": ["tcp:h:1", "udp:127.0.0.1:2"]}"#, 2),
            ("{}", 0),
        ] {
            let options: Options = serde_json::from_str(file).unwrap();
            assert_eq!(options.autopilot.len(), count, "{file}");
        }
    }
}
