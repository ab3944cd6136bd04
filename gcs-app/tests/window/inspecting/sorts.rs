//! Several stages, fixes, zones or runways: what they have in common is changed together.

use super::{Panels, everything};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use flight_plan::{Altitude, AltitudeReference, Value};
use gcs_app::command::Selection;

fn panels<const N: usize>(selected: [Selection; N]) -> Panels {
    let mut panels = Panels::open(None);
    selected.into_iter().for_each(|what| panels.0.state_mut().view.toggle(what));
    panels.0.run_steps(3);
    panels
}

fn agl(metres: f64) -> Option<Altitude> {
    Some(Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Agl })
}

#[test]
fn zones_get_one_ceiling_by_one_step() {
    let mut panels = panels(["airspace", "mast"].map(|id| Selection::Zone(id.into())));
    assert!(!panels.names().contains("Name"), "each has its own");
    assert!(!panels.shows("Shape"), "and its own place");
    panels.write(Role::TextInput, "Upper limit: mixed", "high");
    panels.enter();
    assert!(panels.0.state().notice.as_ref().unwrap().contains("is no number in m"));
    panels.write(Role::TextInput, "Upper limit: mixed", "150 AGL");
    panels.enter();
    for zone in &panels.plan().zones {
        assert_eq!(zone.ceiling, agl(150.0), "{}", zone.id);
    }
    panels.undo();
    assert_eq!(panels.plan(), everything(), "one step");
}

#[test]
fn stages_get_one_altitude_and_speed_and_their_legs_what_legs_have() {
    let mut panels = panels(["to", "work"].map(|id| Selection::Stage(id.into())));
    // that of the stages stands above that of their legs
    let fields: Vec<_> = panels.0.query_all_by_role_and_label(Role::TextInput, "Altitude: mixed").collect();
    assert_eq!(fields.len(), 2);
    fields[0].click();
    drop(fields);
    panels.0.run_steps(2);
    panels.0.event(egui::Event::Text("120 AGL".into()));
    panels.enter();
    for stage in ["to", "work"] {
        assert_eq!(panels.plan().stage(&stage.into()).unwrap().altitude, agl(120.0), "{stage}");
    }
    panels.undo();
    assert_eq!(panels.plan(), everything(), "one step");
}

#[test]
fn runways_and_fixes_have_what_is_theirs_and_no_common_place() {
    let mut both = panels(["R05", "R23"].map(|id| Selection::Runway(id.into())));
    assert!(both.shows("Heading") && !both.shows("Threshold"));
    both.write(Role::SpinButton, "Length", "450");
    both.enter();
    assert!(both.plan().runways.iter().all(|runway| runway.length_m == 450.0));
    let fixes = panels(["A", "B"].map(|id| Selection::Fix(id.into())));
    assert!(fixes.shows("Description") && !fixes.shows("Position"));
    // a thing that is the only one of its sort is changed when it alone is selected
    let one = panels([Selection::Fix("A".into()), Selection::Runway("R05".into())]);
    assert!(!one.shows("Description") && !one.shows("Length"));
}
