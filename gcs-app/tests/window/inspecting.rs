//! The inspector shows and changes everything that the language has.

mod fields;
mod sorts;
mod writing;

use super::table::Unknown;
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::describe::{Description, Draft, Row, Subject};
use flight_plan::{
    Act, Altitude, AltitudeReference, Edit, Element, FlightPlan, Id, Leg, LegKind, Trigger, Value,
};
use gcs_app::command::{Command, DocumentCommand, Queue, Selection, ViewCommand};
use gcs_app::document::Document;
use gcs_app::layers::Layers;
use gcs_app::panels::inspector::Inspector;
use gcs_app::panels::{Elevations, Panel, Scene, ViewState};
use std::collections::BTreeSet;
use std::sync::Arc;
use terrain::{Flat, Terrain};

/// Every element of the language; the tests of the description compare it with the schema.
const EVERYTHING: &str = include_str!("../../../shared/flight-plan/tests/data/everything.xml");

/// The panel by itself, tall enough to show all of it.
struct Sheet {
    document: Document,
    view: ViewState,
    notice: Option<String>,
    terrain: Arc<dyn Terrain>,
}

impl Sheet {
    fn ui(&mut self, ui: &mut egui::Ui) {
        let mut queue = Queue::default();
        let (analysis, vehicle, vehicles) = (Default::default(), Default::default(), Default::default());
        let (recent, connections) = (Default::default(), Default::default());
        let layers = Layers::new(Arc::new(Flat(0.0)), Vec::new(), Arc::new(|| {}));
        let (shelf, jobs, toasts) = Default::default();
        let scene = Scene {
            shelf: &shelf,
            jobs: &jobs,
            toasts: &toasts,
            story: None,
            document: &self.document,
            can_undo: (false, false),
            analysis: &analysis,
            vehicle: &vehicle,
            aboard: None,
            vehicles: &vehicles,
            layers: &layers,
            view: &self.view,
            recent: &recent,
            connections: &connections,
            left_behind: None,
            ground: Elevations(self.terrain.as_ref()),
            now_s: 0.0,
            utc: jiff::Timestamp::UNIX_EPOCH,
        };
        Inspector.ui(ui, &scene, &mut queue);
        queue.take().into_iter().for_each(|command| self.carry_out(command));
    }

    fn carry_out(&mut self, command: Command) {
        match command {
            Command::Document(DocumentCommand::Edit(edit)) => self.notice = self.document.edit(&edit).err(),
            Command::Document(DocumentCommand::DragEdit(edit)) => drop(self.document.drag_edit(&edit)),
            Command::Document(DocumentCommand::EndGesture) => self.document.end_gesture(),
            Command::View(ViewCommand::Select(selection)) => self.view.select(selection),
            Command::View(ViewCommand::Notice(notice)) => self.notice = Some(notice),
            other => panic!("{other:?}"),
        }
    }
}

struct Panels(Harness<'static, Sheet>);

impl Panels {
    fn open(selection: Option<Selection>) -> Self {
        let document = Document::read(EVERYTHING.as_bytes(), None);
        let sheet =
            Sheet { document, view: ViewState::default(), notice: None, terrain: Arc::new(Flat(300.0)) };
        let builder = Harness::builder()
            .with_size(vec2(420.0, 4000.0))
            .with_step_dt(1.0 / 60.0)
            .with_context_setup(gcs_app::theme::install);
        let mut panels = Self(builder.build_ui_state(|ui, sheet: &mut Sheet| sheet.ui(ui), sheet));
        panels.select(selection);
        panels
    }

    fn leg(id: &str) -> Self {
        Self::open(Some(Selection::Leg(id.into())))
    }

    fn select(&mut self, selection: Option<Selection>) {
        self.0.state_mut().view.select(selection);
        self.0.run_steps(3);
    }

    fn plan(&self) -> FlightPlan {
        self.0.state().document.plan().as_ref().clone()
    }

    fn leg_of(&self, id: &str) -> Leg {
        self.plan().any_leg(&Id::new(id)).unwrap().clone()
    }

    fn set_altitude(&mut self, leg: &str, metres: f64, reference: AltitudeReference) {
        let altitude = Some(Altitude { metres: Value::Constant(metres), reference });
        let edit = Edit::SetAltitude { of: leg.into(), altitude };
        self.0.state_mut().document.edit(&edit).unwrap();
        self.0.run_steps(2);
    }

    fn click(&mut self, label: &str) {
        self.0.get_by_label(label).click();
        self.0.run_steps(3);
    }

    /// Chooses an option of a choice.
    fn choose(&mut self, name: &str, option: &str) {
        self.0.get_by_role_and_label(Role::ComboBox, name).click();
        self.0.run_steps(3);
        self.0.get_by_role_and_label(Role::Button, option).click();
        self.0.run_steps(3);
    }

    /// Puts the focus into a field and writes another text into it.
    fn write(&mut self, role: Role, name: &str, text: &str) {
        self.0.get_by_role_and_label(role, name).click();
        self.0.run_steps(2);
        self.0.key_press_modifiers(Modifiers::COMMAND, Key::A);
        self.0.run_steps(1);
        self.0.event(egui::Event::Text(text.into()));
        self.0.run_steps(2);
    }

    fn enter(&mut self) {
        self.0.key_press(Key::Enter);
        self.0.run_steps(3);
    }

    fn shows(&self, text: &str) -> bool {
        self.0.query_all_by_label_contains(text).next().is_some()
    }

    fn undo(&mut self) {
        self.0.state_mut().document.undo();
        self.0.run_steps(2);
    }

    /// The names of all that can be used.
    fn names(&self) -> BTreeSet<String> {
        let nodes = self.0.root().children_recursive();
        let named = nodes.filter(|node| {
            !matches!(node.accesskit_node().role(), Role::Label | Role::GenericContainer | Role::Tooltip)
        });
        named.filter_map(|node| node.accesskit_node().label()).collect()
    }
}

fn everything() -> FlightPlan {
    flight_plan::read(EVERYTHING).plan
}

fn selections(plan: &FlightPlan) -> Vec<(Option<Selection>, Subject)> {
    let mut found = vec![(None, Subject::Plan)];
    let mut add = |selection: Selection, subject: Subject| found.push((Some(selection), subject));
    let legs = plan.all_legs().into_iter().map(|c| c.leg.id.clone());
    let called = plan.procedures.iter().flat_map(|p| &p.legs).map(|l| l.id.clone());
    legs.chain(called).for_each(|id| add(Selection::Leg(id.clone()), Subject::Leg(id)));
    plan.all_stages().for_each(|(_, s)| add(Selection::Stage(s.id.clone()), Subject::Stage(s.id.clone())));
    for x in &plan.emergency_plans {
        add(Selection::Emergency(x.id.clone()), Subject::EmergencyPlan(x.id.clone()));
    }
    plan.fixes.iter().for_each(|x| add(Selection::Fix(x.id.clone()), Subject::Fix(x.id.clone())));
    plan.runways.iter().for_each(|x| add(Selection::Runway(x.id.clone()), Subject::Runway(x.id.clone())));
    plan.variables
        .iter()
        .for_each(|x| add(Selection::Variable(x.name.clone()), Subject::Variable(x.name.clone())));
    plan.zones.iter().for_each(|x| add(Selection::Zone(x.id.clone()), Subject::Zone(x.id.clone())));
    for x in &plan.procedures {
        add(Selection::Procedure(x.id.clone()), Subject::Procedure(x.id.clone()));
    }
    found
}

/// What must be there for an element: the names of its properties, choices and lists.
fn wanted(description: &'static Description, element: &Element, prefix: &str, into: &mut Vec<String>) {
    description.groups.iter().for_each(|rows| wanted_rows(rows, element, prefix, into));
}

fn wanted_rows(rows: &'static [Row], element: &Element, prefix: &str, into: &mut Vec<String>) {
    for row in rows.iter().filter(|row| row.applies(element)) {
        match row {
            Row::Property(property) => into.push(format!("{prefix}{}", property.label)),
            Row::OneOf(one) => {
                into.push(format!("{prefix}{}", one.label));
                let way = one.way(element).map(|way| one.ways[way].rows);
                wanted_rows(way.unwrap_or_default(), element, prefix, into);
            }
            Row::Children(children) => {
                let indices: Vec<usize> = children.indices(element).collect();
                if children.most > 1 {
                    let title = format!("{prefix}{} ({})", children.label, indices.len());
                    into.extend((!indices.is_empty()).then_some(title));
                    into.extend(
                        children.of.iter().map(|what| format!("{prefix}Add {}", what.label.to_lowercase())),
                    );
                }
                for (number, index) in indices.into_iter().enumerate() {
                    let child = &element.children[index];
                    let what = children.of.iter().find(|what| what.element == child.name).unwrap();
                    let inner = match children.most {
                        1 => prefix.to_owned(),
                        _ => format!("{prefix}{} {}: ", what.label, number + 1),
                    };
                    wanted(what, child, &inner, into);
                }
            }
        }
    }
}

#[test]
fn there_is_a_named_widget_for_every_described_property_of_every_element() {
    let plan = everything();
    let mut panels = Panels::open(None);
    let mut found = 0;
    for (selection, subject) in selections(&plan) {
        panels.select(selection);
        let draft = Draft::of(&plan, &subject).unwrap();
        let mut expected = Vec::new();
        wanted(draft.description(), draft.element(), "", &mut expected);
        if draft.element().name == "stage" && draft.element().attribute("type") != Some("land") {
            expected.retain(|name| !["Next begins", "Ground time"].contains(&name.as_str()));
        }
        let names = panels.names();
        for name in expected {
            // what is not given says what holds instead; an altitude and its reference share a row, and are left out
            // together
            let (said, out) = (format!("{name}: "), format!("Leave out the {}", name.to_lowercase()));
            let is_there = names.iter().any(|n| *n == name || n.starts_with(&said) || *n == out);
            assert!(is_there, "{subject:?}: no {name:?} in {names:?}");
            found += 1;
        }
    }
    assert!(found > 450, "{found}");
    assert_eq!(panels.plan(), plan, "looking changes nothing");
}

#[test]
fn a_value_is_typed_and_undone_in_one_step() {
    let before = everything();
    let mut panels = Panels::leg("orbit");
    panels.write(Role::SpinButton, "Radius", "275");
    panels.enter();
    let LegKind::Orbit { radius_m, .. } = panels.leg_of("orbit").kind else { panic!() };
    assert_eq!(radius_m, Value::Constant(275.0));
    panels.undo();
    assert_eq!(panels.plan(), before);
    panels.choose("Turn", "left");
    let LegKind::Orbit { turn, .. } = panels.leg_of("orbit").kind else { panic!() };
    assert_eq!(turn, flight_plan::TurnDirection::Left);
}

#[test]
fn a_number_becomes_a_formula_with_its_result_and_back() {
    let mut panels = Panels::leg("orbit");
    panels.click("Radius: number or formula");
    let radius = |panels: &Panels| match panels.leg_of("orbit").kind {
        LegKind::Orbit { radius_m, .. } => radius_m,
        other => panic!("{other:?}"),
    };
    assert_eq!(radius(&panels), Value::Expression("250.0".into()));
    panels.write(Role::TextInput, "Radius", "size * 2.0");
    assert!(panels.shows("= 600 m"), "while it is typed");
    panels.enter();
    assert_eq!(radius(&panels), Value::Expression("size * 2.0".into()));
    panels.click("Radius: number or formula");
    assert_eq!(radius(&panels), Value::Constant(600.0));
}

#[test]
fn a_number_with_its_unit_is_none_of_the_faults_of_a_formula() {
    let mut panels = Panels::leg("orbit");
    panels.click("Radius: number or formula");
    panels.write(Role::TextInput, "Radius", "0.301 km");
    assert!(!panels.shows("Column "), "while it is typed");
    panels.enter();
    let LegKind::Orbit { radius_m, .. } = panels.leg_of("orbit").kind else { panic!() };
    assert_eq!(radius_m, Value::Constant(301.0));
}

#[test]
fn a_fault_is_said_with_its_column_while_typing() {
    let mut panels = Panels::leg("hm");
    panels.write(Role::TextInput, "Until", "go && side > 3.0");
    assert!(panels.shows("Column 7: "), "an unknown name");
    panels.write(Role::TextInput, "Until", "size > 3.0");
    assert!(!panels.shows("Column ") && panels.shows("= yes at the start"));
    panels.enter();
    let LegKind::Hm { until, .. } = panels.leg_of("hm").kind else { panic!() };
    assert_eq!(until.as_deref(), Some("size > 3.0"));
}

#[test]
fn what_was_begun_is_completed_by_key_and_by_mouse() {
    let mut panels = Panels::leg("hm");
    panels.write(Role::TextInput, "Until", "!g");
    assert!(panels.shows("variable, bool"));
    panels.0.key_press(Key::ArrowDown);
    panels.0.run_steps(2);
    panels.enter();
    panels.enter();
    let until = |panels: &Panels| match panels.leg_of("hm").kind {
        LegKind::Hm { until, .. } => until.unwrap().to_string(),
        other => panic!("{other:?}"),
    };
    assert_eq!(until(&panels), "!go");
    panels.write(Role::TextInput, "Until", "batt");
    panels.click("battery");
    panels.0.event(egui::Event::Text(" < 0.4".into()));
    panels.0.run_steps(2);
    panels.enter();
    assert_eq!(until(&panels), "battery < 0.4");
}

#[test]
fn actions_are_added_changed_put_in_order_and_removed() {
    let mut panels = Panels::leg("tf");
    panels.click("Add action");
    panels.choose("Action 1: When", "every so far");
    panels.write(Role::SpinButton, "Action 1: Every", "80");
    panels.enter();
    let actions = panels.leg_of("tf").actions;
    assert_eq!((&actions[0].trigger, &actions[0].act), (&Trigger::Every(Value::Constant(80.0)), &Act::Photo));
    panels.click("Add action");
    panels.choose("Action 2: What", "Start the video");
    panels.click("Action 2: move up");
    let acts: Vec<Act> = panels.leg_of("tf").actions.into_iter().map(|a| a.act).collect();
    assert_eq!(acts, [Act::VideoStart, Act::Photo]);
    panels.click("Action 2: remove");
    assert_eq!(panels.leg_of("tf").actions.len(), 1);
}

/// The next one lies under the pointer then, and was not meant.
#[test]
fn a_second_press_removes_nothing_else_until_the_pointer_moves() {
    let mut panels = Panels::leg("tf");
    let before = panels.leg_of("tf").actions.len();
    (0..3).for_each(|_| panels.click("Add action"));
    let count = |panels: &Panels| panels.leg_of("tf").actions.len() - before;
    let at = panels.0.get_by_label("Action 1: remove").rect().center();
    let press = |panels: &mut Panels, at: egui::Pos2| {
        panels.0.hover_at(at);
        panels.0.drag_at(at);
        panels.0.run_steps(1);
        panels.0.drop_at(at);
        // not a double click
        panels.0.run_steps(30);
    };
    press(&mut panels, at);
    assert_eq!(count(&panels), 2);
    assert!(panels.0.get_by_label("Action 1: remove").rect().contains(at), "the next one came there");
    press(&mut panels, at);
    assert_eq!(count(&panels), 2, "it is another one");
    press(&mut panels, at + vec2(5.0, 0.0));
    assert_eq!(count(&panels), 1);
    panels.0.run_steps(100);
    press(&mut panels, at + vec2(5.0, 0.0));
    assert_eq!(count(&panels), 0, "it was there long enough to be read");
}

#[test]
fn branches_have_labels_conditions_and_a_default() {
    let mut panels = Panels::leg("fork");
    panels.click("Add branch");
    panels.write(Role::TextInput, "Branch 3: Label", "Around the north");
    panels.enter();
    panels.choose("Branch 3: Leads to", "Begin (if)");
    panels.choose("Default", "Around the north (branch1)");
    panels.choose("Decide before: of time or distance", "of distance");
    let leg = panels.leg_of("fork");
    let fork = leg.as_fork().unwrap();
    assert_eq!(fork.branches[2].label, "Around the north");
    assert_eq!(fork.branches[2].next, Some("if".into()));
    assert_eq!(fork.default, Some(&"branch1".into()));
    assert_eq!(fork.decide_before, flight_plan::DecideBefore::Distance(30.0));
}

#[test]
fn each_cause_has_its_plan_by_name() {
    let mut panels = Panels::leg("tf");
    panels.click("Add alternate by cause");
    panels.choose("Alternate by cause 1: Plan", "Bring it home (go_home)");
    let by_cause = panels.leg_of("tf").emergency.by_cause;
    assert_eq!(by_cause, [(Some(flight_plan::Cause::Engine), "go_home".into())]);
}

#[test]
fn another_identifier_is_followed_by_what_refers_to_it_and_by_the_selection() {
    let mut panels = Panels::open(Some(Selection::Variable("size".into())));
    panels.write(Role::TextInput, "Name", "width");
    panels.enter();
    assert_eq!(panels.0.state().view.selection, Some(Selection::Variable("width".into())));
    let LegKind::Cf { course_deg, .. } = panels.leg_of("cf").kind else { panic!() };
    assert_eq!(course_deg, Value::Expression("width / 10.0".into()));
    panels.write(Role::TextInput, "Name", "go");
    panels.enter();
    let refused = "`go` is the identifier of something else: choose another one";
    assert!(panels.0.query_by_label(refused).is_some(), "it is said at the field");
    assert!(panels.plan().variable(&"width".into()).is_some());
}

#[test]
fn what_is_no_value_is_refused_in_words_and_changes_nothing() {
    let mut panels = Panels::open(Some(Selection::Fix("A".into())));
    panels.write(Role::TextInput, "Position", "north of here");
    panels.enter();
    assert!(panels.0.state().notice.as_ref().unwrap().contains("latitude"));
    assert_eq!(panels.plan(), everything());
}

#[test]
fn several_legs_show_what_is_the_same_or_mixed_and_are_set_and_added_to_together() {
    let mut panels = Panels::leg("scan");
    panels.0.state_mut().view.toggle(Selection::Leg("crossing".into()));
    panels.0.run_steps(3);
    // 100 m and 80 m
    panels.click("Spacing: mixed");
    let spacing = |panels: &Panels, leg: &str| {
        let leg = panels.leg_of(leg);
        leg.numbers().into_iter().find(|(name, _)| *name == "spacing").and_then(|(_, value)| value.cloned())
    };
    assert_eq!(spacing(&panels, "crossing"), Some(Value::Constant(100.0)));
    panels.write(Role::SpinButton, "Spacing", "120");
    panels.enter();
    for leg in ["scan", "crossing"] {
        assert_eq!(spacing(&panels, leg), Some(Value::Constant(120.0)), "{leg}");
    }
    panels.click("Add to Spacing");
    panels.write(Role::SpinButton, "To be added to Spacing", "5");
    panels.enter();
    panels.click("Add to each");
    for leg in ["scan", "crossing"] {
        assert_eq!(spacing(&panels, leg), Some(Value::Constant(125.0)), "{leg}");
    }
    panels.undo();
    panels.undo();
    panels.undo();
    assert_eq!(panels.plan(), everything(), "each was one step");
    // legs of different kinds have less in common
    panels.0.state_mut().view.toggle(Selection::Leg("orbit".into()));
    panels.0.run_steps(3);
    assert!(!panels.names().contains("Spacing: mixed") && panels.shows("Airspeed"));
}

#[test]
fn altitudes_of_several_legs_that_differ_are_mixed_and_set_by_one_step() {
    let mut panels = Panels::leg("scan");
    panels.set_altitude("scan", 120.0, AltitudeReference::Home);
    panels.set_altitude("crossing", 90.0, AltitudeReference::Agl);
    let before = panels.plan();
    panels.0.state_mut().view.toggle(Selection::Leg("crossing".into()));
    panels.0.run_steps(3);
    assert!(!panels.names().contains("Altitude"), "no leg's altitude is shown for that of all");
    panels.write(Role::TextInput, "Altitude: mixed", "high");
    panels.enter();
    assert!(panels.0.state().notice.as_ref().unwrap().contains("is no number in m"));
    panels.write(Role::TextInput, "Altitude: mixed", "150 AGL");
    panels.enter();
    for leg in ["scan", "crossing"] {
        let altitude = panels.leg_of(leg).altitude.unwrap();
        let set = (altitude.metres, altitude.reference);
        assert_eq!(set, (Value::Constant(150.0), AltitudeReference::Agl), "{leg}");
    }
    assert!(panels.names().contains("Altitude"), "they have one now");
    panels.undo();
    assert_eq!(panels.plan(), before, "one step");
    panels.click("Leave out the altitude");
    assert!(panels.leg_of("scan").altitude.is_none() && panels.leg_of("crossing").altitude.is_none());
}

#[test]
fn the_other_direction_of_a_runway_is_levelled_by_a_button() {
    let mut panels = Panels::open(None);
    let mut plan = panels.plan();
    plan.runways.truncate(1);
    let runway = plan.runways[0].clone();
    let threshold = runway.threshold.destination(runway.heading_deg, runway.length_m);
    let heading_deg = (runway.heading_deg + 180.0) % 360.0;
    let elevation_amsl_m = runway.elevation_amsl_m + 7.0;
    let other = flight_plan::Runway {
        id: "other".into(),
        threshold,
        heading_deg,
        elevation_amsl_m,
        approach_entry: None,
        ..runway.clone()
    };
    plan.runways.push(other);
    panels.0.state_mut().document.replace(plan.clone());
    panels.select(Some(Selection::Runway(runway.id.clone())));
    assert!(panels.shows("other, the other direction, begins at"));
    panels
        .click(&format!("{} there too", gcs_app::units::Units::Si.altitude().show(runway.elevation_amsl_m)));
    assert_eq!(panels.plan().runway(&"other".into()).unwrap().elevation_amsl_m, runway.elevation_amsl_m);
    assert!(!panels.shows("the other direction"));
    panels.undo();
    assert_eq!(panels.plan(), plan, "one step");
}

/// The altitude of a leg as a number, and its reference.
fn altitude(panels: &Panels, leg: &str) -> (f64, AltitudeReference) {
    match panels.leg_of(leg).altitude.unwrap() {
        Altitude { metres: Value::Constant(metres), reference } => (metres, reference),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_altitude_that_counts_from_something_else_stays_where_it_is() {
    let mut panels = Panels::leg("tf");
    panels.set_altitude("tf", 120.0, AltitudeReference::Agl);
    let before = panels.plan();
    let home_m = before.home().unwrap().elevation_amsl_m;
    panels.choose("Above", "AMSL");
    assert_eq!(altitude(&panels, "tf"), (420.0, AltitudeReference::Amsl));
    assert!(panels.shows("By the ground at its place, 300 m AMSL"));
    panels.choose("Above", "home");
    assert_eq!(altitude(&panels, "tf"), (420.0 - home_m, AltitudeReference::Home));
    assert!(!panels.shows("By the ground"), "no ground is in it");
    panels.choose("Above", "AGL");
    assert_eq!(panels.plan(), before, "there and back");
    panels.undo();
    assert_eq!(altitude(&panels, "tf").1, AltitudeReference::Home, "one step each");
}

#[test]
fn what_an_altitude_counts_from_is_typed_behind_it() {
    let mut panels = Panels::leg("tf");
    panels.set_altitude("tf", 120.0, AltitudeReference::Home);
    for (text, expected) in [
        ("180 AGL", (180.0, AltitudeReference::Agl)),
        ("180 m amsl", (180.0, AltitudeReference::Amsl)),
        ("0.2 km", (200.0, AltitudeReference::Amsl)),
    ] {
        panels.write(Role::SpinButton, "Altitude", text);
        panels.enter();
        assert_eq!(altitude(&panels, "tf"), expected, "{text}");
    }
    panels.undo();
    panels.undo();
    assert_eq!(altitude(&panels, "tf"), (180.0, AltitudeReference::Agl), "one step each");
}

#[test]
fn where_no_ground_is_known_an_altitude_keeps_its_number_and_says_so() {
    let mut panels = Panels::leg("tf");
    panels.0.state_mut().terrain = Arc::new(Unknown);
    panels.set_altitude("tf", 120.0, AltitudeReference::Agl);
    panels.choose("Above", "AMSL");
    assert_eq!(altitude(&panels, "tf"), (120.0, AltitudeReference::Amsl));
    assert!(panels.shows("The number stays as it was: nothing is known of the ground there"));
    panels.write(Role::SpinButton, "Altitude", "500");
    panels.enter();
    assert!(!panels.shows("The number stays"), "it is another one");
}

#[test]
fn altitudes_of_several_legs_count_each_from_its_own_ground() {
    let mut panels = Panels::leg("scan");
    for leg in ["scan", "tf"] {
        panels.set_altitude(leg, 90.0, AltitudeReference::Agl);
    }
    panels.0.state_mut().view.toggle(Selection::Leg("tf".into()));
    panels.0.run_steps(3);
    panels.choose("Above", "AMSL");
    for leg in ["scan", "tf"] {
        assert_eq!(altitude(&panels, leg), (390.0, AltitudeReference::Amsl), "{leg}");
    }
}
