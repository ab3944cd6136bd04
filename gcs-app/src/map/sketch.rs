//! A plan's places, before anything is flown: what can be dragged, areas, and the lines of emergency
//! plans. Broken drafts give what can be made of them.

mod acts;
mod area;
mod axes;
mod calls;
mod handle;
mod inside;
pub mod numbers;
pub mod photos;
mod placed;
mod radius;
mod reader;
mod ruler;
mod runway;
mod ways;

pub use acts::Acting;
pub use area::AreaPart;
use calls::Calls;
pub use handle::{Handle, Handled};
pub use inside::Inside;
pub use placed::Placed;
pub use radius::{bound_radius, radius_edit};
use reader::Reader;
pub use runway::RunwayEnd;
pub use ways::Way;

use super::view::Mercator;
use crate::forecast::Forecast;
use flight_plan::{
    Area, Env, FlightPlan, FlightState, Id, Leg, LegKind, Pattern, Place, Scan, Section, Value,
    VariableValue, Variables, Zone, ZoneShape,
};
use geometry::LatLon;
use std::collections::{HashMap, HashSet};

/// A circle on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Circle {
    /// Whose.
    pub leg: Id,
    /// Its middle.
    pub centre: LatLon,
    /// Metres.
    pub radius_m: f64,
    /// It is an area to be scanned, not an orbit.
    pub is_area: bool,
}

impl Circle {
    /// Four places around it.
    pub fn rim(&self) -> [LatLon; 4] {
        [0.0, 90.0, 180.0, 270.0].map(|bearing| self.centre.destination(bearing, self.radius_m))
    }
}

/// The straight line of a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The leg that goes along it.
    pub leg: Id,
    /// Where the leg before ends.
    pub from: LatLon,
    /// Where it leads.
    pub to: LatLon,
}

/// Everything of a plan that can be placed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sketch {
    /// What can be dragged.
    pub handles: Vec<Handle>,
    /// Straight legs whose ends are known.
    pub lines: Vec<Line>,
    /// How long each of them is, metres, and where its middle is.
    middles: Vec<(f64, LatLon)>,
    /// Scans and orbits.
    pub circles: Vec<Circle>,
    /// Where they have a handle in their middle.
    centres: HashSet<[u64; 2]>,
    /// Polygons to be scanned: whose, and their rings, the outer one first.
    pub polygons: Vec<(Id, Vec<Vec<LatLon>>)>,
    /// The main plan's places in order, stage by stage.
    pub main: Vec<Vec<LatLon>>,
    /// The same on the map, as one line.
    pub draft: Vec<Mercator>,
    /// Emergency plans, each with its line.
    pub emergencies: Vec<(Id, Vec<LatLon>)>,
    /// Variables that are a place.
    pub variables: Vec<PlacedVariable>,
    /// Variables that are an area, each with its corners.
    pub areas: Vec<(Id, Vec<LatLon>)>,
    /// Ways on from forks.
    pub ways: Vec<Way>,
    /// Procedures where they are defined.
    pub procedures: Vec<Inside>,
    /// What procedures lead over, where they are called.
    called: Vec<LatLon>,
    /// Pictures along legs.
    pub photos: Vec<photos::Photos>,
    /// Where legs end a series of pictures.
    pub photo_ends: HashMap<Id, Vec<photos::Spot>>,
    /// What else is done on the way.
    pub acts: Vec<Acting>,
    /// Handles and lines on the map.
    pub placed: Placed,
}

/// A variable that is a place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedVariable {
    /// Its name.
    pub name: Id,
    /// Where it is now.
    pub at: LatLon,
    /// The radius around it, in metres, where another variable is that.
    pub radius_m: Option<f64>,
}

impl Sketch {
    /// Of a plan whose variables have these values. `former`: what stayed where it was there is not worked out again.
    pub fn new(plan: &FlightPlan, variables: &Variables, former: &Self) -> Self {
        let home = plan.home().or(plan.runways.first()).map_or(LatLon::new(0.0, 0.0), |r| r.threshold);
        let fixes = plan.fixes.iter().rev().map(|fix| (&fix.id, fix.position)).collect();
        let env = Env { variables, flight: FlightState::on_ground(home) };
        let reader = Reader { plan, fixes, env, former };
        let mut sketch = Self {
            variables: placed_variables(plan, variables),
            areas: areas(plan, variables),
            ..Self::default()
        };
        for fix in plan.fixes.iter().filter(|f| f.position.is_valid()) {
            sketch.handles.push(Handle { what: Handled::Fix(fix.id.clone()), at: fix.position });
        }
        let mut arrivals = ways::Arrivals::default();
        for context in plan.all_legs() {
            sketch.add_leg(context.leg, &reader);
            let from = arrivals.take(&context, &reader);
            sketch.add_middle(context.leg, from, &reader);
        }
        plan.zones.iter().for_each(|zone| sketch.add_zone(zone));
        sketch.add_lines(plan, &reader);
        sketch.add_variables();
        sketch.ways = ways::of(&arrivals, &reader);
        sketch.add_called(&reader);
        sketch.handles.extend(runway::handles(&plan.runways));
        plan.procedures.iter().for_each(|procedure| sketch.add_inside(procedure, &reader));
        sketch.placed = Placed::of(&sketch, former);
        sketch
    }

    /// Ways on from forks go as the flight does, where it takes them.
    pub fn begin_ways(&mut self, forecast: &Forecast) {
        self.ways.iter_mut().for_each(|way| way.follow(forecast));
    }

    fn add_leg(&mut self, leg: &Leg, reader: &Reader<'_>) {
        self.handles.extend(numbers::handles(leg, reader));
        self.photos.extend(photos::of(leg, reader));
        self.acts.extend(acts::of(leg, reader));
        let ends = photos::ends(leg, reader);
        if !ends.is_empty() {
            self.photo_ends.insert(leg.id.clone(), ends);
        }
        if let Some(rim) = round(leg) {
            return self.add_circle(leg, rim, reader);
        }
        match &leg.kind {
            LegKind::Scan(Scan { area, .. }) | LegKind::Pattern(Pattern::Contour { area, .. }) => {
                self.add_area(leg, area, reader)
            }
            LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => {
                self.add_route(leg, route, reader)
            }
            _ => leg.place().into_iter().for_each(|place| self.add_waypoint(leg, place, reader)),
        }
    }

    /// What procedures fly where they are called: nothing of it can be dragged there.
    fn add_called(&mut self, reader: &Reader<'_>) {
        let mut calls = Calls::of(reader.plan);
        for context in reader.plan.all_legs() {
            let body = calls.body(context.leg);
            body.iter().for_each(|leg| self.add_flown(&context.leg.id, leg, reader));
        }
    }

    fn add_flown(&mut self, call: &Id, leg: &Leg, reader: &Reader<'_>) {
        self.called.extend(ways::places(leg, reader));
        let rim = round(leg).and_then(|rim| circle(call, rim, leg.area().is_some(), reader));
        self.circles.extend(rim);
        let covered = leg.area().and_then(|area| rings(area, reader));
        self.polygons.extend(covered.map(|rings| (call.clone(), rings)));
        leg.body().iter().for_each(|inner| self.add_flown(call, inner, reader));
    }

    /// The line and the middle of a straight leg, if both of its ends are known.
    fn add_middle(&mut self, leg: &Leg, from: Option<LatLon>, reader: &Reader<'_>) {
        let is_straight = matches!(leg.kind, LegKind::Tf(_) | LegKind::Df { .. });
        let ends = from.zip(reader.place_of(leg)).filter(|_| is_straight);
        let Some((from, to)) = ends else { return };
        let (gap_m, at) = reader.former.middle(self.lines.len(), from, to);
        self.handles.push(Handle { what: Handled::Between { leg: leg.id.clone(), gap_m: gap_m as u32 }, at });
        self.lines.push(Line { leg: leg.id.clone(), from, to });
        self.middles.push((gap_m, at));
    }

    /// How long a line is, metres, and its middle: as it was, if that line had these ends.
    fn middle(&self, line: usize, from: LatLon, to: LatLon) -> (f64, LatLon) {
        let was = self.lines.get(line).filter(|line| (line.from, line.to) == (from, to));
        was.and_then(|_| self.middles.get(line).copied()).unwrap_or_else(|| placed::middle(from, to))
    }

    fn add_zone(&mut self, zone: &Zone) {
        match &zone.shape {
            ZoneShape::Circle { centre, radius_m } if centre.is_valid() && radius_m.is_finite() => {
                self.handles.push(Handle { what: Handled::Centre(zone.id.clone()), at: *centre });
                let rim = centre.destination(90.0, *radius_m);
                self.handles.push(Handle { what: Handled::Radius(zone.id.clone()), at: rim });
            }
            ZoneShape::Circle { .. } => {}
            ZoneShape::Polygon(corners) => self.add_ring(&zone.id, None, corners),
        }
    }

    /// Handles of a closed ring.
    fn add_ring(&mut self, of: &Id, hole: Option<usize>, points: &[LatLon]) {
        for (corner, at) in points.iter().enumerate().filter(|(_, at)| at.is_valid()) {
            let what = Handled::Corner { leg: of.clone(), hole, corner };
            self.handles.push(Handle { what, at: *at });
        }
        let next = points.iter().cycle().skip(1);
        for (index, (from, to)) in points.iter().zip(next).enumerate() {
            self.add_ghost(of, hole, index + 1, *from, *to);
        }
    }

    fn add_ghost(&mut self, of: &Id, hole: Option<usize>, before: usize, from: LatLon, to: LatLon) {
        if from.is_valid() && to.is_valid() {
            let what = Handled::Ghost { leg: of.clone(), hole, before };
            self.handles.push(Handle { what, at: from.interpolate(to, 0.5) });
        }
    }

    /// Its first point moves all of it until it is selected; each other point itself. Where an expression leads is moved there.
    fn add_route(&mut self, leg: &Leg, route: &[Place], reader: &Reader<'_>) {
        for (corner, place) in route.iter().enumerate() {
            match place {
                Place::Position(_) if corner == 0 => self.add_waypoint(leg, place, reader),
                Place::Position(Value::Expression(_)) => {}
                Place::Position(Value::Constant(_)) | Place::Fix(_) => {
                    let at = reader.place(place).filter(|at| at.is_valid());
                    let what = Handled::Corner { leg: leg.id.clone(), hole: None, corner };
                    self.handles.extend(at.map(|at| Handle { what, at }));
                }
            }
        }
        let points: Vec<Option<LatLon>> = route.iter().map(|place| reader.place(place)).collect();
        for (index, ends) in points.windows(2).enumerate() {
            if let [Some(from), Some(to)] = ends {
                self.add_ghost(&leg.id, None, index + 1, *from, *to);
            }
        }
    }

    fn add_area(&mut self, leg: &Leg, area: &Area, reader: &Reader<'_>) {
        let Some(rings) = rings(area, reader) else { return };
        let can_be_dragged = match area {
            Area::Expression(source) => reader.plan.variable(&Id::new(source)).is_some(),
            Area::Polygon { .. } | Area::Circle { .. } => true,
        };
        for (ring, points) in rings.iter().enumerate().filter(|_| can_be_dragged) {
            self.add_ring(&leg.id, ring.checked_sub(1), points);
        }
        self.polygons.push((leg.id.clone(), rings));
    }

    fn add_waypoint(&mut self, leg: &Leg, place: &Place, reader: &Reader<'_>) {
        if matches!(place, Place::Fix(_)) {
            return;
        }
        if let Some(at) = reader.place(place) {
            self.handles.push(Handle { what: Handled::Waypoint(leg.id.clone()), at });
        }
    }

    fn add_circle(&mut self, leg: &Leg, rim: Rim<'_>, reader: &Reader<'_>) {
        let Some(circle) = circle(&leg.id, rim, leg.area().is_some(), reader) else { return };
        let Circle { centre: at, radius_m, .. } = circle;
        self.note_radius(rim, reader);
        // circles around the same place share one handle: the first one's
        if self.centres.insert([at.lat_deg, at.lon_deg].map(f64::to_bits)) {
            self.handles.push(Handle { what: Handled::Centre(leg.id.clone()), at });
        }
        self.handles
            .push(Handle { what: Handled::Radius(leg.id.clone()), at: at.destination(90.0, radius_m) });
        self.circles.push(circle);
    }

    /// A circle around a variable whose radius is made of another variable: that one is the radius of the thing itself.
    fn note_radius(&mut self, (centre, radius_m): Rim<'_>, reader: &Reader<'_>) {
        let (Place::Position(Value::Expression(centre)), Value::Expression(radius)) = (centre, radius_m)
        else {
            return;
        };
        let Some((radius, _)) = bound_radius(radius) else { return };
        let placed = self.variables.iter_mut().find(|variable| variable.name.as_str() == centre.trim());
        if let (Some(variable), Some(VariableValue::Number(metres))) =
            (placed, reader.env.variables.get(&radius))
        {
            variable.radius_m.get_or_insert(*metres);
        }
    }

    fn add_lines(&mut self, plan: &FlightPlan, reader: &Reader<'_>) {
        self.add_lines_of_stages(plan, reader);
        self.draft = self.main.iter().flatten().map(|at| (*at).into()).collect();
    }

    fn add_lines_of_stages(&mut self, plan: &FlightPlan, reader: &Reader<'_>) {
        for (section, stage) in plan.all_stages() {
            let mut line = Vec::new();
            stage.legs.iter().for_each(|leg| reader.line_of(leg, &mut line));
            if let Some(runway) = stage.runway.as_ref().and_then(|id| plan.runway(id)) {
                line.push(runway.threshold);
            }
            match section {
                Section::Main => self.main.push(line),
                Section::Emergency(emergency) => {
                    match self.emergencies.iter_mut().find(|(id, _)| *id == emergency.id) {
                        Some((_, before)) => before.extend(line),
                        None => self.emergencies.push((emergency.id.clone(), line)),
                    }
                }
            }
        }
    }

    /// Where a leg is bound to a variable, its handle moves that too.
    fn add_variables(&mut self) {
        for variable in &self.variables {
            if !self.handles.iter().any(|handle| handle.at == variable.at) {
                self.handles.push(Handle { what: Handled::Variable(variable.name.clone()), at: variable.at });
            }
        }
        self.handles.extend(area::handles(&self.areas));
    }

    /// The middle of what a rim belongs to.
    pub fn centre_of(&self, of: &Id, plan: &FlightPlan) -> Option<LatLon> {
        match plan.zone(of).map(|zone| &zone.shape) {
            Some(ZoneShape::Circle { centre, .. }) => Some(*centre),
            Some(ZoneShape::Polygon(_)) => None,
            None => {
                let inside = self.procedures.iter().flat_map(|inside| &inside.circles);
                let mut circles = self.circles.iter().chain(inside);
                circles.find(|circle| circle.leg == *of).map(|circle| circle.centre)
            }
        }
    }

    /// The circle that a leg covers.
    pub fn circle(&self, leg: &Id) -> Option<&Circle> {
        self.circles.iter().find(|circle| circle.leg == *leg && circle.is_area)
    }

    /// The outline of the area that a leg covers.
    pub fn outline(&self, leg: &Id) -> Option<&[LatLon]> {
        let (_, rings) = self.polygons.iter().find(|(of, _)| of == leg)?;
        rings.first().map(Vec::as_slice)
    }

    /// What a variable is now, if that is a place or an area.
    pub fn value(&self, variable: &Id) -> Option<VariableValue> {
        let place = || self.variables.iter().find(|placed| placed.name == *variable);
        let area = self.area(variable).map(|corners| VariableValue::Polygon(corners.to_vec()));
        area.or_else(|| Some(VariableValue::Position(place()?.at)))
    }

    /// Every place, to fit the map to.
    pub fn places(&self) -> Vec<LatLon> {
        let rims = self.circles.iter().flat_map(Circle::rim);
        let drawn = self.main.iter().flatten().chain(&self.called).copied();
        let areas = self.areas.iter().flat_map(|(_, corners)| corners).copied();
        // a runway that nothing uses may be anywhere
        let handles =
            self.handles_there(None).filter(|(_, handle, _)| !matches!(handle.what, Handled::Runway(..)));
        handles.map(|(_, handle, _)| handle.at).chain(drawn).chain(rims).chain(areas).collect()
    }
}

/// A centre and a radius.
type Rim<'a> = (&'a Place, &'a Value<f64>);

/// Of a leg around a place, or of one that covers a circle.
fn round(leg: &Leg) -> Option<Rim<'_>> {
    match &leg.kind {
        LegKind::Orbit { centre, radius_m, .. }
        | LegKind::Scan(Scan { area: Area::Circle { centre, radius_m }, .. })
        | LegKind::Pattern(
            Pattern::Contour { area: Area::Circle { centre, radius_m }, .. }
            | Pattern::Spiral { centre, outer_radius_m: radius_m, .. }
            | Pattern::ExpandingSquare { centre, radius_m, .. }
            | Pattern::Sector { centre, radius_m, .. }
            | Pattern::FigureEight { centre, radius_m, .. },
        ) => Some((centre, radius_m)),
        _ => None,
    }
}

/// `None`: it can't be placed.
fn circle(leg: &Id, (centre, radius_m): Rim<'_>, is_area: bool, reader: &Reader<'_>) -> Option<Circle> {
    let (centre, radius_m) = (reader.place(centre)?, reader.number(radius_m)?);
    let can_be_drawn = radius_m > 0.0 && radius_m < 1.0e6;
    can_be_drawn.then(|| Circle { leg: leg.clone(), centre, radius_m, is_area })
}

/// The outline of an area with corners, and those of its holes.
fn rings(area: &Area, reader: &Reader<'_>) -> Option<Vec<Vec<LatLon>>> {
    match area {
        Area::Polygon { corners, holes } => {
            Some(std::iter::once(corners.clone()).chain(holes.iter().cloned()).collect())
        }
        Area::Expression(source) => Some(vec![reader.polygon(source)?]),
        Area::Circle { .. } => None,
    }
}

fn placed_variables(plan: &FlightPlan, variables: &Variables) -> Vec<PlacedVariable> {
    let place = |name: &Id| match variables.get(name) {
        Some(VariableValue::Position(at)) if at.is_valid() => Some(*at),
        _ => None,
    };
    let names = plan.variables.iter().map(|variable| &variable.name);
    names
        .filter_map(|name| Some(PlacedVariable { name: name.clone(), at: place(name)?, radius_m: None }))
        .collect()
}

fn areas(plan: &FlightPlan, variables: &Variables) -> Vec<(Id, Vec<LatLon>)> {
    let area = |name: &Id| match variables.get(name) {
        Some(VariableValue::Polygon(corners)) if corners.iter().all(|at| at.is_valid()) => {
            Some(corners.clone())
        }
        _ => None,
    };
    plan.variables.iter().filter_map(|of| Some((of.name.clone(), area(&of.name)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Selection;
    use flight_plan::Edit;

    #[test]
    fn variables_that_are_a_place_have_the_radius_that_goes_with_them() {
        let plan = flight_plan::read(crate::assets::FIRE_WATCH.as_bytes()).plan;
        let mut variables = Variables::initial(&plan);
        let placed = |variables: &Variables| Sketch::new(&plan, variables, &Sketch::default()).variables;
        let fire = LatLon::new(36.25, -84.26);
        let expected =
            |radius_m| [PlacedVariable { name: "fire_centre".into(), at: fire, radius_m: Some(radius_m) }];
        assert_eq!(placed(&variables), expected(350.0));
        variables.set(&plan, &"fire_radius".into(), VariableValue::Number(430.0)).unwrap();
        assert_eq!(placed(&variables), expected(430.0), "as it is in flight");
    }

    #[test]
    fn points_of_a_line_are_corners_also_where_they_are_fixes() {
        let plan = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><fixes><fix id="A" lat="46" lon="9"/></fixes>
            <variables><variable name="fire" type="position" initial="46.2 9.1"/></variables><mainPlan><stage id="m" type="mission">
            <corridor id="strip" width="300" spacing="100"><route><point fix="A"/><point lat="46.1" lon="9"/><point at="= fire"/>
            <point fix="A"/></route></corridor></stage></mainPlan></flightPlan>"#;
        let plan = flight_plan::read(plan).plan;
        let sketch = Sketch::new(&plan, &Variables::initial(&plan), &Sketch::default());
        let corner = |handle: &Handle| match handle.what {
            Handled::Corner { corner, .. } => Some((corner, handle.at)),
            _ => None,
        };
        let corners: Vec<_> = sketch.handles.iter().filter_map(corner).collect();
        let (fix, own) = (LatLon::new(46.0, 9.0), LatLon::new(46.1, 9.0));
        assert_eq!(corners, [(0, fix), (1, own), (3, fix)], "the variable's place is moved by itself");
    }

    #[test]
    fn what_a_call_flies_around_or_covers_is_drawn_where_it_is_called_as_the_calls() {
        let plan = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><procedures>
            <procedure id="look" reference="46 9"><orbit id="o" radius="300" turns="1" turn="left"><centre lat="46" lon="9"/></orbit>
              <scan id="s" spacing="300"><area><corner lat="46" lon="9"/><corner lat="46" lon="9.1"/><corner lat="46.1" lon="9"/></area></scan>
            </procedure></procedures><mainPlan><stage id="m" type="mission">
            <call id="c" procedure="look" lat="46.5" lon="9"/></stage></mainPlan></flightPlan>"#;
        let plan = flight_plan::read(plan).plan;
        let sketch = Sketch::new(&plan, &Variables::initial(&plan), &Sketch::default());
        let [circle] = sketch.circles.as_slice() else { panic!("{:?}", sketch.circles) };
        assert_eq!((circle.leg.as_str(), circle.radius_m.round(), circle.is_area), ("c", 300.0, false));
        assert!(circle.centre.distance_m(LatLon::new(46.5, 9.0)) < 1.0);
        let [(leg, rings)] = sketch.polygons.as_slice() else { panic!("{:?}", sketch.polygons) };
        assert_eq!((leg.as_str(), rings[0].len()), ("c", 3));
        let draggable = |selected: Option<&Selection>| {
            let outlines = sketch
                .handles_there(selected)
                .filter(|(_, h, _)| matches!(h.what, Handled::Radius(_) | Handled::Corner { .. }))
                .map(|(_, handle, _)| handle.at);
            outlines.collect::<Vec<_>>()
        };
        let call = Selection::Leg("c".into());
        assert!(draggable(None).is_empty() && draggable(Some(&call)).is_empty());
        for opens in [Selection::Procedure("look".into()), Selection::Leg("o".into())] {
            let at = draggable(Some(&opens));
            assert_eq!(at.len(), 4, "{opens:?}");
            assert!(at.iter().all(|at| at.lat_deg < 46.2), "where it is defined");
        }
    }

    #[test]
    fn a_sketch_that_goes_on_from_the_former_one_is_that_of_the_plan() {
        let mut plan = flight_plan::read(crate::assets::FIRE_WATCH.as_bytes()).plan;
        let mut former = Sketch::default();
        let leg = plan.all_legs().iter().find(|c| c.leg.place().is_some()).unwrap().leg.id.clone();
        let moved = |lon| Edit::MoveWaypoint { leg: leg.clone(), to: LatLon::new(36.3, lon) };
        let fix = Edit::MoveFix { fix: plan.fixes[0].id.clone(), to: LatLon::new(36.35, -84.2) };
        for edit in [moved(-84.2), moved(-84.21), fix, Edit::DeleteLeg { leg: leg.clone() }] {
            plan = edit.apply(&plan).unwrap();
            let variables = Variables::initial(&plan);
            let sketch = Sketch::new(&plan, &variables, &former);
            assert_eq!(sketch, Sketch::new(&plan, &variables, &Sketch::default()), "{edit:?}");
            former = sketch;
        }
    }
}
