//! What changes a flight is reviewed before it takes effect.

use super::*;
use geometry::LatLon;
use terrain::Terrain;

/// Flat but for a hill north of 36.35 N.
struct Hill;

impl Terrain for Hill {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        Some(if p.lat_deg > 36.35 { 900.0 } else { 340.0 })
    }
}

/// A keep-out zone north of the square, a scan whose place is a variable, and a hill beyond.
fn searching() -> String {
    let variables = r#"<variables><variable name="spot" type="position" initial="36.3150 -84.1700"/><variable name="note" type="number" initial="0"/></variables>
        <zones><keepOut id="ko" lat="36.3350" lon="-84.1950" radius="600"/></zones><mainPlan"#;
    let scan = r#"<scan id="s" spacing="200" heading="90" overshoot="0"><area centre="= spot" radius="300"/></scan><TF id="side3""#;
    SQUARE.replace("<mainPlan", variables).replace(r#"<TF id="side3""#, scan)
}

fn spot(lat: f64, lon: f64) -> Command {
    let value = VariableValue::Position(LatLon::new(lat, lon));
    Command::SetVariable { name: "spot".into(), value }
}

fn note(value: f64) -> Command {
    Command::SetVariable { name: "note".into(), value: VariableValue::Number(value) }
}

fn refused<A: std::fmt::Debug>(answer: Result<A, CallError>) -> Refusal {
    match answer.unwrap_err() {
        CallError::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    }
}

impl Flight {
    /// In the air, and holding: the gateway flies a waypoint a step, and an answer takes as many as it takes.
    async fn searching() -> Self {
        let mut flight = Self::over(Arc::new(Hill), None).await;
        flight.load(&searching()).await;
        flight.start().await;
        flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "take-off")).await;
        flight.command(Command::Hold).await.unwrap();
        flight
    }

    /// Flies on; where the scan was flown (what was steered to when the hold came, and the place of the hold, left out).
    async fn scanned(&mut self) -> Vec<LatLon> {
        self.command(Command::Resume).await.unwrap();
        self.step_until(|g| g.finished()).await;
        let scan = self.gateway.flown.iter().filter(|w| w.leg.as_str() == "s");
        scan.rev().take(5).map(|w| w.position).collect()
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn place_written_into_a_zone_or_a_hill_is_refused_and_the_path_stays() {
    let mut flight = Flight::searching().await;
    let values = flight.client.follow(topic::VARIABLES).unwrap();
    let into_zone = refused(flight.command(spot(36.3350, -84.1950)).await);
    assert_eq!(into_zone.code, "keep-out");
    assert!(into_zone.reason.contains("zone `ko`") && into_zone.reason.contains(" s: "), "{into_zone}");
    assert_eq!(refused(flight.command(spot(36.3600, -84.1700)).await).code, "below-terrain");
    flight.step(2).await;
    let told = values.latest().unwrap().stamped.value.clone();
    assert!(format!("{told:?}").contains("36.315"), "the old value: {told:?}");
    let scan = flight.scanned().await;
    assert!(scan.iter().all(|p| p.distance_m(LatLon::new(36.3150, -84.1700)) < 600.0), "{scan:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn place_written_into_the_open_takes_effect() {
    let mut flight = Flight::searching().await;
    flight.command(spot(36.3000, -84.1600)).await.unwrap();
    let scan = flight.scanned().await;
    assert!(scan.iter().all(|p| p.distance_m(LatLon::new(36.3000, -84.1600)) < 600.0), "{scan:?}");
}

/// One review at a time; what a caller wrote first is answered first, whatever has to be reviewed.
#[tokio::test(flavor = "multi_thread")]
async fn writes_of_one_asker_keep_their_order_and_very_many_are_too_many() {
    let mut flight = Flight::searching().await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Now).unwrap();
    let call = |flight: &Flight, command: &Command| flight.client.call(topic::COMMAND, command, DEADLINE);
    let calls = [
        call(&flight, &spot(36.3010, -84.1600)),
        call(&flight, &note(1.0)),
        call(&flight, &spot(36.3000, -84.1600)),
    ];
    for answer in calls {
        flight.gateway.step_until_done(answer).await.unwrap();
    }
    let mut written = Vec::new();
    until(async || {
        while let Some(Occurrence::Event { event, .. }) = events.try_recv() {
            if let PlanEvent::VariableChanged { name, .. } = event.value {
                written.push(name.to_string());
            }
        }
        written.len() == 3
    })
    .await;
    assert_eq!(written, ["spot", "note", "spot"]);
    let calls: Vec<_> =
        (0..40).map(|i| call(&flight, &spot(36.3000, -84.1600 - 1e-5 * f64::from(i)))).collect();
    let (mut done, mut busy) = (0, 0);
    for answer in calls {
        match flight.gateway.step_until_done(answer).await {
            Ok(_) => done += 1,
            refused_ => busy += usize::from(refused(refused_).code == "busy"),
        }
    }
    assert!(done >= 16 && busy > 0 && done + busy == 40, "{done} done, {busy} busy");
}

/// What the battery has left counts, and not what it had at the start.
#[tokio::test(flavor = "multi_thread")]
async fn proposal_that_the_energy_left_does_not_last_for_is_refused() {
    let mut flight = Flight::searching().await;
    let laps = r#"<iterative id="laps" form="forward" count="9"><TF id="l1" lat="36.2600" lon="-84.1600"/><TF id="l2" lat="36.3000" lon="-84.1600"/></iterative><TF id="side4""#;
    let longer = searching().replace(r#"<TF id="side4""#, laps);
    assert!(flight.propose(&longer).await.unwrap().acceptable);
    flight.gateway.battery = 0.3;
    flight.step(2).await;
    let refusal = refused(flight.propose(&longer).await);
    assert!(refusal.code == "plan-errors" && refusal.reason.contains("[energy]"), "{refusal}");
}

/// Accepted with a full battery, it is held against what is left when it is to take over.
#[tokio::test(flavor = "multi_thread")]
async fn plan_is_looked_at_again_when_it_takes_over() {
    let mut flight = Flight::searching().await;
    let laps = r#"<iterative id="laps" form="forward" count="9"><TF id="l1" lat="36.2600" lon="-84.1600"/><TF id="l2" lat="36.3000" lon="-84.1600"/></iterative><TF id="side4""#;
    let report = flight.propose(&searching().replace(r#"<TF id="side4""#, laps)).await.unwrap();
    flight.gateway.battery = 0.3;
    flight.step(2).await;
    let commit = Command::Commit { hash: report.hash, entry: None };
    assert_eq!(refused(flight.command(commit).await).code, "energy");
    let report = flight.propose(&searching().replace("36.3150", "36.3140")).await.unwrap();
    flight.command(Command::Commit { hash: report.hash, entry: None }).await.unwrap();
}

/// A zone whose time is over by the satellites' clock is none.
#[tokio::test(flavor = "multi_thread")]
async fn plan_good_for_its_time_of_day_is_accepted_on_the_ground_and_in_flight() {
    let zone = r#"<keepOut id="ko" lat="36.3150" lon="-84.1700" radius="600"><active from="2026-06-01T06:00:00Z" until="2026-06-01T06:40:00Z"/></keepOut>"#;
    let plan = searching().replace(r#"<keepOut id="ko" lat="36.3350" lon="-84.1950" radius="600"/>"#, zone);
    const SIX_O_CLOCK: i64 = 1_780_293_600;
    let mut flight = Flight::over(Arc::new(Hill), None).await;
    assert!(refused(flight.propose(&plan).await).reason.contains("start time is not known"));
    flight.gateway.unix_s = Some(SIX_O_CLOCK);
    flight.step(2).await;
    assert!(refused(flight.propose(&plan).await).reason.contains("[keep-out]"));
    flight.gateway.unix_s = Some(SIX_O_CLOCK + 2400);
    flight.step(2).await;
    flight.load(&plan).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "take-off")).await;
    assert!(flight.propose(&plan.replace("Square", "Round")).await.unwrap().acceptable);
    flight.gateway.unix_s = Some(SIX_O_CLOCK);
    flight.step(2).await;
    let again = plan.replace(r#"id="ko""#, r#"id="ko2""#);
    assert!(refused(flight.propose(&again).await).reason.contains("[keep-out]"));
}

/// A holding west of the zone, then round its south to the east of it: the straight way is for the one to know who goes it.
#[tokio::test(flavor = "multi_thread")]
async fn straight_way_to_a_leg_through_a_zone_is_taken_at_once_and_told() {
    let round = r#"<HM id="west" lat="36.3350" lon="-84.2200" course="0" turn="left" length="300"/>
        <TF id="south" lat="36.3200" lon="-84.1950"/><TF id="east" lat="36.3350" lon="-84.1750"/>"#;
    let end = r#"altitude="110" altitudeReference="home"/>"#;
    let mut flight = Flight::new(None).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Remembered).unwrap();
    flight.load(&searching().replace(end, &format!("{end}{round}"))).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "west")).await;
    flight.command(Command::GoTo { leg: "east".into() }).await.unwrap();
    let (leg, code, reason) = within(async {
        loop {
            flight.gateway.step().await;
            while let Some(occurrence) = events.try_recv() {
                let Occurrence::Event { event, .. } = occurrence else { continue };
                if let PlanEvent::ProblemAhead { leg, code, reason } = event.value {
                    return (leg, code, reason);
                }
            }
        }
    })
    .await;
    assert_eq!((leg, code.as_str()), (Some("east".into()), "keep-out"));
    assert!(reason.contains("zone `ko`"), "{reason}");
    flight.step_until(|g| g.finished()).await;
    assert!(!legs(&flight.gateway).contains(&"south".to_owned()));
}

/// What the reviews could not know, the gateway refuses all the same: the plan before the commit is flown on, and that is told.
#[tokio::test(flavor = "multi_thread")]
async fn a_plan_that_the_gateway_refuses_leaves_the_one_before_it_flying() {
    let mut flight = Flight::new(None).await;
    let mut events = flight.client.listen(topic::EVENTS, Start::Now).unwrap();
    // rounds enough for the commit to come while they are flown
    let rounds = SQUARE
        .replace(r#"<TF id="side2""#, r#"<iterative id="rounds" form="forward" count="9"><TF id="side2""#)
        .replace(r#"<TF id="side4""#, r#"</iterative><TF id="side4""#);
    let detour = r#"<TF id="detour" lat="36.3110" lon="-84.1600"/></iterative>"#;
    flight.load(&rounds).await;
    flight.start().await;
    flight.step_until(|g| g.flown.iter().any(|w| w.leg.as_str() == "side2")).await;
    flight.gateway.refuse_leg = Some("detour".into());
    flight.load(&rounds.replace("</iterative>", detour)).await;
    flight.step_until(|g| g.finished()).await;
    let flown: Vec<&str> = flight.gateway.flown.iter().map(|w| w.leg.as_str()).collect();
    assert_eq!(flown.iter().filter(|leg| **leg == "side3").count(), 9, "{flown:?}");
    assert!(flown.contains(&"land") && !flown.contains(&"detour"), "{flown:?}");
    assert!(!flight.gateway.requests.contains(&GatewayRequest::Hold), "{:?}", flight.gateway.requests);
    let mut told = None;
    while let Some(occurrence) = events.try_recv() {
        if let Occurrence::Event {
            event: Stamped { value: PlanEvent::WaypointsRejected { reason, .. }, .. },
            ..
        } = occurrence
        {
            told = Some(reason);
        }
    }
    let told = told.expect("the refusal is told");
    assert!(told.contains("not there") && told.contains("the plan before the commit is flown on"), "{told}");
}
