//! A preview that goes on from the one before is the preview that begins anew.
#![cfg(test)]

use aircraft::{Profile, Wind};
use flight_exec::rehearse::{Options, Rehearsal, Scenario, Start};
use flight_exec::{Event, Preview, PreviewError, preview};
use flight_plan::{Program, compile_document};
use geometry::LatLon;
use proptest::prelude::*;
use std::sync::Arc;
use terrain::{Flat, Terrain};

/// One leg of a plan, as a few numbers.
#[derive(Debug, Clone)]
struct Leg {
    id: usize,
    kind: u8,
    /// From the leg before it: degrees and metres.
    turn_deg: f64,
    length_m: f64,
    /// What else it may have.
    extra: u8,
}

/// What is done to a plan.
#[derive(Debug, Clone)]
enum Edit {
    Move(usize, f64),
    Change(usize, u8),
    Insert(usize, Leg),
    Remove(usize),
}

fn leg() -> impl Strategy<Value = Leg> {
    (0..12_u8, -100.0..100.0_f64, 250.0..900.0_f64, 0..8_u8)
        .prop_map(|(kind, turn_deg, length_m, extra)| Leg { id: 0, kind, turn_deg, length_m, extra })
}

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        3 => (any::<usize>(), 1.0..300.0_f64).prop_map(|(n, m)| Edit::Move(n, m)),
        1 => (any::<usize>(), 0..8_u8).prop_map(|(n, extra)| Edit::Change(n, extra)),
        1 => (any::<usize>(), leg()).prop_map(|(n, leg)| Edit::Insert(n, leg)),
        1 => any::<usize>().prop_map(Edit::Remove),
    ]
}

/// The end of a flight and the beginning of another one, between legs.
const BETWEEN: &str = r#"</stage><stage id="land1" type="land" runway="R" turnaroundEnergy="0.8" turnaroundTime="300"/>
    <stage id="to2" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
    <stage id="m2" type="mission" altitude="250" altitudeReference="agl"><TF id="first2" fix="S"/>"#;

/// A plan, and where its fixes are.
#[derive(Debug, Clone)]
struct Plan {
    legs: Vec<Leg>,
    at: Vec<(usize, LatLon)>,
    next_id: usize,
    conditions: bool,
    /// In two flights: it lands half-way.
    twice: bool,
}

impl Plan {
    fn new(legs: Vec<Leg>, conditions: bool) -> Self {
        let mut plan = Self { legs: Vec::new(), at: Vec::new(), next_id: 0, conditions, twice: false };
        let (mut at, mut course_deg) = (LatLon::new(36.52, -84.18), 0.0);
        for leg in legs {
            course_deg += leg.turn_deg;
            at = at.destination(course_deg, leg.length_m);
            plan.put(plan.legs.len(), leg, at);
        }
        plan
    }

    fn put(&mut self, index: usize, leg: Leg, at: LatLon) {
        self.legs.insert(index, Leg { id: self.next_id, ..leg });
        self.at.push((self.next_id, at));
        self.next_id += 1;
    }

    fn position(&self, id: usize) -> LatLon {
        self.at.iter().find(|(n, _)| *n == id).unwrap().1
    }

    fn apply(&mut self, edit: &Edit) {
        let count = self.legs.len();
        match edit {
            Edit::Move(n, metres) => {
                let id = self.legs[n % count].id;
                let fix = self.at.iter_mut().find(|(other, _)| *other == id).unwrap();
                fix.1 = fix.1.destination(*metres, *metres);
            }
            Edit::Change(n, extra) => self.legs[n % count].extra = *extra,
            Edit::Insert(n, leg) => {
                let near = self.position(self.legs[n % count].id);
                self.put(n % count, leg.clone(), near.destination(leg.turn_deg, leg.length_m));
            }
            Edit::Remove(n) => {
                if count > 4 {
                    self.legs.remove(n % count);
                }
            }
        }
    }

    fn program(&self) -> Result<Arc<Program>, String> {
        let fix = |name: char, id: &usize, p: LatLon| {
            format!(r#"<fix id="{name}{id}" lat="{}" lon="{}"/>"#, p.lat_deg, p.lon_deg)
        };
        let at = self.at.iter();
        let fixes: String =
            at.map(|(id, p)| fix('F', id, *p) + &fix('G', id, p.destination(20.0, 500.0))).collect();
        let mut legs: Vec<String> = self.legs.iter().map(|leg| leg.xml(self.conditions)).collect();
        if self.twice {
            legs.insert(legs.len() / 2, BETWEEN.into());
        }
        let legs: String = legs.concat();
        let text = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="edited" aircraft="trainer"><fixes><fix id="S" lat="36.52" lon="-84.18"/>{fixes}</fixes>
            <runways><runway id="R" lat="36.5" lon="-84.2" elevation="300" heading="90" length="600" priority="1"/></runways>
            <variables><variable name="n" type="number" initial="0"/></variables>
            <mainPlan><stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
              <stage id="m" type="mission" altitude="250" altitudeReference="agl"><TF id="first" fix="S"/>{legs}</stage>
              <stage id="land" type="land" runway="R"/></mainPlan></flightPlan>"#,
        );
        let program = compile_document(text.as_bytes(), &tireless(), &Flat(300.0));
        program
            .map(Arc::new)
            .map_err(|problems| problems.iter().filter(|p| p.is_error()).map(|p| format!("{p}\n")).collect())
    }
}

impl Leg {
    fn xml(&self, conditions: bool) -> String {
        let (id, fix) = (self.id, format!("F{}", self.id));
        let attributes = match self.extra {
            0 => r#" altitude="300" altitudeReference="agl""#.into(),
            1 => r#" speed="22""#.into(),
            2 => r#" flyOver="true""#.into(),
            _ => String::new(),
        };
        let actions = match self.extra {
            3 => r#"<action on="start"><set variable="n" to="= n + 1.0"/></action>"#,
            4 => r#"<action every="120"><photo/></action>"#,
            5 => r#"<action on="end"><wait seconds="20"/></action>"#,
            _ => "",
        };
        let until = if conditions { r#" until="battery &lt; 0.2""# } else { "" };
        match self.kind {
            0 => format!(
                r#"<orbit id="l{id}" radius="200" turns="1" turn="left"><centre fix="{fix}"/></orbit>"#
            ),
            1 => format!(
                r#"<scan id="l{id}" spacing="120" heading="0"><area fix="{fix}" radius="250"/></scan>"#
            ),
            2 => format!(
                r#"<iterative id="l{id}" form="forward" count="{}"{until}><TF id="a{id}" fix="{fix}"{attributes}>{actions}</TF><TF id="b{id}" fix="G{id}"/></iterative>"#,
                1 + self.extra % 3
            ),
            3 => format!(
                r#"<intersection id="l{id}" default="on" decideBefore="10s"><branch id="on" label="On"/><branch id="by" label="By" when="n &gt; {}.0"/></intersection>"#,
                self.extra
            ),
            4 => format!(
                r#"<HM id="l{id}" fix="{fix}" course="{}" turn="right" length="400" maxLaps="1"/>"#,
                self.extra
            ),
            5 => format!(r#"<DF id="l{id}" fix="{fix}"{attributes}>{actions}</DF>"#),
            6 => format!(
                r#"<iterative id="l{id}" form="reverse" count="2"><TF id="a{id}" fix="{fix}"/><TF id="b{id}" fix="G{id}"/></iterative>"#
            ),
            _ => format!(r#"<TF id="l{id}" fix="{fix}"{attributes}>{actions}</TF>"#),
        }
    }
}

fn tireless() -> Profile {
    Profile { energy_j: 3e7, ..Profile::default() }
}

fn wind() -> Wind {
    Wind::from_direction(250.0, 4.0)
}

fn ground() -> Arc<dyn Terrain> {
    Arc::new(Flat(300.0))
}

/// The same flight: to the bit, but for sums over the way and the name of the plan.
fn same(kept: &Preview, fresh: &Preview) -> Result<(), TestCaseError> {
    // each of the terms of a sum is rounded to 2⁻⁵³ of it
    let terms = (fresh.time_s / 0.02 + 100.0) * 2.0;
    let near = |a: f64, b: f64, most: f64| (a - b).abs() <= terms * most * f64::EPSILON;
    prop_assert_eq!(&kept.waypoints, &fresh.waypoints);
    prop_assert_eq!(&kept.track, &fresh.track);
    prop_assert_eq!((kept.time_s, kept.landed), (fresh.time_s, fresh.landed));
    prop_assert!(near(kept.distance_m, fresh.distance_m, 1e6) && near(kept.energy_j, fresh.energy_j, 3e7));
    prop_assert_eq!(kept.legs.len(), fresh.legs.len());
    for (a, b) in kept.legs.iter().zip(&fresh.legs) {
        let alike = near(a.distance_m, b.distance_m, 1e6) && near(a.energy_j, b.energy_j, 3e7);
        prop_assert!(alike, "{a:?} instead of {b:?}");
        let b =
            flight_exec::rehearse::LegPassage { distance_m: a.distance_m, energy_j: a.energy_j, ..b.clone() };
        prop_assert_eq!(a, &b);
    }
    let told = |flown: &Preview| -> Vec<_> {
        flown
            .events
            .iter()
            .filter(|(_, e)| !matches!(e, Event::PlanActivated { .. }))
            .cloned()
            .map(blunt)
            .collect()
    };
    prop_assert_eq!(told(kept), told(fresh));
    prop_assert_eq!(&kept.refusals, &fresh.refusals);
    prop_assert_eq!(&kept.stops, &fresh.stops);
    Ok(())
}

/// An event without sums over the way.
fn blunt((time_s, mut event): (f64, Event)) -> (f64, Event) {
    if let Event::DecisionRequested(request) = &mut event {
        request.distance_left_m = request.distance_left_m.round();
        request.time_left_s = request.time_left_s.round();
    }
    (time_s, event)
}

fn options() -> Options {
    Options { step_s: 0.2, ..Options::default() }
}

fn fresh(program: &Arc<Program>, options: &Options) -> Result<Preview, PreviewError> {
    preview(program, &tireless(), &ground(), wind(), Start::Runway, &Scenario::default(), options)
}

fn rehearsal(options: &Options) -> Rehearsal {
    Rehearsal::new(tireless(), ground(), wind(), options.clone())
}

fn cases(most: u32) -> ProptestConfig {
    let config = ProptestConfig::default();
    ProptestConfig { cases: config.cases.min(most.max(config.cases / 10)), ..config }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn after_any_edits_it_is_the_preview_of_the_plan(
        legs in prop::collection::vec(leg(), 4..30),
        edits in prop::collection::vec(edit(), 1..4),
        conditions in prop::bool::weighted(0.2),
    ) {
        let options = options();
        let mut plan = Plan::new(legs, conditions);
        let mut rehearsal = rehearsal(&options);
        let mut flown = 0;
        for edit in [None].into_iter().chain(edits.iter().map(Some)) {
            edit.iter().for_each(|edit| plan.apply(edit));
            let Ok(program) = plan.program() else { continue };
            let outcome = rehearsal.fly(&program, Start::Runway, &mut |_| true);
            match fresh(&program, &options) {
                Ok(fresh) => {
                    prop_assert_eq!(outcome, Ok(()));
                    same(rehearsal.preview().unwrap(), &fresh)?;
                    flown += 1;
                }
                Err(error) => prop_assert_eq!(outcome, Err(error)),
            }
        }
        prop_assume!(flown > 1);
    }
}

fn zigzag(count: usize) -> Plan {
    let leg = |i| Leg {
        id: 0,
        kind: 9,
        turn_deg: if i % 2 == 0 { 70.0 } else { -70.0 },
        length_m: 300.0,
        extra: 7,
    };
    Plan::new((0..count).map(leg).collect(), false)
}

#[test]
fn an_edit_is_flown_and_little_else() {
    let (options, mut plan) = (options(), zigzag(300));
    let mut rehearsal = rehearsal(&options);
    rehearsal.fly(&plan.program().unwrap(), Start::Runway, &mut |_| true).unwrap();
    for edit in [
        Edit::Move(150, 80.0),
        Edit::Remove(100),
        Edit::Insert(200, plan.legs[3].clone()),
        Edit::Change(50, 1),
    ] {
        plan.apply(&edit);
        let program = plan.program().unwrap();
        rehearsal.fly(&program, Start::Runway, &mut |_| true).unwrap();
        let (kept, all) = (rehearsal.kept(), rehearsal.preview().unwrap().track.len());
        same(rehearsal.preview().unwrap(), &fresh(&program, &options).unwrap()).unwrap();
        assert!(kept.head + kept.tail > all * 3 / 4, "{edit:?}: {kept:?} of {all}");
    }
}

/// What is used in one flight is nothing to the next one.
#[test]
fn an_edit_of_one_of_two_flights_leaves_the_other_right() {
    let (options, mut plan) = (options(), Plan { twice: true, ..zigzag(24) });
    let mut rehearsal = rehearsal(&options);
    rehearsal.fly(&plan.program().unwrap(), Start::Runway, &mut |_| true).unwrap();
    for edit in
        [Edit::Move(3, 80.0), Edit::Remove(2), Edit::Move(18, 60.0), Edit::Insert(20, plan.legs[3].clone())]
    {
        plan.apply(&edit);
        let program = plan.program().unwrap();
        rehearsal.fly(&program, Start::Runway, &mut |_| true).unwrap();
        let flown = rehearsal.preview().unwrap();
        same(flown, &fresh(&program, &options).unwrap()).unwrap();
        assert_eq!(flown.stops.len(), 1);
    }
}

/// As long as a plan has no question, nobody looks ahead for one.
#[test]
fn the_first_question_of_a_plan_is_asked_when_a_new_flight_asks_it() {
    let leg = |kind| Leg { id: 0, kind, turn_deg: 0.0, length_m: 250.0, extra: 0 };
    let (options, mut plan) = (options(), Plan::new([0, 0, 7, 4].map(leg).to_vec(), false));
    let mut rehearsal = rehearsal(&options);
    rehearsal.fly(&plan.program().unwrap(), Start::Runway, &mut |_| true).unwrap();
    plan.apply(&Edit::Insert(7681455107611975223, leg(3)));
    let program = plan.program().unwrap();
    rehearsal.fly(&program, Start::Runway, &mut |_| true).unwrap();
    same(rehearsal.preview().unwrap(), &fresh(&program, &options).unwrap()).unwrap();
}
