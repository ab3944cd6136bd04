//! Brings a list of waypoints aboard by the gateway's transfer, and reads it back: what tests/peers times beside MAVSDK and MAVProxy.
//! `upload_list tcp:127.0.0.1:5760 list.txt`, a list as QGroundControl and MAVProxy write it ("QGC WPL 110").

use anyhow::{Context, bail, ensure};
use autopilot_link::{Address, Event, Link, Outbox};
use geometry::LatLon;
use onboard_agent::gateway::driver::{Courier, FromLink, Setup};
use std::time::{Duration, Instant};

/// It is listened to for so long before it begins, as an agent does long before a flight.
const SETTLED: Duration = Duration::from_secs(3);
/// Time passes in such steps.
const BEAT: Duration = Duration::from_millis(10);

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let [_, address, file] = std::env::args().collect::<Vec<_>>().try_into().ok().context("ADDRESS FILE")?;
    let list = read(&std::fs::read_to_string(&file).with_context(|| format!("reading {file}"))?)?;
    upload(&address.parse()?, list).await
}

async fn upload(address: &Address, list: Vec<(LatLon, f64)>) -> anyhow::Result<()> {
    let mut link = Link::open(address).await?;
    let mut courier = Courier::new(&Setup { links: vec![address.to_string()], ..Setup::default() });
    let (began, mut beat) = (Instant::now(), tokio::time::interval(BEAT));
    let (mut received, mut outbox, mut list) = (vec![], Outbox::default(), Some(list));
    loop {
        tokio::select! {
            event = link.next(&mut received, |_| true) => courier.receive(began.elapsed(), match event {
                Event::Connected(_) | Event::Gone(_) => FromLink::Connected,
                Event::Stream(_) => FromLink::Stream(&received),
                Event::Datagram(_) => FromLink::Datagram(&received),
            }),
            _ = beat.tick() => courier.tick(began.elapsed()),
        }
        if courier.has_heard()
            && began.elapsed() > SETTLED
            && let Some(list) = list.take()
        {
            ensure!(courier.carry(began.elapsed(), &list), "nobody to carry it to");
        }
        outbox.clear();
        courier.send(&mut outbox);
        link.send_all(0, &outbox);
        link.flush();
        match courier.outcome() {
            Some(Ok(())) => {
                println!("verified");
                return Ok(());
            }
            Some(Err(why)) => bail!("{why}"),
            None => {}
        }
    }
}

/// Number, current, frame, command, four parameters, latitude, longitude, altitude, and whether it goes on by itself.
fn read(text: &str) -> anyhow::Result<Vec<(LatLon, f64)>> {
    let mut lines = text.lines();
    ensure!(lines.next() == Some("QGC WPL 110"), "no list of waypoints");
    lines.map(|line| place(line).with_context(|| format!("no waypoint: {line}"))).collect()
}

fn place(line: &str) -> anyhow::Result<(LatLon, f64)> {
    let numbers = line.split('\t').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let [_, _, _, command, .., lat_deg, lon_deg, altitude_m, _] = numbers[..] else { bail!("too short") };
    ensure!(command == 16.0, "only waypoints are carried");
    Ok((LatLon { lat_deg, lon_deg }, altitude_m))
}
