//! What a proposal's report says of legs.

use crate::rig::{Rig, document, document_with, program};
use flight_exec::ProposalReport;

const BASE: &str = r#"<TF id="a" fix="A2"/><TF id="b" fix="B2"/><TF id="c" fix="C2"/><TF id="d" fix="C4"/>"#;

fn told(report: &ProposalReport) -> [String; 3] {
    [&report.added, &report.removed, &report.changed].map(|ids| {
        let mut ids: Vec<_> = ids.iter().map(|id| id.as_str()).collect();
        ids.sort_unstable();
        ids.join(" ")
    })
}

fn proposed(old: &str, new: &str) -> [String; 3] {
    let mut rig = Rig::flying(old);
    rig.fly_to("b");
    told(&rig.propose(&program(new)))
}

/// What stands behind a new leg is the same leg as before; a leg whose fix has moved is not.
#[test]
fn a_report_tells_the_legs_that_differ_and_no_others() {
    let text = document(BASE);
    let moved = crate::rig::fix("C4").destination(0.0, 300.0);
    let fix = crate::rig::fix("C4");
    let c4 = |at: geometry::LatLon| format!(r#"<fix id="C4" lat="{}" lon="{}"/>"#, at.lat_deg, at.lon_deg);
    for (what, new, expected) in [
        ("one more", text.replace(r#"<TF id="a""#, r#"<TF id="n" fix="A1"/><TF id="a""#), ["n", "", ""]),
        ("one less", text.replace(r#"<TF id="a" fix="A2"/>"#, ""), ["", "a", ""]),
        ("a fix moved", text.replace(&c4(fix), &c4(moved)), ["", "", "d"]),
        (
            "the stage's altitude",
            text.replace(r#"altitude="200""#, r#"altitude="220""#),
            ["", "", "a b c d m"],
        ),
    ] {
        assert_eq!(proposed(&text, &new), expected, "{what}");
    }
}

/// A call is the legs it stands for.
#[test]
fn a_changed_procedure_is_told_by_the_legs_of_its_calls() {
    let body = |fix: &str| {
        format!(
            r#"</variables><procedures><procedure id="q" reference="36.5 -84.2" bearing="0"><TF id="up" lat="36.51" lon="-84.2"/><TF id="over" {fix}/></procedure></procedures>"#
        )
    };
    let legs = format!(r#"{BASE}<call id="k" procedure="q" fix="B3" bearing="0"/>"#);
    let text = |at: &str| document_with(&legs, "", "").replace("</variables>", &body(at));
    let (old, new) = (text(r#"lat="36.52" lon="-84.2""#), text(r#"lat="36.52" lon="-84.19""#));
    assert_eq!(proposed(&old, &new), ["", "", "k.over"]);
}
