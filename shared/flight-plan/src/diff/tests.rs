//! Edits, and what is said about them.

use super::*;
use crate::{Edit, EmergencyPlan, Leg, Spot, Thing, Value, read};
use geometry::LatLon;
use proptest::prelude::*;

const FIRE_WATCH: &str = include_str!("../../../../assets/plans/fire-watch.xml");
const LANGUAGE: &str = include_str!("../../tests/data/language.xml");

const ELSEWHERE: LatLon = LatLon::new(36.3, -84.2);

#[test]
fn legs_are_added_removed_and_changed() {
    let old = read(FIRE_WATCH).plan;
    let new_leg = Box::new(Leg { id: "new".into(), ..old.leg(&"o1".into()).unwrap().leg.clone() });
    let cases = [
        (Edit::InsertLeg { leg: new_leg, at: Spot::After("o1".into()) }, ["new", "", ""]),
        (Edit::DeleteLeg { leg: "h1".into() }, ["", "h1", ""]),
        (Edit::DeleteLeg { leg: "patrol".into() }, ["", "patrol p1 p2 p3", ""]),
        (Edit::MoveFix { fix: "WATCH".into(), to: ELSEWHERE }, ["", "", "o2 regroup"]),
        (Edit::SetSpeed { of: "p2".into(), speed_mps: Some(Value::Constant(20.0)) }, ["", "", "p2"]),
        (Edit::SetCount { leg: "patrol".into(), count: None }, ["", "", "patrol"]),
        (Edit::MoveLeg { leg: "p3".into(), at: Spot::Before("p2".into()) }, ["", "", "p3"]),
        (Edit::MoveLeg { leg: "o2".into(), at: Spot::Before("o1".into()) }, ["", "", "o2"]),
        (Edit::MoveLeg { leg: "h1".into(), at: Spot::EndOf("out".into()) }, ["", "", "h1"]),
        (Edit::Rename { id: "GAP".into(), name: "Another".into() }, ["", "", ""]),
    ];
    for (edit, expected) in cases {
        let difference = Difference::between(&old, &edit.apply(&old).unwrap());
        let words = |ids: &[Id]| ids.iter().map(Id::as_str).collect::<Vec<_>>().join(" ");
        let found = [words(&difference.added), words(&difference.removed), words(&difference.changed)];
        assert_eq!(found, expected, "{edit:?}");
    }
}

#[test]
fn each_change_is_told_in_words() {
    let old = read(LANGUAGE).plan;
    let number = |leg: &str, name: &str, value: Option<f64>| Edit::SetNumber {
        leg: leg.into(),
        name: name.into(),
        value: value.map(Value::Constant),
    };
    let zone = Thing::Zone(crate::Zone { ceiling: None, ..old.zones[0].clone() });
    let emergency =
        EmergencyPlan { id: "other".into(), stages: Vec::new(), ..old.emergency_plans[0].clone() };
    let cases: [(Edit, &[&str]); 17] = [
        (number("cf", "course", Some(45.0)), &["leg cf changed: course = 90.0 → 45"]),
        (number("scan", "heading", None), &["leg scan changed: heading 45 removed"]),
        (number("creeping", "heading", Some(10.0)), &["leg creeping changed: heading 10 added"]),
        (Edit::SetActions { leg: "tf".into(), actions: Vec::new() }, &["leg tf changed: action removed"]),
        (
            Edit::RemoveCorner { leg: "line".into(), hole: None, corner: 1 },
            &["leg line changed: route: point removed (lat 36.6, lon -84.2)"],
        ),
        (
            Edit::MoveFix { fix: "COVE".into(), to: LatLon::new(36.542, -84.232) },
            &[
                "fix COVE changed: moved by 111 m to 36.542, -84.232",
                "leg if changed: its fix COVE moved by 111 m",
            ],
        ),
        (
            Edit::SetSpeed { of: "patterns".into(), speed_mps: Some(Value::Constant(20.0)) },
            &["stage patterns changed: speed 20 m/s added", "leg scan changed: its stage's speed 20 added"],
        ),
        (
            Edit::Replace { id: "range".into(), with: Box::new(zone) },
            &["zone range changed: ceiling 3000 m AMSL removed, ceilingReference amsl removed"],
        ),
        (
            Edit::RemoveCorner { leg: "range".into(), hole: None, corner: 0 },
            &["zone range changed: corner removed (lat 36, lon -85)"],
        ),
        (Edit::Remove { id: "done".into() }, &["variable done removed"]),
        (
            Edit::SetVariable { name: "size".into(), value: crate::VariableValue::Number(700.0) },
            &["variable size changed: initial 600 → 700, read by tf fork call criss"],
        ),
        (Edit::Remove { id: "two-gates".into() }, &["procedure two-gates removed", "leg first removed"]),
        (
            number("out", "course", Some(91.0)),
            &["procedure gate changed: flown otherwise by call there", "leg out changed: course 90 → 91"],
        ),
        (Edit::Add(Box::new(Thing::EmergencyPlan(emergency))), &["emergency plan other added"]),
        (Edit::MoveStage { stage: "patterns".into(), before: "basic".into() }, &["stage patterns moved"]),
        (Edit::MoveThing { id: "done".into(), before: None }, &["variable done moved"]),
        (
            Edit::SetEmergency { of: None, cause: None, plan: None },
            &["plan changed: emergency return removed"],
        ),
    ];
    for (edit, expected) in cases {
        let told: Vec<String> =
            changes(&old, &edit.apply(&old).unwrap()).iter().map(Change::to_string).collect();
        // of many legs that change with one thing, the first
        let first: Vec<&str> = told.iter().take(expected.len()).map(String::as_str).collect();
        assert_eq!(first, expected, "{edit:?}: {told:#?}");
    }
    let moved = Edit::MoveLeg { leg: "l1".into(), at: Spot::EndOf("basic".into()) }.apply(&old).unwrap();
    let told: Vec<String> = changes(&old, &moved).iter().map(Change::to_string).collect();
    assert_eq!(told, ["leg l1 moved: from loop to basic"]);
}

/// Old and new, of what stands inside a part too.
#[test]
fn values_are_told_as_they_were_and_are() {
    let old = read(LANGUAGE).plan;
    let document: String = LANGUAGE.lines().map(str::trim_start).collect();
    for (from, to, told) in [
        (
            r#"label="Close look" next="l2" when="size &lt; 200.0""#,
            r#"label="Closer" when="size &lt; 300.0""#,
            "leg fork changed: branch close: label Close look → Closer; when size < 200.0 → size < 300.0; next l2 removed",
        ),
        (
            r#"<wait seconds="30"/>"#,
            r#"<wait seconds="45"/>"#,
            "leg tf changed: action 2: wait: seconds 30 → 45",
        ),
        (
            r#"altitude="900" altitudeReference="amsl" speed="24""#,
            r#"altitude="950" altitudeReference="amsl" speed="24""#,
            "stage basic changed: altitude 900 → 950 m AMSL",
        ),
        (r#"<videoStart/>"#, r#"<photo/>"#, "leg tf changed: action 1: videoStart → photo"),
        (
            r#"<action on="end"><videoStop/></action>"#,
            "",
            "leg tf changed: action removed (on end, videoStop)",
        ),
        (
            r#"value="= size / 30.0""#,
            r#"value="= 21.0""#,
            "leg call changed: argument fast: value = size / 30.0 → = 21.0",
        ),
        (
            r#"<call id="there" procedure="two-gates"/>"#,
            r#"<call id="there" procedure="two-gates"><argument name="x" value="= 1.0"/></call>"#,
            "leg there changed: argument x added (value = 1.0)",
        ),
        (
            r#"default="= 50.0""#,
            r#"default="= 60.0""#,
            "procedure gate changed: parameter gap: default = 50.0 → = 60.0",
        ),
        (
            r#"lon="-84.2" radius="700""#,
            r#"lon="-84.2" radius="800""#,
            "leg contour changed: area: radius 700 → 800",
        ),
        (
            r#"<emergency cause="link" plan="return"/>"#,
            r#"<emergency cause="gps" plan="return"/>"#,
            "stage basic changed: emergency gps added (plan return), emergency link removed (plan return)",
        ),
        (
            r#"altitude="900" altitudeReference="amsl" speed="24""#,
            r#"altitude="950" altitudeReference="amsl" speed="24""#,
            "leg if changed: its stage's altitude 900 amsl → 950 amsl",
        ),
        // the path of `call` has it from its argument
        (
            r#"<argument name="fast" value="= 20.0"/>"#,
            r#"<argument name="fast" value="= 19.0"/>"#,
            "procedure two-gates changed: flown otherwise by there",
        ),
    ] {
        assert!(document.contains(from), "{from}");
        let new = read(document.replacen(from, to, 1)).plan;
        let found: Vec<String> = changes(&old, &new).iter().map(Change::to_string).collect();
        assert!(found.iter().any(|change| change == told), "{told}: {found:#?}");
    }
}

#[test]
fn a_number_has_no_more_digits_than_tell_it_from_the_one_before() {
    let told = |old: &str, new: &str| words::change_of("lat", Some(old), Some(new)).unwrap();
    assert_eq!(told("36.285", "36.2933411228164"), "lat 36.285 → 36.293341");
    assert_eq!(told("36.28500000001", "36.28500000002"), "lat 36.28500000001 → 36.28500000002");
    assert_eq!(told("a.bcdefghij", "1.5"), "lat a.bcdefghij → 1.5");
}

#[test]
fn a_plan_has_not_changed_from_itself() {
    for document in [FIRE_WATCH, LANGUAGE] {
        let plan = read(document).plan;
        assert_eq!(changes(&plan, &plan), []);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// What is left is ascending, and nothing that is out could stay with all of it.
    #[test]
    fn the_order_is_kept_by_as_many_as_can(numbers in Just((0..12).collect::<Vec<usize>>()).prop_shuffle()) {
        let outside = out_of_order(&numbers);
        let kept: Vec<usize> = numbers.iter().zip(&outside).filter(|(_, out)| !**out).map(|(n, _)| *n).collect();
        prop_assert!(kept.is_sorted());
        // every selection there is
        let longest = (0..1_u32 << 12).filter_map(|mask| {
            let chosen: Vec<usize> = (0..12).filter(|i| mask >> i & 1 == 1).map(|i| numbers[i]).collect();
            chosen.is_sorted().then_some(chosen.len())
        });
        prop_assert_eq!(kept.len(), longest.max().unwrap());
    }
}
