//! Shell: `onboard-agent doctor` looks the autopilot over and says whether it is ready to fly a plan, and what to change.
//! It asks, and changes no setting; the autopilot goes on sending the telemetry that it is asked for.

use crate::Shutdown;
use crate::gateway::driver::examination::{Degree, Finding};
use crate::gateway::driver::{Registration, Setup};
use crate::gateway::{Address, Config, from_link};
use anyhow::{Context, bail};
use autopilot_link::signing::Signing;
use autopilot_link::{Link, Outbox};
use std::time::{Duration, Instant, SystemTime};

/// Whoever says nothing for so long isn't there.
const HEARD_WITHIN: Duration = Duration::from_secs(15);
/// Time passes in such steps.
const BEAT: Duration = Duration::from_millis(100);

/// What an autopilot is like.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnosis(Vec<Finding>);

impl Diagnosis {
    /// Nothing is in the way of a flight.
    pub fn is_ready(&self) -> bool {
        self.to_do() == 0
    }

    fn to_do(&self) -> usize {
        self.0.iter().filter(|finding| finding.degree == Degree::ToDo).count()
    }

    /// A line for each finding, and the verdict.
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.0.iter().map(line).collect();
        lines.push(match self.to_do() {
            0 => "This autopilot is ready to fly a plan.".into(),
            1 => "This autopilot is not ready to fly a plan: one thing is to do.".into(),
            count => format!("This autopilot is not ready to fly a plan: {count} things are to do."),
        });
        lines
    }
}

fn line(Finding { degree, about, says }: &Finding) -> String {
    let degree = match degree {
        Degree::Ok => "ok",
        Degree::Note => "note",
        Degree::ToDo => "to do",
    };
    format!("{degree:<5}  {about}: {says}")
}

/// Looks the autopilot over by each of its links, one after the other; hands over what it finds, with the link's address.
///
/// # Errors
/// A link can't be had, nobody answers, or it was asked to end.
pub async fn examine(
    config: &Config,
    shutdown: Shutdown,
    mut found: impl FnMut(&Address, &Diagnosis),
) -> anyhow::Result<()> {
    for address in &config.autopilots {
        found(address, &examine_by(config, address, shutdown.clone()).await?);
    }
    Ok(())
}

async fn examine_by(config: &Config, address: &Address, mut shutdown: Shutdown) -> anyhow::Result<Diagnosis> {
    let driver: Registration = config.driver;
    let make = driver
        .examine
        .with_context(|| format!("the driver `{}` can't look an autopilot over", driver.name))?;
    let link = Link::open(address).await;
    let mut link = link.with_context(|| {
        format!("the autopilot's link {address}: does the agent run already? End it first")
    })?;
    let unix = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let signing = config.key.clone().map(|key| Signing::new(key, unix));
    let mut recognising = signing.clone();
    let mut examination = make(&Setup { links: vec![address.to_string()], signing, ..Setup::default() });
    let (began, mut beat) = (Instant::now(), tokio::time::interval(BEAT));
    let (mut received, mut outbox) = (Vec::new(), Outbox::default());
    loop {
        tokio::select! {
            () = shutdown.requested() => bail!("it was ended before it was done"),
            event = link.next(&mut received, |datagram| {
                (driver.recognises)(datagram, recognising.as_mut().map(|signing| (signing, began.elapsed())))
            }) => {
                examination.receive(began.elapsed(), from_link(event, &received));
            }
            _ = beat.tick() => examination.tick(began.elapsed()),
        }
        outbox.clear();
        examination.send(&mut outbox);
        link.send_all(0, &outbox);
        let now = began.elapsed();
        if examination.is_complete(now) {
            return Ok(Diagnosis(examination.findings(now)));
        }
        if !examination.has_heard() && now > HEARD_WITHIN {
            bail!(
                "nobody answers at {address} within {} s: check that the autopilot is powered, the cable or the network, the port \
                 and the baud rate, that this port speaks MAVLink 2{}, and that no other program (an agent that runs) has it",
                HEARD_WITHIN.as_secs(),
                if config.key.is_some() { " and signs with the key of --signing-key" } else { "" }
            );
        }
    }
}
