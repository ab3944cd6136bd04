//! Whatever is drawn gives a plan without errors.

use super::*;
use crate::template::{Extent, Outline, Template};
use crate::{
    Altitude, AltitudeReference, Call, Edit, FlightPlan, Id, LegKind, Place, Runway, Spot, StageKind, Thing,
    Value, VariableValue, ZoneKind, ZoneShape, check,
};
use aircraft::Profile;
use geometry::LatLon;
use proptest::prelude::*;
use terrain::{Flat, Terrain};

const HOME: LatLon = LatLon::new(46.0, 8.0);

pub(crate) fn made(template: Template) -> FlightPlan {
    let runway = Runway {
        id: "R09".into(),
        threshold: HOME,
        elevation_amsl_m: 200.0,
        heading_deg: 90.0,
        length_m: 600.0,
        priority: 1,
        approach_entry: None,
    };
    let extent = Extent::Around { centre: HOME.destination(180.0, 3500.0), radius_m: 1000.0 };
    let outline = Outline { template, aircraft: "trainer".into(), runway, extent, height_m: 150.0 };
    outline.plan(&Profile::default(), &Flat(200.0))
}

fn errors(plan: &FlightPlan) -> Vec<String> {
    errors_but(plan, "nothing")
}

fn errors_but(plan: &FlightPlan, code: &str) -> Vec<String> {
    let problems = check(plan, &Profile::default(), &Flat(200.0));
    let errors = problems.iter().filter(|p| p.is_error() && p.code != code);
    errors.map(ToString::to_string).collect()
}

fn at(position: LatLon) -> Place {
    Place::Position(Value::Constant(position))
}

/// What a person would draw around a place for a kind.
fn drawn(shape: Shape, middle: LatLon, radius_m: f64, turned_deg: f64) -> Drawn {
    let around = |bearing_deg: f64| middle.destination(turned_deg + bearing_deg, radius_m);
    match shape {
        Shape::Place => Drawn::Place(at(middle)),
        Shape::Line => Drawn::Line([180.0, 80.0].map(|b| at(around(b))).to_vec()),
        Shape::Area => Drawn::Area([0.0, 100.0, 190.0, 280.0].map(around).to_vec()),
        Shape::Circle => Drawn::Circle { centre: at(middle), radius_m },
        Shape::Nothing => Drawn::Nothing,
    }
}

/// The plan with a track from one place to another at the end of its mission, and how it arrives there.
fn with_track(plan: &FlightPlan, before: LatLon, from: LatLon) -> (FlightPlan, Spot, Approach) {
    let profile = Profile::default();
    let mut plan = plan.clone();
    let mut spot = Spot::EndOf("mission".into());
    for position in [before, from] {
        let leg = leg(&plan, &profile, LegChoice::Tf, &Drawn::Place(at(position)), None, None).unwrap();
        let id = leg.id.clone();
        plan = Edit::InsertLeg { leg: Box::new(leg), at: spot }.apply(&plan).unwrap();
        spot = Spot::After(id);
    }
    let course_deg = Some(before.inverse(from).bearing_end_deg);
    (plan, spot, Approach { from, course_deg })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn every_kind_of_leg_can_be_drawn_and_checked(
        which in 0..LegChoice::ALL.len(),
        template in 0..Template::ALL.len(),
        (bearing_deg, away_m) in (0.0..360.0, 4000.0..9000.0),
        (radius_m, turned_deg, aside_deg) in (700.0..2000.0, 0.0..360.0, 20.0..100.0),
    ) {
        let choice = LegChoice::ALL[which];
        prop_assume!(!matches!(choice, LegChoice::Call | LegChoice::Iterative));
        let before = HOME.destination(200.0, 9000.0);
        let from = before.destination(bearing_deg, 4000.0);
        let (plan, spot, approach) = with_track(&made(Template::ALL[template]), before, from);
        prop_assert_eq!(errors(&plan), Vec::<String>::new());
        let middle = from.destination(bearing_deg + aside_deg, away_m);
        let drawn = drawn(choice.shape(), middle, radius_m, turned_deg);
        let leg = leg(&plan, &Profile::default(), choice, &drawn, Some(approach), None).unwrap();
        prop_assert_eq!(LegChoice::of(&leg.kind), choice);
        let after = Edit::InsertLeg { leg: Box::new(leg), at: spot }.apply(&plan).unwrap();
        // an arc ends on a course of its own: whoever drew it goes on from there
        prop_assert_eq!(errors_but(&after, "rf-not-tangent"), Vec::<String>::new());
    }
}

#[test]
fn every_kind_becomes_every_other_that_its_place_allows() {
    let (plan, _, approach) =
        with_track(&made(Template::Survey), HOME.destination(200.0, 9000.0), HOME.destination(190.0, 6000.0));
    let profile = Profile::default();
    for from in LegChoice::ALL.into_iter().filter(|choice| *choice != LegChoice::Call) {
        let drawn = drawn(from.shape(), HOME.destination(150.0, 7000.0), 900.0, 0.0);
        let old = leg(&plan, &profile, from, &drawn, Some(approach), None).unwrap();
        for to in LegChoice::ALL {
            let Some(new) = convert(&plan, &profile, &old, to, Some(approach)) else { continue };
            assert_eq!((new.id, LegChoice::of(&new.kind)), (old.id.clone(), to), "{from:?}");
        }
        let same = convert(&plan, &profile, &old, from, Some(approach)).unwrap();
        assert_eq!(same.kind.name(), old.kind.name());
    }
    let old = leg(&plan, &profile, LegChoice::Tf, &Drawn::Place(at(HOME)), None, None).unwrap();
    assert!(convert(&plan, &profile, &old, LegChoice::Scan, None).is_some());
    assert!(convert(&plan, &profile, &old, LegChoice::Corridor, None).is_none(), "a point is no line");
    assert!(convert(&plan, &profile, &old, LegChoice::Call, None).is_none(), "there is no procedure");
}

#[test]
fn things_get_names_of_their_own() {
    let mut plan = made(Template::Patrol);
    let add = |plan: &FlightPlan, thing: Thing| Edit::Add(Box::new(thing)).apply(plan).unwrap();
    for _ in 0..3 {
        plan = add(&plan, Thing::Fix(fix(&plan, HOME.destination(10.0, 900.0))));
        let (threshold, end) = (HOME.destination(0.0, 2000.0), HOME.destination(10.0, 2500.0));
        plan = add(&plan, Thing::Runway(runway(&plan, threshold, end, 201.4)));
        let circle = ZoneShape::Circle { centre: HOME.destination(0.0, 9000.0), radius_m: 300.0 };
        plan = add(&plan, Thing::Zone(zone(&plan, ZoneKind::KeepOut, circle)));
        plan = add(&plan, Thing::Variable(variable(&plan, VariableValue::Number(1.0))));
        plan = add_stage(&plan, StageKind::EnRoute).1.apply(&plan).unwrap();
    }
    assert_eq!((plan.runways.len(), plan.runways[1].elevation_amsl_m), (4, 201.0));
    assert_eq!(plan.runways.iter().map(|r| r.priority).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert_eq!(errors(&plan), Vec::<String>::new());
    let ids: Vec<&str> = plan.stages.iter().map(|s| s.id.as_str()).collect();
    assert!(ids.contains(&"en-route") && ids.contains(&"en-route3"), "{ids:?}");
    assert_eq!(plan.unique_id("number1"), Id::new("number4"), "a variable has that name");
}

/// A letter says that two runways lie side by side.
#[test]
fn a_runway_has_a_letter_beside_another_one_only() {
    let mut plan = FlightPlan::default();
    for (away_m, id) in [(0.0, "R08"), (400.0, "R08L"), (3000.0, "R08-1")] {
        let threshold = HOME.destination(0.0, away_m);
        let made = runway(&plan, threshold, threshold.destination(80.0, 600.0), 200.0);
        assert_eq!(made.id.as_str(), id);
        plan = Edit::Add(Box::new(Thing::Runway(made))).apply(&plan).unwrap();
    }
}

/// What is said of a leg that is tried out names nothing that is not in the plan.
#[test]
fn what_leads_to_a_trial_has_a_name_for_people() {
    let plan = made(Template::Survey);
    let tried = plan.leg(&"scan".into()).unwrap().leg.clone();
    let at = Approach { from: HOME, course_deg: Some(90.0) };
    let trial = trial(&plan, at, (500.0, 200.0), &tried);
    for id in trial.all_legs().iter().map(|of| &of.leg.id).chain(trial.stages.iter().map(|stage| &stage.id)) {
        assert!(plan.leg(id).is_some() || trial.label(id) == "the way there", "{id}");
    }
}

#[test]
fn stages_are_added_in_the_order_of_a_flight_and_moved() {
    let mut plan = FlightPlan::default();
    for kind in [StageKind::Land, StageKind::Mission, StageKind::TakeOff, StageKind::Arrival] {
        plan = add_stage(&plan, kind).1.apply(&plan).unwrap();
    }
    let ids = |plan: &FlightPlan| plan.stages.iter().map(|s| s.id.to_string()).collect::<Vec<_>>();
    assert_eq!(ids(&plan), ["take-off", "mission", "arrival", "land"]);
    let moved = |by| shift_stage(&plan, &"mission".into(), by).unwrap().apply(&plan).unwrap();
    assert_eq!(ids(&moved(-1)), ["mission", "take-off", "arrival", "land"]);
    assert_eq!(ids(&moved(1)), ["take-off", "arrival", "mission", "land"]);
    assert_eq!(shift_stage(&plan, &"land".into(), 1), None);
    assert_eq!(shift_stage(&plan, &"none".into(), 1), None);
    for kind in [StageKind::TakeOff, StageKind::Land, StageKind::Mission] {
        plan = add_stage(&plan, kind).1.apply(&plan).unwrap();
    }
    assert_eq!(ids(&plan)[4..], ["take-off2", "mission2", "land2"], "another flight");
}

#[test]
fn a_way_home_is_made_for_any_runway() {
    let plan = made(Template::Survey);
    let second = runway(&plan, HOME.destination(0.0, 6000.0), HOME.destination(5.0, 6500.0), 260.0);
    let plan = Edit::Add(Box::new(Thing::Runway(second.clone()))).apply(&plan).unwrap();
    let profile = Profile::default();
    let plan = emergency_plan(&plan, home_to(&second, &[]), &profile, &Flat(200.0)).1.apply(&plan).unwrap();
    let plan =
        emergency_plan(&plan, home_to(&plan.runways[0], &[]), &profile, &Flat(200.0)).1.apply(&plan).unwrap();
    assert_eq!(errors(&plan), Vec::<String>::new());
    let ids: Vec<&str> = plan.emergency_plans.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(ids, ["return", "return2", "return3"]);
    let names: Vec<&str> = plan.emergency_plans.iter().map(|e| e.name.as_str()).collect();
    let runways = plan.runways.iter().map(|runway| format!("Return to {}", runway.id));
    let [first, second]: [String; 2] = runways.collect::<Vec<_>>().try_into().unwrap();
    assert_eq!(names, [first.as_str(), &second, &format!("{first} (2)")], "told apart");
    let finals = plan.fixes.iter().filter(|f| f.id.as_str().starts_with("FINAL")).count();
    assert_eq!(finals, 2, "one is used again");
    assert_eq!(plan.emergency.by_cause, [(None, "return".into())], "it has one already");
    let gone = remove(&plan, &"return".into()).apply(&plan).unwrap();
    assert!(gone.emergency.by_cause.is_empty() && gone.emergency_plan(&"return".into()).is_none());
}

#[test]
fn an_emergency_plan_drawn_outwards_is_flown_inwards() {
    let plan = made(Template::Survey);
    let outwards = [3000.0, 6000.0, 9000.0].map(|far_m| at(HOME.destination(200.0, far_m)));
    let runway = plan.runways[0].clone();
    let (id, edit) = emergency_plan(&plan, home_to(&runway, &outwards), &Profile::default(), &Flat(200.0));
    let plan = edit.apply(&plan).unwrap();
    assert_eq!(errors(&plan), Vec::<String>::new());
    let legs = &plan.emergency_plan(&id).unwrap().stages[0].legs;
    let flown: Vec<_> =
        legs.iter().take(3).map(|leg| (leg.kind_name(), leg.place().unwrap().clone())).collect();
    let [near, middle, far] = outwards;
    assert_eq!(flown, [("DF", far), ("TF", middle), ("TF", near)]);
}

/// Hills south of the runway: the way home from anywhere keeps above them.
struct Hills;

impl Terrain for Hills {
    fn elevation_m(&self, at: LatLon) -> Option<f64> {
        let south = at.lat_deg < HOME.lat_deg - 0.01;
        Some(if south && at.lon_deg < HOME.lon_deg { 500.0 } else { 200.0 })
    }
}

/// Above the runway: 450 m from anywhere; over flat ground no higher than the path is, and over the hills as high as they ask for.
#[test]
fn an_emergency_plan_is_no_higher_than_where_it_is_drawn_from() {
    let plan = made(Template::Survey);
    let runway = plan.runways[0].clone();
    let height_m = |from: Option<(LatLon, f64)>| {
        let way = WayHome { from, ..home_to(&runway, &[]) };
        let (id, edit) = emergency_plan(&plan, way, &Profile::default(), &Hills);
        let with = edit.apply(&plan).unwrap();
        let heights = with.emergency_plan(&id).unwrap().stages.iter().flat_map(|stage| &stage.legs);
        let heights = heights.filter_map(|leg| match &leg.altitude {
            Some(Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Home }) => {
                Some(*metres)
            }
            _ => None,
        });
        heights.fold(f64::MIN, f64::max)
    };
    let flat = HOME.destination(315.0, 4000.0);
    let behind_hills = HOME.destination(200.0, 5000.0);
    assert_eq!(height_m(None), 450.0);
    assert_eq!(height_m(Some((flat, 474.0))), 270.0);
    assert_eq!(height_m(Some((flat, 900.0))), 450.0);
    assert_eq!(height_m(Some((behind_hills, 474.0))), 420.0, "300 m of hills and 120 m above them");
}

fn home_to<'a>(runway: &'a Runway, outwards: &'a [Place]) -> WayHome<'a> {
    WayHome { runway, outwards, from: None }
}

/// Places on the centre line that are nearer than the automatic final are flown after its beginning, whatever else was drawn.
#[test]
fn an_emergency_plan_drawn_along_the_centre_line_never_turns_back_out() {
    let plan = made(Template::Survey);
    let runway = plan.runways[0].clone();
    let profile = Profile::default();
    // the runway's heading is 90
    let on_line =
        |before_m: f64, beside_m: f64| at(HOME.destination(270.0, before_m).destination(0.0, beside_m));
    for drawn in [vec![900.0, 1450.0], vec![2000.0], vec![900.0, 1450.0, 6000.0], vec![1300.0, 9000.0]] {
        let outwards: Vec<Place> = drawn.iter().map(|before_m| on_line(*before_m, 40.0)).collect();
        let (id, edit) = emergency_plan(&plan, home_to(&runway, &outwards), &profile, &Flat(200.0));
        let with = edit.apply(&plan).unwrap();
        assert_eq!(errors(&with), Vec::<String>::new());
        let stages = &with.emergency_plan(&id).unwrap().stages;
        let flown: Vec<Place> =
            stages.iter().flat_map(|stage| &stage.legs).filter_map(|leg| leg.place().cloned()).collect();
        let far_m = |place: &Place| match place {
            Place::Fix(fix) => with.fix(fix).unwrap().position.distance_m(HOME),
            Place::Position(Value::Constant(at)) => at.distance_m(HOME),
            Place::Position(Value::Expression(_)) => panic!("{place:?}"),
        };
        assert!(flown.is_sorted_by(|one, next| far_m(one) >= far_m(next)), "{drawn:?}: {flown:?}");
        assert!(outwards.iter().all(|place| flown.contains(place)), "what was drawn is kept");
        let known = |fix: &Id| flown.contains(&Place::Fix(fix.clone())) || plan.fix(fix).is_some();
        assert!(with.fixes.iter().all(|fix| known(&fix.id)), "no fix is made for nothing");
    }
    let beside = [on_line(1000.0, 900.0)];
    let (id, edit) = emergency_plan(&plan, home_to(&runway, &beside), &profile, &Flat(200.0));
    let with = edit.apply(&plan).unwrap();
    let first = with.emergency_plan(&id).unwrap().stages[0].legs[0].place().cloned();
    assert_eq!(first.as_ref(), beside.first(), "a circuit comes from beside the runway");
}

#[test]
fn a_number_becomes_a_variable_and_comes_back() {
    let plan = made(Template::Survey);
    let drawn = Drawn::Circle { centre: at(HOME.destination(150.0, 7000.0)), radius_m: 900.0 };
    let orbit = leg(&plan, &Profile::default(), LegChoice::Orbit, &drawn, None, None).unwrap();
    let id = orbit.id.clone();
    let plan = insert(&plan, orbit, Spot::EndOf("mission".into())).apply(&plan).unwrap();
    let radius = |plan: &FlightPlan| {
        let leg = plan.leg(&id).unwrap().leg.clone();
        let found = Numeric::of(&leg).into_iter().find(|(n, _)| *n == Numeric("radius")).unwrap().1.clone();
        (leg, found)
    };
    let number = Numeric("radius");
    let (name, edit) = number.make_variable(&plan, &radius(&plan).0).unwrap();
    let bound = edit.apply(&plan).unwrap();
    assert_eq!((name.as_str(), errors(&bound)), ("orbit1_radius", Vec::new()));
    assert_eq!(Numeric::bound_to(&radius(&bound).1), Some(name.clone()));
    assert_eq!(bound.variable(&name).unwrap().unit, "m", "as the field that it was");
    let moved = Edit::SetVariable { name, value: VariableValue::Number(950.0) }.apply(&bound).unwrap();
    let own = number.unbind(&moved, &radius(&moved).0).unwrap().apply(&moved).unwrap();
    assert_eq!(radius(&own).1, Value::Constant(950.0));
}

#[test]
fn a_procedure_is_called_at_a_place_and_turned() {
    let plan = made(Template::Patrol);
    let legs = [plan.stages.iter().find(|s| s.kind == StageKind::Mission).unwrap().legs[0].id.clone()];
    let (caller, edit) = procedure_of(&plan, &legs).unwrap();
    let plan = edit.apply(&plan).unwrap();
    let LegKind::Call(Call { procedure: id, .. }) = &plan.leg(&caller).unwrap().leg.kind else {
        panic!("no call")
    };
    let made = call(&plan, id, at(HOME), Some(90.0)).unwrap();
    let LegKind::Call(call_of) = &made.kind else { panic!("no call") };
    assert_eq!(call_of.anchor, Some(at(HOME)));
    assert_eq!(call_of.bearing_deg, Some(Value::Constant(90.0)));
    assert!(call(&plan, &"none".into(), at(HOME), None).is_none());
}

#[test]
fn the_fixes_of_a_procedure_move_with_it_once_they_are_its_own_places() {
    let plan = made(Template::Patrol);
    let (caller, edit) = procedure_of(&plan, &["patrol".into()]).unwrap();
    let plan = edit.apply(&plan).unwrap();
    let id = &plan.procedures[0].id.clone();
    let anchored = call(&plan, id, at(HOME), None).unwrap();
    let plan = insert(&plan, anchored.clone(), Spot::After(caller)).apply(&plan).unwrap();
    let flown = |plan: &FlightPlan| {
        let (flown, problems) = crate::procedure::instantiate(plan);
        assert!(problems.is_empty(), "{problems:?}");
        flown.leg(&Id::new(&format!("{}.p2", anchored.id))).unwrap().leg.place().cloned()
    };
    assert_eq!(flown(&plan), Some(Place::Fix("P2".into())), "a fix stays where it is");
    let [of_leg, of_all] = [&"p2".into(), id].map(|of| own_places(&plan, of).unwrap().apply(&plan).unwrap());
    let p2 = plan.fix(&"P2".into()).unwrap().position;
    for own in [&of_leg, &of_all] {
        assert_eq!(own.procedure_leg(&"p2".into()).unwrap().1.place(), Some(&at(p2)));
        let Some(Place::Position(Value::Constant(moved))) = flown(own) else { panic!("no place") };
        assert!(moved.distance_m(p2) > 100.0, "it came along");
    }
    assert!(matches!(of_leg.procedure_leg(&"p1".into()).unwrap().1.place(), Some(Place::Fix(_))));
    assert!(own_places(&of_all, id).is_none() && own_places(&plan, &"scan".into()).is_none());
    assert_eq!(of_all.fixes, plan.fixes, "others may go there");
}

#[test]
fn a_trial_flies_what_can_be_flown_and_refuses_what_cannot() {
    let plan = made(Template::Survey);
    let from = HOME.destination(200.0, 5000.0);
    let way = Approach { from, course_deg: Some(200.0) };
    let tried = |to: LatLon| {
        let drawn = Drawn::Place(at(to));
        let tf = leg(&plan, &Profile::default(), LegChoice::Tf, &drawn, Some(way), None).unwrap();
        errors(&trial(&plan, way, (500.0, 200.0), &tf))
    };
    assert_eq!(tried(from.destination(230.0, 3000.0)), Vec::<String>::new());
    assert!(!tried(from).is_empty(), "a leg of no length");

    // the procedure's altitude counts from the home of a plan that has a take-off
    let scan =
        plan.stages.iter().flat_map(|stage| &stage.legs).find(|leg| leg.kind_name() == "scan").unwrap();
    let altitude = Some(Altitude { metres: Value::Constant(300.0), reference: AltitudeReference::Home });
    let plan = Edit::SetAltitude { of: scan.id.clone(), altitude }.apply(&plan).unwrap();
    let (caller, edit) = procedure_of(&plan, std::slice::from_ref(&scan.id)).unwrap();
    let plan = edit.apply(&plan).unwrap();
    let of_trial = trial(&plan, way, (500.0, 200.0), plan.leg(&caller).unwrap().leg);
    assert_eq!(errors(&of_trial), Vec::<String>::new());
    let counted = of_trial.procedures[0].legs[0].altitude.clone().unwrap();
    assert_eq!((counted.metres, counted.reference), (Value::Constant(500.0), AltitudeReference::Amsl));
}

#[test]
fn legs_keep_the_place_of_a_fix_that_is_removed() {
    let plan = made(Template::Patrol);
    let p2 = plan.fix(&"P2".into()).unwrap().position;
    let after = remove(&plan, &"P2".into()).apply(&plan).unwrap();
    assert_eq!(after.leg(&"p2".into()).unwrap().leg.place(), Some(&at(p2)));
    assert_eq!((errors(&after), after.fix(&"P2".into())), (Vec::new(), None));
}

#[test]
fn legs_are_copied_moved_and_put_into_loops_forks_and_procedures() {
    let (before, from) = (HOME.destination(200.0, 7000.0), HOME.destination(190.0, 5000.0));
    let (plan, _, _) = with_track(&made(Template::Survey), before, from);
    let ids = |plan: &FlightPlan| -> Vec<String> {
        plan.stage(&"mission".into()).unwrap().legs.iter().map(|leg| leg.id.to_string()).collect()
    };
    let then = |edit: Option<Edit>| edit.unwrap().apply(&plan).unwrap();
    assert_eq!(ids(&plan), ["scan", "leg1", "leg2"]);
    assert_eq!(ids(&then(duplicate(&plan, &"leg1".into()))), ["scan", "leg1", "leg3", "leg2"]);
    assert_eq!(ids(&then(shift(&plan, &"leg2".into(), -1))), ["scan", "leg2", "leg1"]);
    assert_eq!(ids(&then(shift(&plan, &"scan".into(), 1))), ["leg1", "scan", "leg2"]);
    assert_eq!(shift(&plan, &"scan".into(), -1), None);
    let (id, edit) = loop_around(&plan, &["leg2".into(), "leg1".into()]).unwrap();
    let looped = then(Some(edit));
    assert_eq!((ids(&looped), errors(&looped)), (vec!["scan".into(), "loop1".into()], Vec::new()));
    let body: Vec<&str> = looped.leg(&id).unwrap().leg.body().iter().map(|leg| leg.id.as_str()).collect();
    assert_eq!(body, ["leg1", "leg2"]);
    assert_eq!(unloop(&looped, &id).unwrap().apply(&looped).unwrap(), plan, "and back");
    let forked = then(Some(fork_around(&plan, &["leg1".into()]).unwrap().1));
    assert_eq!((ids(&forked).join(" "), errors(&forked)), ("scan fork1 leg1 leg2".into(), Vec::new()));
    let (id, edit) = fork_around(&plan, &["leg1".into(), "scan".into()]).unwrap();
    let forked = then(Some(edit));
    assert_eq!((ids(&forked).join(" "), errors(&forked)), ("fork1 scan leg1 leg2".into(), Vec::new()));
    let past = forked.leg(&id).unwrap().leg.as_fork().unwrap().branches[1].next.clone();
    assert_eq!(past, Some("leg2".into()), "past both of them");
    let forked = then(Some(fork_around(&plan, &["leg1".into(), "leg2".into()]).unwrap().1));
    assert_eq!((ids(&forked).join(" "), errors(&forked)), ("scan fork1 leg1 leg2 merge".into(), Vec::new()));
    assert!(fork_around(&plan, &["scan".into(), "leg2".into()]).is_none(), "they don't follow each other");
    let (caller, edit) = procedure_of(&plan, &["leg1".into(), "leg2".into()]).unwrap();
    assert_eq!(caller.as_str(), "call1", "what is drawn next goes behind it");
    let called = then(Some(edit));
    assert_eq!((ids(&called).join(" "), errors(&called)), ("scan call1".into(), Vec::new()));
    assert_eq!(called.procedures[0].legs.len(), 2);
    let place = Drawn::Place(at(HOME));
    let anchored = leg(&called, &Profile::default(), LegChoice::Call, &place, None, None).unwrap();
    assert!(matches!(anchored.kind, LegKind::Call(ref call) if call.anchor.is_some()));
}

/// What goes to a fix stays there, whatever is dragged.
#[test]
fn a_procedure_is_anchored_if_all_of_it_moves() {
    let plan = made(Template::Patrol);
    let anchor_of = |plan: &FlightPlan, legs: &[Id]| {
        let (caller, edit) = procedure_of(plan, legs).unwrap();
        let LegKind::Call(call) = edit.apply(plan).unwrap().leg(&caller).unwrap().leg.kind.clone() else {
            panic!("no call")
        };
        call.anchor
    };
    let own = leg(&plan, &Profile::default(), LegChoice::Tf, &Drawn::Place(at(HOME)), None, None).unwrap();
    let own_id = own.id.clone();
    let plan = insert(&plan, own, Spot::After("patrol".into())).apply(&plan).unwrap();
    assert_eq!(anchor_of(&plan, std::slice::from_ref(&own_id)), Some(at(HOME)));
    assert_eq!(anchor_of(&plan, &["patrol".into(), own_id.clone()]), None);
    // the way to a pylon, and around it
    let pylon = HOME.destination(45.0, 900.0);
    let centre = Drawn::Place(at(pylon));
    let orbit = leg(&plan, &Profile::default(), LegChoice::Orbit, &centre, None, None).unwrap();
    let orbit_id = orbit.id.clone();
    let plan = insert(&plan, orbit, Spot::After(own_id.clone())).apply(&plan).unwrap();
    assert_eq!(anchor_of(&plan, &[own_id, orbit_id]), Some(at(pylon)), "by its centre");
}

/// What is made of a branch's leg stands in the branch, and leads on as that did.
#[test]
fn a_leg_of_a_branch_becomes_a_loop_or_a_procedure_in_its_branch() {
    let survey = made(Template::Survey);
    let (fork, edit) = fork_around(&survey, &["scan".into()]).unwrap();
    let plan = edit.apply(&survey).unwrap();
    let look = Drawn::Circle { centre: at(HOME.destination(180.0, 3000.0)), radius_m: 600.0 };
    let orbit = leg(&plan, &Profile::default(), LegChoice::Orbit, &look, None, None).unwrap();
    let plan =
        begin_way(&plan, &fork, &Way::Branch("skip".into()), orbit.clone()).unwrap().apply(&plan).unwrap();
    assert_eq!(errors(&plan), Vec::<String>::new());
    let skip = |plan: &FlightPlan| plan.leg(&fork).unwrap().leg.as_fork().unwrap().branches[1].next.clone();
    assert_eq!(skip(&plan), Some(orbit.id.clone()));
    let legs = std::slice::from_ref(&orbit.id);
    for (id, edit) in [procedure_of(&plan, legs).unwrap(), loop_around(&plan, legs).unwrap()] {
        let made = edit.apply(&plan).unwrap();
        assert_eq!(errors(&made), Vec::<String>::new(), "{id}");
        assert_eq!(skip(&made), Some(id.clone()));
        assert_eq!(made.leg(&id).unwrap().leg.next, plan.leg(&orbit.id).unwrap().leg.next, "{id}");
    }
    assert!(procedure_of(&plan, std::slice::from_ref(&fork)).is_none(), "its ways lead out of it");
}

#[test]
fn a_leg_is_not_moved_into_itself() {
    let plan = made(Template::Patrol);
    for at in [Spot::EndOf("patrol".into()), Spot::Before("p2".into()), Spot::After("patrol".into())] {
        let refused = Edit::MoveLeg { leg: "patrol".into(), at }.apply(&plan).unwrap_err();
        assert!(refused.to_string().contains("into itself"), "{refused}");
    }
    let out = Edit::MoveLeg { leg: "p2".into(), at: Spot::After("patrol".into()) }.apply(&plan).unwrap();
    assert_eq!(out.leg(&"patrol".into()).map(|c| c.leg.body().len()), Some(2));
}

#[test]
fn a_place_or_area_becomes_a_variable_and_comes_back() {
    let plan = made(Template::Survey);
    let scan =
        plan.all_legs().iter().find(|c| matches!(c.leg.kind, LegKind::Scan(_))).unwrap().leg.id.clone();
    let (name, edit) = variable_of_leg(&plan, &scan).unwrap();
    let bound = edit.apply(&plan).unwrap();
    assert_eq!(bound_to(bound.leg(&scan).unwrap().leg), Some(name.clone()));
    assert_eq!(errors(&bound), Vec::<String>::new());
    assert!(variable_of_leg(&bound, &scan).is_none(), "it is one already");
    let back = unbind(&bound, &scan).unwrap().apply(&bound).unwrap();
    assert_eq!(back.stages, plan.stages);
    let again = bind(&back, &scan, &name).unwrap().apply(&back).unwrap();
    assert_eq!(again, bound);
    assert!(unbind(&plan, &scan).is_none() && bind(&plan, &scan, &"nothing".into()).is_none());
}

#[test]
fn a_leg_that_goes_to_a_fix_becomes_one_that_goes_to_a_variable_and_the_fix_stays() {
    let plan = made(Template::Patrol);
    let (leg, fix) = plan
        .all_legs()
        .iter()
        .find_map(|c| match c.leg.place() {
            Some(Place::Fix(fix)) => Some((c.leg.id.clone(), fix.clone())),
            _ => None,
        })
        .unwrap();
    let (name, edit) = variable_of_leg(&plan, &leg).unwrap();
    let bound = edit.apply(&plan).unwrap();
    assert_eq!(bound_to(bound.leg(&leg).unwrap().leg), Some(name.clone()));
    let place = VariableValue::Position(plan.fix(&fix).unwrap().position);
    assert_eq!(bound.variable(&name).unwrap().initial, place);
    assert_eq!((errors(&bound), bound.fix(&fix)), (Vec::new(), plan.fix(&fix)));
}

#[test]
fn a_holding_where_the_path_is_already_goes_the_way_that_the_path_goes() {
    let plan = made(Template::Patrol);
    let there = Some(Approach { from: HOME, course_deg: Some(51.6) });
    let hold = leg(&plan, &Profile::default(), LegChoice::Hm, &Drawn::Place(at(HOME)), there, None).unwrap();
    let LegKind::Hm { holding, .. } = hold.kind else { panic!("no holding") };
    assert_eq!(holding.inbound_course_deg, Some(Value::Constant(52.0)));
}

#[test]
fn a_fix_becomes_a_variable_with_every_leg_that_goes_there() {
    let plan = made(Template::Patrol);
    let fix = fix(&plan, HOME.destination(180.0, 2000.0));
    let id = fix.id.clone();
    let leg = plan.all_legs().iter().find(|c| matches!(c.leg.kind, LegKind::Tf(_))).unwrap().leg.id.clone();
    let plan = Edit::All(vec![
        Edit::Add(Box::new(Thing::Fix(fix))),
        Edit::ReplaceLeg {
            leg: leg.clone(),
            with: Box::new(crate::Leg {
                kind: LegKind::Tf(crate::PlanWaypoint { place: Place::Fix(id.clone()), fly_over: false }),
                ..plan.leg(&leg).unwrap().leg.clone()
            }),
        },
    ])
    .apply(&plan)
    .unwrap();
    let (name, edit) = variable_of_fix(&plan, &id).unwrap();
    let bound = edit.apply(&plan).unwrap();
    assert!(bound.fix(&id).is_none());
    assert_eq!(bound_to(bound.leg(&leg).unwrap().leg), Some(name.clone()));
    assert!(matches!(bound.variable(&name).unwrap().initial, VariableValue::Position(_)));
    assert!(
        !crate::check(&bound, &Profile::default(), &Flat(200.0)).iter().any(|p| p.code == "unknown-variable")
    );
}
