//! What no service could be started with, found before any is.

use super::Options;
use anyhow::{Context, bail};
use std::path::Path;
use usal::{Key, Kind};

impl Options {
    /// Name, endpoints and addresses are such as can be.
    ///
    /// # Errors
    /// One is not; it is named.
    pub(super) fn plausible(&self) -> anyhow::Result<()> {
        Key::new(self.vehicle(), "gateway", Kind::Variable, "status").context("--vehicle")?;
        for (option, endpoint) in [("--listen", Some(self.listen())), ("--connect", self.connect.as_deref())]
        {
            let Some(endpoint) = endpoint else { continue };
            usal::check_endpoint(endpoint).map_err(|why| anyhow::anyhow!("{option} {endpoint}: {why}"))?;
        }
        let mut seen = std::collections::BTreeSet::new();
        if let Some(twice) = self.autopilot.iter().find(|address| !seen.insert(*address)) {
            bail!("--autopilot: {twice} is given twice; name each link once");
        }
        Ok(())
    }

    /// The plan to begin with can be flown. Only asked of a file that is checked: an agent that comes back in flight goes on with the
    /// plan that it has.
    ///
    /// # Errors
    /// It can't be read, or says something that can't be flown.
    pub(super) fn plan_can_be_flown(&self) -> anyhow::Result<()> {
        let Some(path) = &self.plan else { return Ok(()) };
        let text = super::read_text(path).context("--plan")?;
        let ground = self.tiles()?.unwrap_or_default();
        match flight_plan::compile_document(text.as_bytes(), &self.profile()?, &ground) {
            Ok(_) => Ok(()),
            Err(problems) => bail!("--plan {}: {}", path.display(), advice(path, &problems)),
        }
    }
}

fn advice(path: &Path, problems: &[flight_plan::Problem]) -> String {
    let first = problems.iter().find(|problem| problem.is_error());
    let more = problems.iter().filter(|problem| problem.is_error()).count().saturating_sub(1);
    let first = first.map_or_else(String::new, ToString::to_string);
    match more {
        0 => first,
        more => format!("{first}; and {more} more: `legwork check {}` lists them", path.display()),
    }
}
