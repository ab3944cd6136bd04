//! The ways on from forks, leg by leg, whichever of them the flight takes; and where the path comes from to a leg.

use super::calls::Calls;
use super::{Line, Reader};
use crate::forecast::{Forecast, Point};
use flight_plan::{Area, Id, Leg, LegContext, LegKind, Pattern, Section};
use geometry::{LatLon, LocalFrame};
use std::collections::HashMap;
use std::sync::Arc;

/// Most ways of a plan that are drawn.
const MOST: usize = 500;
/// Most legs of a way that are drawn.
const LONGEST: usize = 50;
/// Most pieces of a way that are drawn: a leg may be a loop, a route or a call.
const MOST_PIECES: usize = 500;

/// A branch of a fork.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// The fork.
    pub fork: Id,
    /// What people read.
    pub label: String,
    /// It is taken without a decision.
    pub is_default: bool,
    /// From where the path arrives at the fork to where the way leads back, each piece with the leg that goes along it.
    pub lines: Vec<Line>,
    /// The leg before the fork, if it covers an area or goes around a place: only the flight says where that is left.
    behind: Option<Id>,
    /// Corridors on the way: only the flight says at which end they are begun and left.
    corridors: Vec<Id>,
    /// What goes around a place on the way: only the flight says where that is begun and left.
    rounds: Vec<Round>,
}

impl Way {
    /// As the flight goes, where it takes this way: behind an area or an orbit it begins where that is left, it leads to where an orbit is
    /// begun, and along a corridor it goes the way that is flown.
    pub(super) fn follow(&mut self, forecast: &Forecast) {
        self.begin(forecast);
        for corridor in self.corridors.clone() {
            self.go_along(&corridor, forecast);
        }
        for round in self.rounds.clone() {
            self.go_round(&round, forecast);
        }
    }

    fn go_round(&mut self, round: &Round, forecast: &Forecast) {
        let Some(index) = self.lines.iter().position(|line| line.leg == round.leg) else { return };
        let on_it = |point: &&Point| round.centre.distance_m(point.position) <= round.radius_m * ON_RIM;
        let begun = forecast.passages_of(&round.leg).next().and_then(|flown| flown.iter().find(on_it));
        let Some((begun, left)) = begun.zip(forecast.end_of(&round.leg)) else { return };
        if let Some(line) = self.lines.get_mut(index) {
            line.to = begun.position;
        }
        if let Some(line) = self.lines.get_mut(index + 1) {
            line.from = left.from;
        }
    }

    fn go_along(&mut self, corridor: &Id, forecast: &Forecast) {
        let Some(flown) = forecast.passages_of(corridor).next() else { return };
        let mut along: Vec<LatLon> =
            self.lines.iter().filter(|line| line.leg == *corridor).map(|line| line.to).collect();
        let when = |place: Option<&LatLon>| {
            let far_m = |point: &Point| place.map_or(0.0, |place| place.distance_m(point.position));
            let nearest = flown.iter().min_by(|a, b| far_m(a).total_cmp(&far_m(b)));
            nearest.map_or(0.0, |point| point.time_s)
        };
        if when(along.first()) > when(along.last()) {
            along.reverse();
        }
        let mut at = None;
        for line in &mut self.lines {
            match line.leg == *corridor {
                true if !along.is_empty() => {
                    line.from = at.unwrap_or(line.from);
                    line.to = along.remove(0);
                    at = Some(line.to);
                }
                // between tracks it may come back to the end at which it began
                _ => line.from = at.take().and(flown.last()).map_or(line.from, |point| point.position),
            }
        }
    }

    /// Behind an area, or what goes around a place, it begins where the flight leaves that.
    fn begin(&mut self, forecast: &Forecast) {
        let left = self.behind.as_ref().and_then(|leg| forecast.end_of(leg));
        if let Some((first, left)) = self.lines.first_mut().zip(left) {
            first.from = left.from;
        }
    }

    /// Its places, one after the other.
    pub fn places(&self) -> impl Iterator<Item = LatLon> {
        self.lines.first().map(|line| line.from).into_iter().chain(self.lines.iter().map(|line| line.to))
    }
}

/// Where the path comes from to each leg.
#[derive(Default)]
pub(super) struct Arrivals<'a> {
    /// To legs that other legs name as what follows them.
    named: HashMap<&'a Id, LatLon>,
    /// To legs that fly nothing themselves: the path goes on from there.
    passed: HashMap<&'a Id, LatLon>,
    /// Where the last leg before in the document ends.
    last: Option<LatLon>,
}

impl<'a> Arrivals<'a> {
    /// Takes the next leg of the document, and gives where the path comes from to it; `None`: that is not known.
    pub(super) fn take(&mut self, context: &LegContext<'a>, reader: &Reader<'_>) -> Option<LatLon> {
        let leg = context.leg;
        let before = context.index.checked_sub(1).and_then(|index| context.siblings.get(index));
        let from = match before.filter(|before| before.falls_through()) {
            Some(before) => match before.as_fork() {
                Some(fork) if fork.branches.is_empty() => None,
                Some(_) => self.passed.get(&before.id).copied(),
                None => last_place(before, reader),
            },
            None => self.named.get(&leg.id).copied(),
        };
        let near = from.or(self.last);
        let own = last_place(leg, reader);
        if let Some(near) = near.filter(|_| own.is_none() || !leg.body().is_empty()) {
            self.passed.insert(&leg.id, near);
        }
        let end = own.or(near);
        if let Some(end) = end {
            let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches).iter();
            let named = branches.filter_map(|branch| branch.next.as_ref()).chain(&leg.next);
            named.for_each(|next| _ = self.named.entry(next).or_insert(end));
        }
        // what is inside a loop comes next, and begins where that does
        self.last = if leg.body().is_empty() { end } else { near };
        from
    }

    /// Where the path arrives at a leg that flies nothing itself.
    fn at(&self, leg: &Id) -> Option<LatLon> {
        self.passed.get(leg).copied()
    }
}

/// All of a plan.
pub(super) fn of(arrivals: &Arrivals<'_>, reader: &Reader<'_>) -> Vec<Way> {
    let mut ways = Vec::new();
    let mut calls = Calls::of(reader.plan);
    for context in reader.plan.all_legs() {
        let Some(fork) = context.leg.as_fork().filter(|fork| fork.branches.len() > 1) else { continue };
        let Some(from) = arrivals.at(&context.leg.id) else { continue };
        let heads: Vec<&Id> = fork.branches.iter().filter_map(|branch| branch.next.as_ref()).collect();
        for branch in fork.branches {
            let (lines, corridors, rounds) = (Vec::new(), Vec::new(), Vec::new());
            let mut trace = Trace { reader, calls: &mut calls, at: from, lines, corridors, rounds };
            let next = branch.next.clone().or_else(|| after(&context));
            if let (End::OfList, Some(to)) =
                (trace.way(context.siblings, next, &heads), behind(&context, reader))
            {
                trace.to(to, &context.leg.id);
            }
            let label = if branch.label.is_empty() { branch.id.to_string() } else { branch.label.clone() };
            let is_default = fork.default == Some(&branch.id);
            let Trace { mut lines, corridors, rounds, .. } = trace;
            if let (Some(round), Some(first)) =
                (before(&context).and_then(|leg| Round::of(leg, reader)), lines.first_mut())
            {
                first.from = round.towards(first.to);
            }
            let (fork, behind) = (context.leg.id.clone(), wide_before(&context));
            ways.push(Way { fork, label, is_default, lines, behind, corridors, rounds });
        }
        if ways.len() >= MOST {
            break;
        }
    }
    ways
}

fn after(context: &LegContext<'_>) -> Option<Id> {
    context.siblings.get(context.index + 1).map(|leg| leg.id.clone())
}

/// The leg that the fork is behind.
fn before<'a>(context: &LegContext<'a>) -> Option<&'a Leg> {
    let before = context.siblings.get(context.index.checked_sub(1)?)?;
    before.falls_through().then_some(before.as_ref())
}

/// That, if it is not left at its place: it covers an area, goes around a place, is flown from either end, or is a procedure's.
fn wide_before(context: &LegContext<'_>) -> Option<Id> {
    let is_wide = |leg: &&Leg| {
        let is_hold = matches!(leg.kind, LegKind::Hf(_) | LegKind::Ha(_) | LegKind::Hm { .. });
        let is_other = is_corridor(leg) || matches!(leg.kind, LegKind::Call(_));
        is_hold || is_other || leg.area().is_some() || super::round(leg).is_some()
    };
    before(context).filter(is_wide).map(|leg| leg.id.clone())
}

/// An orbit is flown on its rim, and that is not met at its middle.
#[derive(Debug, Clone, PartialEq)]
struct Round {
    leg: Id,
    centre: LatLon,
    radius_m: f64,
}

/// What is so far from the middle is on the rim, as a share of the radius.
const ON_RIM: f64 = 1.05;

impl Round {
    /// `None`: it is no orbit, or nobody knows where.
    fn of(leg: &Leg, reader: &Reader<'_>) -> Option<Self> {
        let LegKind::Orbit { centre, radius_m, .. } = &leg.kind else { return None };
        let (centre, radius_m) = (reader.place(centre)?, reader.number(radius_m)?);
        let can_be_flown = radius_m.is_finite() && radius_m > 0.0;
        can_be_flown.then(|| Self { leg: leg.id.clone(), centre, radius_m })
    }

    /// The place of the rim that is nearest to this one.
    fn towards(&self, at: LatLon) -> LatLon {
        self.centre.destination(self.centre.bearing_deg(at), self.radius_m)
    }
}

/// Where the flight goes on behind the list of a stage: to the next one, or to its runway.
fn behind(context: &LegContext<'_>, reader: &Reader<'_>) -> Option<LatLon> {
    let stages = match context.section {
        _ if !context.loops.is_empty() => return None,
        Section::Main => &reader.plan.stages,
        Section::Emergency(plan) => &plan.stages,
    };
    let next = stages.iter().skip_while(|stage| stage.id != context.stage.id).nth(1)?;
    let first = next.legs.iter().find_map(|leg| places(leg.first_flown(), reader).first().copied());
    let runway = || reader.plan.runway(next.runway.as_ref()?).map(|runway| runway.threshold);
    first.or_else(runway)
}

/// How far a way was followed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    /// To the end of its list.
    OfList,
    /// To where another way leads, too, or something else is said about what follows.
    Within,
}

/// A way as far as it was followed.
struct Trace<'a, 'p> {
    reader: &'a Reader<'p>,
    calls: &'a mut Calls<'p>,
    at: LatLon,
    lines: Vec<Line>,
    corridors: Vec<Id>,
    rounds: Vec<Round>,
}

impl Trace<'_, '_> {
    /// Leg by leg, until another way is met or something is said about what follows.
    fn way(&mut self, list: &[Arc<Leg>], mut next: Option<Id>, heads: &[&Id]) -> End {
        for step in 0..LONGEST {
            let Some(id) = next else { return End::OfList };
            let Some((index, leg)) = list.iter().enumerate().find(|(_, leg)| leg.id == id) else {
                return End::Within;
            };
            if step > 0 && heads.contains(&&leg.id) {
                // where ways only meet, what is behind says where that is
                let meets = leg.next.is_none() && leg.as_fork().is_some_and(|fork| fork.branches.is_empty());
                let met = if meets { list.get(index + 1) } else { Some(leg) };
                return met.map_or(End::OfList, |met| {
                    self.first(met);
                    End::Within
                });
            }
            if leg.as_fork().is_some_and(|fork| !fork.branches.is_empty()) {
                return End::Within;
            }
            self.leg(leg, &leg.id);
            if let Some(target) = &leg.next {
                let target = list.iter().find(|leg| leg.id == *target);
                target.into_iter().for_each(|target| self.first(target));
                return End::Within;
            }
            next = list.get(index + 1).map(|leg| leg.id.clone());
        }
        End::Within
    }

    /// Only to where a leg begins.
    fn first(&mut self, leg: &Leg) {
        let first = leg.first_flown();
        let called = self.calls.body(first).first().cloned();
        let first = called.as_deref().map_or(first, Leg::first_flown);
        self.places(first).into_iter().take(1).for_each(|to| self.to(to, &leg.id));
    }

    /// All of a leg, as a leg of the document: what a procedure flies is the call's.
    fn leg(&mut self, leg: &Leg, written: &Id) {
        let called = self.calls.body(leg);
        if !called.is_empty() {
            return called.iter().for_each(|inner| self.leg(inner, written));
        }
        for inner in leg.body() {
            let is_written = leg.id == *written;
            self.leg(inner, if is_written { &inner.id } else { written });
        }
        if is_corridor(leg) && leg.id == *written && !self.corridors.contains(written) {
            self.corridors.push(written.clone());
        }
        self.rounds.extend(Round::of(leg, self.reader).filter(|round| round.leg == *written));
        self.places(leg).into_iter().for_each(|to| self.to(to, written));
    }

    /// As [`places`]; of an outline the corner that is nearest to where the way has come, of an orbit the place on its rim, and a corridor
    /// from its nearer end.
    fn places(&self, leg: &Leg) -> Vec<LatLon> {
        if let Some(round) = Round::of(leg, self.reader) {
            return vec![round.towards(self.at)];
        }
        let far = |corner: &LatLon| corner.distance_m(self.at);
        match leg.area() {
            Some(Area::Polygon { corners, .. }) => {
                corners.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).into_iter().collect()
            }
            _ => {
                let mut along = places(leg, self.reader);
                let ends = along.first().map(far).zip(along.last().map(far));
                if is_corridor(leg) && ends.is_some_and(|(first_m, last_m)| last_m < first_m) {
                    along.reverse();
                }
                along
            }
        }
    }

    fn to(&mut self, to: LatLon, leg: &Id) {
        let from = std::mem::replace(&mut self.at, to);
        if self.lines.len() < MOST_PIECES {
            self.lines.push(Line { leg: leg.clone(), from, to });
        }
    }
}

/// The places that a leg leads over: of an area its middle.
pub(super) fn places(leg: &Leg, reader: &Reader<'_>) -> Vec<LatLon> {
    if let LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) = &leg.kind {
        return route.iter().filter_map(|place| reader.place(place)).collect();
    }
    let place = match leg.area() {
        None => reader.place_of(leg),
        Some(Area::Circle { centre, .. }) => reader.place(centre),
        Some(Area::Polygon { corners, .. }) => middle(corners),
        Some(Area::Expression(source)) => reader.polygon(source).and_then(|ring| middle(&ring)),
    };
    place.into_iter().collect()
}

/// It is begun at the end that is nearer to where the path comes from.
fn is_corridor(leg: &Leg) -> bool {
    matches!(leg.kind, LegKind::Pattern(Pattern::Corridor { .. }))
}

fn middle(ring: &[LatLon]) -> Option<LatLon> {
    LocalFrame::around(ring).map(|frame| frame.origin())
}

fn last_place(leg: &Leg, reader: &Reader<'_>) -> Option<LatLon> {
    let inside = leg.body().iter().rev().find_map(|leg| last_place(leg, reader));
    inside.or_else(|| places(leg, reader).pop())
}

#[cfg(test)]
mod tests {
    use super::super::Sketch;
    use super::*;
    use crate::forecast::Passage;
    use flight_plan::Variables;

    const PLAN: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer">
        <procedures><procedure id="look" reference="46.9 9.0"><TF id="p1" lat="46.9" lon="9.0"/></procedure></procedures><mainPlan>
        <stage id="m" type="mission"><scan id="s" spacing="300"><area>
          <corner lat="46.0" lon="9.0"/><corner lat="46.0" lon="9.02"/><corner lat="46.02" lon="9.02"/><corner lat="46.02" lon="9.0"/></area></scan>
          <intersection id="f" default="on"><branch id="on"/><branch id="skip" next="merge"/></intersection>
          <TF id="n" lat="46.1" lon="9.0"/><call id="c" procedure="look"/><intersection id="merge"/></stage>
        <stage id="a" type="arrival"><DF id="home" lat="46.2" lon="9.1"/></stage></mainPlan></flightPlan>"#;

    fn sketch() -> Sketch {
        let reading = flight_plan::read(PLAN);
        assert!(!reading.has_errors(), "{:?}", reading.problems);
        Sketch::new(&reading.plan, &Variables::initial(&reading.plan), &Sketch::default())
    }

    #[test]
    fn a_way_that_ends_its_stage_leads_to_the_next_one() {
        let sketch = sketch();
        let ends: Vec<_> =
            sketch.ways.iter().map(|way| (way.label.as_str(), way.lines.last().unwrap().to)).collect();
        let home = LatLon::new(46.2, 9.1);
        assert_eq!(ends, [("on", home), ("skip", home)]);
    }

    #[test]
    fn a_way_behind_an_area_begins_where_the_flight_leaves_that() {
        let mut sketch = sketch();
        let points = [(46.0, 0.0), (46.02, 1.0)].map(|(lat, time_s)| at_time(LatLon::new(lat, 9.0), time_s));
        let (points, scanned) = (points.to_vec(), passage("s", 1));
        sketch.begin_ways(&Forecast { points, passages: vec![scanned], ..Forecast::default() });
        assert!(sketch.ways.iter().all(|way| way.lines[0].from == LatLon::new(46.02, 9.0)));
    }

    /// It was drawn from the last point of the line, and from where the call names its place, wherever the flight ended.
    #[test]
    fn a_way_behind_a_corridor_or_a_call_begins_where_the_flight_leaves_that() {
        let corridor = r#"<corridor id="c" width="400" spacing="400"><route><point lat="46" lon="9"/><point lat="46.04" lon="9"/></route></corridor>"#;
        let call = r#"<call id="c" procedure="look" lat="46.0" lon="9.0"/>"#;
        let procedures = r#"<procedures><procedure id="look" reference="46.0 9.0"><TF id="up" lat="46.01" lon="9"/></procedure></procedures>"#;
        for (leg, flown) in [(corridor, "c"), (call, "c.up")] {
            let plan = format!(
                r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer">{procedures}<mainPlan><stage id="m" type="mission">{leg}
              <intersection id="f" default="on"><branch id="on" next="x"/><branch id="no" next="home"/></intersection>
              <TF id="x" lat="46.1" lon="9.1"/><TF id="home" lat="46.2" lon="9.1"/></stage></mainPlan></flightPlan>"#
            );
            let reading = flight_plan::read(plan);
            assert!(!reading.has_errors(), "{:?}", reading.problems);
            let mut sketch =
                Sketch::new(&reading.plan, &Variables::initial(&reading.plan), &Sketch::default());
            let left = LatLon::new(46.001, 9.002);
            let points = [(LatLon::new(46.04, 9.0), 0.0), (left, 1.0)].map(|(at, s)| at_time(at, s)).to_vec();
            sketch.begin_ways(&Forecast { points, passages: vec![passage(flown, 1)], ..Forecast::default() });
            assert!(
                !sketch.ways.is_empty() && sketch.ways.iter().all(|way| way.lines[0].from == left),
                "{leg}"
            );
        }
    }

    /// It was drawn from the middle of the orbit, and to it.
    #[test]
    fn a_way_leads_from_and_to_the_rim_of_an_orbit_where_the_flight_leaves_and_meets_it() {
        let plan = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan><stage id="m" type="mission">
              <orbit id="o" radius="300" turns="1" turn="left"><centre lat="46" lon="9"/></orbit>
              <intersection id="f" default="on"><branch id="on" next="p"/><branch id="no" next="home"/></intersection>
              <orbit id="p" radius="200" turns="1" turn="left"><centre lat="46.1" lon="9"/></orbit><TF id="home" lat="46.2" lon="9"/></stage></mainPlan></flightPlan>"#;
        let reading = flight_plan::read(plan);
        assert!(!reading.has_errors(), "{:?}", reading.problems);
        let mut sketch = Sketch::new(&reading.plan, &Variables::initial(&reading.plan), &Sketch::default());
        let [o, p, home] = [46.0, 46.1, 46.2].map(|lat| LatLon::new(lat, 9.0));
        let is_at =
            |at: LatLon, expected: LatLon| assert!(at.distance_m(expected) < 1.0, "{at:?} {expected:?}");
        let ends = |sketch: &Sketch, way: usize, line: usize| {
            let line = &sketch.ways[way].lines[line];
            (line.from, line.to)
        };
        is_at(ends(&sketch, 0, 0).0, o.destination(0.0, 300.0));
        is_at(ends(&sketch, 0, 0).1, p.destination(180.0, 200.0));
        is_at(ends(&sketch, 1, 0).0, o.destination(0.0, 300.0));
        let places = [
            o.destination(90.0, 300.0),
            p.destination(180.0, 600.0),
            p.destination(90.0, 200.0),
            p.destination(270.0, 200.0),
        ];
        let points = places.iter().zip([0.0, 1.0, 2.0, 3.0]).map(|(at, time_s)| at_time(*at, time_s));
        let passages = vec![passage("o", 0), Passage { first: 1, ..passage("p", 3) }];
        sketch.begin_ways(&Forecast { points: points.collect(), passages, ..Forecast::default() });
        is_at(ends(&sketch, 0, 0).0, places[0]);
        is_at(ends(&sketch, 0, 0).1, places[2]);
        assert_eq!(ends(&sketch, 0, 1), (places[3], home));
        is_at(ends(&sketch, 1, 0).0, places[0]);
    }

    /// The fork is nearer to the corridor's end, and the flight begins and leaves it there.
    #[test]
    fn a_way_along_a_corridor_goes_as_that_is_flown() {
        let (south, middle, north) =
            (LatLon::new(46.0, 9.0), LatLon::new(46.02, 9.0), LatLon::new(46.04, 9.0));
        let home = LatLon::new(46.1, 9.1);
        let plan = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan><stage id="m" type="mission">
              <TF id="b" lat="46.06" lon="9.0"/><intersection id="f" default="on"><branch id="on" next="c"/><branch id="no" next="home"/></intersection>
              <corridor id="c" width="400" spacing="200"><route>{}</route></corridor><DF id="home" lat="46.1" lon="9.1"/></stage></mainPlan></flightPlan>"#,
            [south, middle, north]
                .map(|at| format!(r#"<point lat="{}" lon="{}"/>"#, at.lat_deg, at.lon_deg))
                .concat()
        );
        let reading = flight_plan::read(plan);
        let mut sketch = Sketch::new(&reading.plan, &Variables::initial(&reading.plan), &Sketch::default());
        let along = |sketch: &Sketch| sketch.ways[0].lines.iter().map(|line| line.to).collect::<Vec<_>>();
        assert_eq!(along(&sketch), [north, middle, south, home], "the nearer end first");
        let flown = |places: [LatLon; 3]| {
            let points = places.iter().zip([0.0, 1.0, 2.0]).map(|(at, time_s)| at_time(*at, time_s));
            let passages = vec![passage("c", 3)];
            Forecast { points: points.collect(), passages, ..Forecast::default() }
        };
        sketch.begin_ways(&flown([north, south, north]));
        assert_eq!(along(&sketch), [north, middle, south, home]);
        assert_eq!(sketch.ways[0].lines.last().unwrap().from, north, "it is left where it was begun");
        sketch.begin_ways(&flown([south, middle, north]));
        assert_eq!(along(&sketch), [south, middle, north, home]);
        assert_eq!(sketch.ways[0].lines.last().unwrap().from, north);
    }

    fn at_time(position: LatLon, time_s: f64) -> Point {
        let (distance_m, altitude_amsl_m, ground_amsl_m, passage) = (0.0, 500.0, None, 0);
        Point { time_s, distance_m, position, altitude_amsl_m, ground_amsl_m, passage }
    }

    fn passage(leg: &str, end: usize) -> Passage {
        Passage {
            leg: leg.into(),
            stage: "m".into(),
            passes: Vec::new(),
            reverse: false,
            first: 0,
            end,
            energy_left: 1.0,
            clearance_m: None,
        }
    }

    #[test]
    fn what_procedures_lead_over_is_among_the_places() {
        assert!(sketch().places().contains(&LatLon::new(46.9, 9.0)));
    }
}
