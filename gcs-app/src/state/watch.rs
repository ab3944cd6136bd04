//! What this ground station watches by itself: whether the aircraft keeps its altitude, and the ground and the zones on the way ahead.
//! An alarm is raised when something has been wrong for a while, and cleared when it is clearly right again; not while the
//! aircraft takes off, approaches or lands, or is flown by hand.

use super::ground_below::GroundBelow;
use super::zones_ahead::{Point, Zones};
use flight_plan::{Id, Runway};
use geometry::LocalFrame;
use terrain::Terrain;
use usal::contract::{Ahead, Alarm, GatewayState, Position, Severity, Token};

/// Who raises these alarms.
pub const GROUND_STATION: &str = "ground station";

/// Off the altitude by more is wrong; by less is right again, metres.
const OFF_ALTITUDE_M: (f64, f64) = (40.0, 25.0);
/// Above the ground by less is wrong; by more is right again, metres.
const NEAR_GROUND_M: (f64, f64) = (30.0, 45.0);
/// Seconds for which it has to be wrong.
const PATIENCE_S: (f64, f64) = (5.0, 2.0);
/// What was wrong is believed for so long without news, seconds.
const UNKNOWN_S: f64 = 10.0;
/// So far ahead the ground is looked at, seconds of flight.
const LOOK_AHEAD_S: f64 = 60.0;
/// And so often, metres.
const EVERY_M: f64 = 50.0;

/// What is watched, at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Sight<'a> {
    /// The aircraft, as long as that is to be believed.
    pub position: Option<Position>,
    /// What the plan has next, likewise.
    pub ahead: Option<&'a Ahead>,
    /// What the gateway does, and why.
    pub state: Option<(GatewayState, &'a str)>,
    /// Those of its plan.
    pub runways: &'a [Runway],
    /// Likewise.
    pub zones: Zones<'a>,
    /// Its engine is out, or seems to be: it neither climbs nor holds.
    pub engine_out: bool,
}

/// The watch over one aircraft.
#[derive(Debug, Default)]
pub struct Watch {
    /// Height above the ground, where both are known, metres.
    pub agl_m: Option<f64>,
    /// The runway of the plan that says how high the ground is there; `None`: the elevations do.
    pub over: Option<Id>,
    /// Where Safe mode leads it, in its gateway's words, or led it before it came down; `None`: something else led it last.
    pub safe_mode: Option<String>,
    altitude: Suspicion,
    ground: Suspicion,
    zone: Suspicion,
    /// The waypoint steered to, its altitude, and the altitude it was steered to from.
    target: Option<(Token, f64, f64)>,
}

#[derive(Debug, Default)]
struct Suspicion {
    since_s: Option<f64>,
    raised: Option<String>,
    /// When it was last known whether something is wrong.
    known_s: Option<f64>,
}

impl Suspicion {
    /// `wrong`: what is wrong now, measured with the limit for one that is raised or not.
    fn follow(&mut self, wrong: Option<String>, patience_s: f64, now_s: f64) {
        let Some(text) = wrong else {
            *self = Self::default();
            return;
        };
        self.known_s = Some(now_s);
        let since_s = *self.since_s.get_or_insert(now_s);
        if self.raised.is_some() || now_s - since_s >= patience_s {
            self.raised = Some(text);
        }
    }

    /// Nothing is known now: that clears nothing until it has lasted.
    fn unknown(&mut self, now_s: f64) {
        if self.known_s.is_some_and(|known_s| now_s - known_s > UNKNOWN_S) {
            *self = Self::default();
        }
    }

    fn limit(&self, (raises, clears): (f64, f64)) -> f64 {
        if self.raised.is_some() { clears } else { raises }
    }
}

impl Watch {
    /// What the height is above: `the ground`, or `runway R05`.
    pub fn below(&self) -> String {
        self.over.as_ref().map_or_else(|| "the ground".to_owned(), |runway| format!("runway {runway}"))
    }

    /// Looks once.
    pub fn look(&mut self, sight: Sight<'_>, terrain: &dyn Terrain, now_s: f64) {
        let position = sight.position.filter(|p| p.position.is_valid() && p.altitude_amsl_m.is_finite());
        // the last one is shown as old, as all that was heard
        if let Some(position) = &position {
            let below = GroundBelow::at(position.position, sight.runways, terrain);
            self.agl_m = below.as_ref().map(|below| position.altitude_amsl_m - below.amsl_m);
            self.over = below.and_then(|below| below.runway);
        }
        if let Some((state, cause)) = sight.state {
            self.follow_safe_mode(state, cause);
        }
        let state = sight.state.map(|(state, _)| state);
        if position.is_none() || state.is_none() {
            self.altitude.unknown(now_s);
            self.ground.unknown(now_s);
            self.zone.unknown(now_s);
            return;
        }
        let enroute = position.filter(|p| !p.on_ground && state.is_some_and(is_enroute));
        // what lies ahead in the plan is flown in this state alone
        let ahead = sight.ahead.filter(|_| state == Some(GatewayState::Nav));
        if enroute.is_some() && ahead.is_none() && state == Some(GatewayState::Nav) {
            self.altitude.unknown(now_s);
        } else {
            let off = enroute.and_then(|p| self.off_altitude(&p, ahead?, sight.engine_out));
            self.altitude.follow(off, PATIENCE_S.0, now_s);
        }
        let way = enroute.map(|position| way(&position, ahead)).unwrap_or_default();
        let near = self.near_ground(&way, sight.engine_out, terrain);
        self.ground.follow(near, PATIENCE_S.1, now_s);
        self.zone.follow(sight.zones.broken(&way, terrain), PATIENCE_S.1, now_s);
    }

    /// It says where it goes before it approaches: then it says how far it is, and nothing of that once it stands.
    fn follow_safe_mode(&mut self, state: GatewayState, cause: &str) {
        use GatewayState::{Off, SafeApproach, SafeLand, Stop};
        match state {
            Off | Stop => {}
            SafeApproach | SafeLand if self.safe_mode.is_some() => {}
            state => self.safe_mode = is_safe(state).then(|| cause.to_owned()),
        }
    }

    /// The alarms that are raised.
    pub fn alarms(&self) -> impl Iterator<Item = Alarm> {
        let altitude = ("altitude-deviation", Severity::Caution, &self.altitude.raised);
        let ground = ("terrain-ahead", Severity::Warning, &self.ground.raised);
        let zone = ("zone-ahead", Severity::Warning, &self.zone.raised);
        [altitude, ground, zone].into_iter().filter_map(|(id, severity, raised)| {
            let (id, source, advice) = (id.into(), GROUND_STATION.into(), raised.clone()?);
            Some(Alarm { id, severity, source, advice, cause: None })
        })
    }

    /// It is outside of what lies between the altitudes of the waypoint before and the one steered to.
    fn off_altitude(&mut self, position: &Position, ahead: &Ahead, engine_out: bool) -> Option<String> {
        let next = ahead.waypoints.first()?;
        let to_m = next.altitude_amsl_m;
        let from_m = match self.target {
            Some((token, _, from_m)) if token == next.token => from_m,
            // flown in order, it comes from the waypoint before
            Some((token, before_m, _)) if token.0 + 1 == next.token.0 => before_m,
            _ => position.altitude_amsl_m,
        };
        self.target = Some((next.token, to_m, from_m));
        let (low_m, high_m) = (from_m.min(to_m), from_m.max(to_m));
        let at_m = position.altitude_amsl_m;
        let (off_m, side) = if at_m < low_m { (low_m - at_m, "below") } else { (at_m - high_m, "above") };
        let advice = match engine_out {
            true => "Without its engine it keeps none: look at its airspeed, and be ready to take over.",
            false => "Look at airspeed and engine; hold, or be ready to take over.",
        };
        (off_m > self.altitude.limit(OFF_ALTITUDE_M))
            .then(|| format!("It flies {off_m:.0} m {side} the altitudes of its leg. {advice}"))
    }

    /// The least height above the ground now and on the way ahead, where that is too little.
    fn near_ground(&self, way: &[Point], engine_out: bool, terrain: &dyn Terrain) -> Option<String> {
        let limit_m = self.ground.limit(NEAR_GROUND_M);
        let heights =
            way.iter().filter_map(|point| Some((point.in_s, point.amsl_m - terrain.elevation_m(point.at)?)));
        let (in_s, height_m) =
            heights.filter(|(_, height_m)| *height_m < limit_m).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let advice = match engine_out {
            true => "The engine is out: turn to lower ground, or be ready to take over.",
            false => "Climb, go to another leg, or be ready to take over.",
        };
        Some(format!("Only {height_m:.0} m above the ground in {in_s:.0} s. {advice}"))
    }
}

/// The gateway's own way home leads the aircraft.
pub fn is_safe(state: GatewayState) -> bool {
    use GatewayState::{SafeApproach, SafeHold, SafeLand, SafeReturn};
    matches!(state, SafeApproach | SafeHold | SafeLand | SafeReturn)
}

/// The gateway flies the plan's waypoints, away from runways, or brings the aircraft home.
fn is_enroute(state: GatewayState) -> bool {
    use GatewayState::*;
    matches!(state, Nav | Hold | Directed | SafeHold | SafeReturn)
}

/// The way from the aircraft to what is flown next, up to the first waypoint at which it lands.
fn way(position: &Position, ahead: Option<&Ahead>) -> Vec<Point> {
    let speed_mps = position.ground_speed_mps.max(5.0);
    let (mut at, mut altitude_m, mut time_s) = (position.position, position.altitude_amsl_m, 0.0);
    let mut points = vec![Point { in_s: time_s, at, amsl_m: altitude_m }];
    for next in ahead.iter().flat_map(|ahead| &ahead.waypoints).filter(|w| w.position.is_valid()) {
        if matches!(next.action, usal::contract::Action::Land { .. }) || time_s >= LOOK_AHEAD_S {
            break;
        }
        let frame = LocalFrame::new(at);
        let to = frame.to_local(next.position);
        let length_m = to.length();
        let most_m = ((LOOK_AHEAD_S - time_s) * speed_mps).min(length_m);
        for step in 1..=(most_m / EVERY_M).ceil() as usize {
            let share = (step as f64 * EVERY_M / length_m.max(1.0)).min(1.0);
            let amsl_m = altitude_m + (next.altitude_amsl_m - altitude_m) * share;
            let in_s = time_s + length_m * share / speed_mps;
            points.push(Point { in_s, at: frame.to_geo(to * share), amsl_m });
        }
        (at, altitude_m, time_s) = (next.position, next.altitude_amsl_m, time_s + length_m / speed_mps);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;
    use terrain::Flat;
    use usal::contract::{Action, Waypoint};

    const HERE: LatLon = LatLon::new(36.3, -84.2);

    const UNSEEN: Sight<'_> = Sight {
        position: None,
        ahead: None,
        state: None,
        runways: &[],
        zones: Zones { all: &[], home_m: 0.0, unix_s: None },
        engine_out: false,
    };

    /// A hill that begins a kilometre north, 480 m high.
    struct Hill;

    impl Terrain for Hill {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            Some(if p.lat_deg > 36.309 { 480.0 } else { 300.0 })
        }
    }

    fn position(altitude_amsl_m: f64) -> Position {
        Position {
            position: HERE,
            altitude_amsl_m,
            altitude_home_m: 0.0,
            velocity_north_mps: 25.0,
            velocity_east_mps: 0.0,
            velocity_down_mps: 0.0,
            track_deg: 0.0,
            ground_speed_mps: 25.0,
            on_ground: false,
        }
    }

    fn ahead(token: u64, altitude_amsl_m: f64) -> Ahead {
        let waypoint = Waypoint {
            token: Token(token),
            position: HERE.destination(0.0, 3000.0),
            altitude_amsl_m,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: "a".into(),
            end_of_plan: false,
        };
        Ahead { waypoints: vec![waypoint] }
    }

    fn look(
        watch: &mut Watch,
        altitude_m: f64,
        ahead: &Ahead,
        terrain: &dyn Terrain,
        now_s: f64,
    ) -> Vec<String> {
        look_in(watch, altitude_m, ahead, terrain, now_s, GatewayState::Nav)
    }

    fn look_in(
        watch: &mut Watch,
        altitude_m: f64,
        ahead: &Ahead,
        terrain: &dyn Terrain,
        now_s: f64,
        state: GatewayState,
    ) -> Vec<String> {
        let (position, ahead, state) = (Some(position(altitude_m)), Some(ahead), Some((state, "")));
        let sight = Sight { position, ahead, state, ..UNSEEN };
        watch.look(sight, terrain, now_s);
        watch.alarms().map(|alarm| alarm.id).collect()
    }

    #[test]
    fn safe_mode_is_remembered_with_where_it_goes_until_something_else_leads() {
        use GatewayState::{Nav, SafeApproach, SafeHold, SafeReturn, Stop, TakeOff};
        let mut watch = Watch::default();
        for (state, cause, expected) in [
            (Nav, "flying waypoints", None),
            (SafeHold, "asked for", Some("asked for")),
            (SafeReturn, "to runway R05", Some("to runway R05")),
            (SafeApproach, "the landing comes next", Some("to runway R05")),
            (Stop, "landed and disarmed", Some("to runway R05")),
            (TakeOff, "taking off", None),
            (SafeApproach, "the landing comes next", Some("the landing comes next")),
        ] {
            watch.look(Sight { state: Some((state, cause)), ..UNSEEN }, &Hill, 0.0);
            assert_eq!(watch.safe_mode.as_deref(), expected, "{state:?}");
        }
    }

    #[test]
    fn no_news_clears_nothing_until_it_has_lasted() {
        let (mut watch, flat, at) = (Watch::default(), Flat(300.0), ahead(1, 500.0));
        look(&mut watch, 500.0, &at, &flat, 0.0);
        let silent = UNSEEN;
        // a link that drops a second of every two
        for second in 0..8 {
            let now_s = 1.0 + 2.0 * f64::from(second);
            look(&mut watch, 440.0, &at, &flat, now_s);
            watch.look(silent, &flat, now_s + 1.0);
        }
        assert_eq!(watch.alarms().count(), 1, "it is raised although news is missing");
        watch.look(silent, &flat, 24.0);
        assert_eq!(watch.alarms().count(), 1);
        watch.look(silent, &flat, 26.0);
        assert_eq!(watch.alarms().count(), 0);
    }

    #[test]
    fn a_deviation_is_raised_after_a_while_and_cleared_when_it_is_clearly_over() {
        let (mut watch, flat, at) = (Watch::default(), Flat(300.0), ahead(1, 500.0));
        let none: Vec<String> = Vec::new();
        for (now_s, altitude_m, expected) in [
            (0.0, 500.0, false),
            (1.0, 455.0, false),
            (5.0, 455.0, false),
            (6.0, 455.0, true),
            (7.0, 470.0, true),
            (8.0, 476.0, false),
            (9.0, 470.0, false),
            (20.0, 545.0, false),
            (22.0, 500.0, false),
            (26.0, 545.0, false),
        ] {
            let raised = look(&mut watch, altitude_m, &at, &flat, now_s);
            let expected = if expected { vec!["altitude-deviation".to_owned()] } else { none.clone() };
            assert_eq!(raised, expected, "at {now_s} s");
        }
    }

    #[test]
    fn a_climb_from_waypoint_to_waypoint_is_no_deviation() {
        let (mut watch, flat) = (Watch::default(), Flat(300.0));
        look(&mut watch, 500.0, &ahead(1, 500.0), &flat, 0.0);
        for tenth in 0..600_u32 {
            let altitude_m = 500.0 + f64::from(tenth) * 0.5;
            let raised = look(&mut watch, altitude_m, &ahead(2, 800.0), &flat, 1.0 + f64::from(tenth) / 10.0);
            assert!(raised.is_empty(), "at {altitude_m} m");
        }
        // sent somewhere else, it begins where it is
        for now_s in [70.0, 80.0] {
            assert!(look(&mut watch, 800.0, &ahead(40, 500.0), &flat, now_s).is_empty());
        }
    }

    #[test]
    fn ground_ahead_is_told_before_it_is_reached() {
        let (mut watch, at) = (Watch::default(), ahead(1, 500.0));
        assert!(look(&mut watch, 500.0, &at, &Hill, 0.0).is_empty(), "for a moment");
        assert_eq!(look(&mut watch, 500.0, &at, &Hill, 2.0), ["terrain-ahead"]);
        assert_eq!(watch.agl_m, Some(200.0));
        let alarm = watch.alarms().next().unwrap();
        assert_eq!((alarm.severity, alarm.source.as_str()), (Severity::Warning, GROUND_STATION));
        assert!(alarm.advice.contains("20 m above the ground in 4"), "{}", alarm.advice);
        // higher, but not yet clearly
        assert_eq!(look(&mut watch, 520.0, &ahead(1, 520.0), &Hill, 3.0), ["terrain-ahead"]);
        assert!(look(&mut watch, 530.0, &ahead(1, 530.0), &Hill, 4.0).is_empty());
    }

    #[test]
    fn a_zone_ahead_is_told_before_it_is_reached_and_cleared_behind_it() {
        let plan = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><zones>
            <keepOut id="z" lat="36.3081" lon="-84.2" radius="100"/></zones></flightPlan>"#;
        let zones = flight_plan::read(plan.as_bytes()).plan.zones;
        let (mut watch, at) = (Watch::default(), ahead(1, 500.0));
        let mut raised = |all: &[flight_plan::Zone], state, now_s| {
            let sight = Sight {
                position: Some(position(500.0)),
                ahead: Some(&at),
                state: Some((state, "")),
                zones: Zones { all, ..Zones::default() },
                ..UNSEEN
            };
            watch.look(sight, &Flat(300.0), now_s);
            watch.alarms().map(|alarm| (alarm.id, alarm.advice)).collect::<Vec<_>>()
        };
        assert!(raised(&zones, GatewayState::Nav, 0.0).is_empty(), "for a moment");
        let [(id, advice)] = raised(&zones, GatewayState::Nav, 2.0).try_into().unwrap();
        assert!(id == "zone-ahead" && advice.contains("in 32 s"), "{advice}");
        assert!(raised(&zones, GatewayState::Hold, 3.0).is_empty(), "it circles here");
        assert!(raised(&[], GatewayState::Nav, 10.0).is_empty());
    }

    /// It said *Climb* to one that could not.
    #[test]
    fn an_aircraft_without_its_engine_is_not_told_to_climb_or_to_hold() {
        for (altitude_m, at_m) in [(340.0, 340.0), (500.0, 600.0)] {
            let at = ahead(1, at_m);
            let advice = [false, true].map(|engine_out| {
                let mut watch = Watch::default();
                look(&mut watch, at_m, &at, &Hill, 0.0);
                for now_s in [1.0, 10.0] {
                    let sight = Sight {
                        ahead: Some(&at),
                        state: Some((GatewayState::Nav, "")),
                        engine_out,
                        position: Some(position(altitude_m)),
                        ..UNSEEN
                    };
                    watch.look(sight, &Hill, now_s);
                }
                watch.alarms().map(|alarm| alarm.advice).collect::<String>()
            });
            let asks_for_power = |advice: &String| advice.contains("Climb") || advice.contains("hold,");
            assert_eq!(advice.each_ref().map(asks_for_power), [true, false], "{advice:?}");
        }
    }

    #[test]
    fn nothing_is_raised_near_a_runway_by_hand_or_where_nothing_is_known() {
        use GatewayState::*;
        for state in [TakeOff, Approach, Land, SafeApproach, SafeLand, Manual, Stop, Off] {
            let mut watch = Watch::default();
            for now_s in [0.0, 100.0] {
                assert!(
                    look_in(&mut watch, 310.0, &ahead(1, 500.0), &Hill, now_s, state).is_empty(),
                    "{state:?}"
                );
            }
        }
        struct Unknown;
        impl Terrain for Unknown {
            fn elevation_m(&self, _: LatLon) -> Option<f64> {
                None
            }
        }
        let mut watch = Watch::default();
        look(&mut watch, 500.0, &ahead(1, 500.0), &Hill, 0.0);
        let known = watch.agl_m;
        watch.look(UNSEEN, &Hill, 1.0);
        assert!(known.is_some() && watch.agl_m == known, "the last one, as old as it is");
        for now_s in [0.0, 100.0] {
            assert!(look(&mut watch, 500.0, &ahead(1, 500.0), &Unknown, now_s).is_empty());
        }
        assert_eq!(watch.agl_m, None);
    }
}
