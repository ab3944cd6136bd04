//! The description of the language is whole: it has every element and attribute of the schema, and an edit through it
//! changes what it says, nothing else, and can be written, read and undone.
#![cfg(test)]

#[path = "described/schema.rs"]
mod schema;

use flight_plan::create::LegChoice;
use flight_plan::describe::{self, Change, Description, Draft, Kind, OneOf, Property, Row, Subject};
use flight_plan::{Edit, Element, FlightPlan, History, LegKind, read, write};
use schema::Schema;
use std::collections::BTreeSet;

const EVERYTHING: &str = include_str!("data/everything.xml");

fn plan() -> FlightPlan {
    let reading = read(EVERYTHING);
    assert_eq!(reading.problems, []);
    reading.plan
}

/// Containers of the document that are lists of the window, and the elements in them.
const LISTS: [&str; 7] =
    ["fixes", "runways", "variables", "zones", "procedures", "mainPlan", "emergencyPlans"];

#[test]
fn the_description_has_every_element_and_attribute_of_the_schema() {
    let schema = Schema::read();
    let mut seen = BTreeSet::new();
    for name in schema.parts() {
        let description = describe::of(&name).unwrap_or_else(|| panic!("nothing describes <{name}>"));
        compare(&schema, &name, description, &mut seen);
    }
    let all = schema.elements();
    let missing: Vec<_> = all.iter().filter(|e| !seen.contains(*e) && !LISTS.contains(&e.as_str())).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert_eq!(seen.len() + LISTS.len(), all.len());
}

/// The element and those inside it, but for what has an identifier of its own.
fn compare(schema: &Schema, name: &str, description: &Description, seen: &mut BTreeSet<String>) {
    seen.insert(name.to_owned());
    let element = schema.element(name);
    let attributes: Vec<&str> = element.attributes.iter().map(String::as_str).collect();
    assert_eq!(description.attributes(), attributes, "attributes of <{name}>");
    let inside =
        element.children.iter().filter(|child| !schema.is_part(child) && !LISTS.contains(&child.as_str()));
    let described: BTreeSet<&str> = description.children().iter().map(|d| d.element).collect();
    assert_eq!(described, inside.map(String::as_str).collect(), "elements in <{name}>");
    for child in description.children() {
        compare(schema, child.element, child, seen);
    }
}

#[test]
fn what_is_described_has_words_and_a_beginning() {
    for description in describe::all() {
        let mut of = vec![description];
        of.extend(description.children());
        for d in of {
            assert!(!d.label.is_empty() && !d.help.is_empty(), "{}", d.element);
            for row in d.deep_rows() {
                let (label, help) = match row {
                    Row::Property(p) => (p.label, p.help),
                    Row::OneOf(one) => (one.label, one.help),
                    Row::Children(children) => (children.label, "-"),
                };
                assert!(!label.is_empty() && !help.is_empty(), "{}: {row:?}", d.element);
            }
        }
    }
}

#[test]
fn every_leg_can_be_made_by_a_person() {
    let made: BTreeSet<String> = Schema::read().legs().into_iter().collect();
    let plan = plan();
    let there: BTreeSet<String> =
        plan.all_legs().iter().map(|context| context.leg.kind_name().to_owned()).collect();
    assert_eq!(there, made, "the specimen has every leg");
    let choices: BTreeSet<LegChoice> = plan.all_legs().iter().map(|c| LegChoice::of(&c.leg.kind)).collect();
    assert_eq!(choices.len(), made.len(), "each has a choice of its own");
    assert!(choices.iter().all(|choice| LegChoice::ALL.contains(choice)));
}

fn subjects(plan: &FlightPlan) -> Vec<Subject> {
    let mut found = vec![Subject::Plan];
    found.extend(plan.all_legs().iter().map(|c| Subject::Leg(c.leg.id.clone())));
    found.extend(plan.procedures.iter().flat_map(|p| &p.legs).map(|l| Subject::Leg(l.id.clone())));
    found.extend(plan.all_stages().map(|(_, s)| Subject::Stage(s.id.clone())));
    found.extend(plan.emergency_plans.iter().map(|x| Subject::EmergencyPlan(x.id.clone())));
    found.extend(plan.fixes.iter().map(|x| Subject::Fix(x.id.clone())));
    found.extend(plan.runways.iter().map(|x| Subject::Runway(x.id.clone())));
    found.extend(plan.variables.iter().map(|x| Subject::Variable(x.name.clone())));
    found.extend(plan.zones.iter().map(|x| Subject::Zone(x.id.clone())));
    found.extend(plan.procedures.iter().map(|x| Subject::Procedure(x.id.clone())));
    found
}

/// Visits every element of every part.
fn for_each(plan: &FlightPlan, visit: &mut dyn FnMut(&Draft, &[usize], &'static Description)) {
    for subject in subjects(plan) {
        let draft = Draft::of(plan, &subject).unwrap_or_else(|| panic!("{subject:?}"));
        descend(&draft, &mut Vec::new(), draft.description(), visit);
    }
}

fn descend(
    draft: &Draft,
    path: &mut Vec<usize>,
    description: &'static Description,
    visit: &mut dyn FnMut(&Draft, &[usize], &'static Description),
) {
    visit(draft, path, description);
    let element = draft.element().at(path).unwrap();
    for (index, child) in element.children.iter().enumerate() {
        let inner = description.child(&child.name).unwrap_or_else(|| panic!("<{}>", child.name));
        path.push(index);
        descend(draft, path, inner, visit);
        path.pop();
    }
}

/// Rows as they stand in an element: of the present ways only.
fn present(rows: &'static [Row], element: &Element) -> Vec<&'static Row> {
    let inside = |row: &'static Row| match row {
        Row::OneOf(one) => one.way(element).map_or_else(Vec::new, |way| present(one.ways[way].rows, element)),
        _ => Vec::new(),
    };
    rows.iter().flat_map(|row| std::iter::once(row).chain(inside(row))).collect()
}

fn rows(description: &'static Description, element: &Element) -> Vec<&'static Row> {
    description.groups.iter().flat_map(|rows| present(rows, element)).collect()
}

/// Makes an edit as the window does; it is written, read, and undone. Gives the plan that it makes.
fn made(plan: &FlightPlan, edit: &Edit, what: &str) -> FlightPlan {
    let mut history = History::new(plan.clone());
    history.apply(edit, None).unwrap_or_else(|error| panic!("{what}: {error}"));
    let after = history.plan().as_ref().clone();
    let again = read(write(&after));
    assert_eq!(again.problems, [], "{what}");
    assert_eq!(again.plan, after, "{what}: written and read");
    assert!(history.undo());
    assert_eq!(history.plan().as_ref(), plan, "{what}: undone");
    after
}

/// Another value for a property.
fn other(property: &Property, now: Option<&str>) -> String {
    let candidates: &[&str] = match property.kind {
        Kind::Identifier => &["renamed"],
        Kind::Text => &["other & <words>", "more"],
        Kind::Choice(words) => {
            return words.iter().rev().map(|w| w.0).find(|w| Some(*w) != now).unwrap().into();
        }
        Kind::Flag => &["true", "false"],
        Kind::Number(_) => &["4", "5"],
        Kind::Value(_) => &["= size + 4", "4.5"],
        Kind::LatLon(_) | Kind::Position => &["36.5 -84.5", "36.6 -84.6"],
        Kind::Positions => &["36.1 -84.1, 36.2 -84.2, 36.3 -84.1"],
        Kind::Ahead => &["45s", "800m"],
        Kind::Instant => &["2026-07-01T06:00:00Z"],
        Kind::Reference(_) | Kind::Names => &["another", "one"],
        Kind::Condition => &["battery < 0.25"],
        Kind::Formula(_) => &["= spot", "= burnt"],
    };
    candidates.iter().find(|c| Some(**c) != now).unwrap().to_string()
}

#[test]
fn every_property_can_be_changed_and_nothing_else_changes_with_it() {
    let plan = plan();
    let mut changed = 0;
    for_each(&plan, &mut |draft, path, description| {
        let element = draft.element().at(path).unwrap();
        for row in rows(description, element) {
            let Row::Property(property) = row else { continue };
            let now = property.value(element);
            let to = other(property, now.as_deref());
            check_set(&plan, draft, path, property, Some(to));
            // left out, where that is something else
            if property.without.is_some() && now.is_some() {
                check_set(&plan, draft, path, property, None);
            } else if property.without.is_some() && property.kind != Kind::Text {
                let what = format!("{:?} {path:?} {} begun", draft.subject(), property.attribute);
                let edit = draft.edit(&plan, path, &Change::Begin(*property));
                let after = made(&plan, &edit.unwrap_or_else(|e| panic!("{what}: {e}")), &what);
                let after = Draft::of(&after, draft.subject()).unwrap();
                assert!(property.value(after.element().at(path).unwrap()).is_some(), "{what}");
            }
            changed += 1;
        }
    });
    assert!(changed > 350, "{changed}");
}

fn check_set(plan: &FlightPlan, draft: &Draft, path: &[usize], property: &Property, to: Option<String>) {
    let what = format!("{:?} {path:?} {} = {to:?}", draft.subject(), property.attribute);
    let edit =
        draft.edit(plan, path, &Change::Set(*property, to.clone())).unwrap_or_else(|e| panic!("{what}: {e}"));
    let after = made(plan, &edit, &what);
    if property.kind == Kind::Identifier && path.is_empty() {
        assert_eq!(
            write(&after).matches("renamed").count(),
            uses(plan, draft),
            "{what}: what refers to it follows"
        );
        return;
    }
    // what is so without being said is not said
    let unsaid = |to: &String| match property.kind {
        Kind::Flag => property.without.is_some() && to == "false",
        Kind::Choice(words) => {
            words.iter().any(|(word, label)| word == to && property.without == Some(*label))
        }
        _ => false,
    };
    let to = to.filter(|to| !unsaid(to));
    let now = property.value(draft.element().at(path).unwrap());
    let mut expected = draft.element().clone();
    let element = path.iter().fold(&mut expected, |e, i| &mut e.children[*i]);
    let position = to.as_deref().and_then(|to| to.split_once(' '));
    let values = match (property.kind, position) {
        (Kind::LatLon(_), Some((lat, lon))) => vec![Some(lat.to_owned()), Some(lon.to_owned())],
        _ => vec![to],
    };
    for (name, value) in property.attributes().zip(values) {
        element.attributes.retain(|(n, _)| n != name);
        element.attributes.extend(value.map(|v| (name.to_owned(), v)));
    }
    if property.kind == Kind::Identifier && expected.attribute("default") == now.as_deref() {
        // the branch that is the fork's default is so under its new name, too
        expected.attributes.retain(|(name, _)| name != "default");
        expected
            .attributes
            .extend([("default".into(), "renamed".into())].into_iter().filter(|_| now.is_some()));
    }
    let changed = Draft::of(&after, draft.subject()).unwrap();
    assert_eq!(sorted(changed.element()), sorted(&expected), "{what}");
    let rest = |plan: &FlightPlan| write(plan).lines().count();
    assert!(rest(&after).abs_diff(rest(plan)) <= 2, "{what}: the rest stays");
    let others = subjects(plan).into_iter().filter(|s| s != draft.subject());
    for subject in others {
        assert_eq!(Draft::of(&after, &subject), Draft::of(plan, &subject), "{what}: {subject:?} stays");
    }
}

/// How often the identifier of a part stands in the document.
fn uses(plan: &FlightPlan, draft: &Draft) -> usize {
    let id = draft.element().attribute("id").or(draft.element().attribute("name")).unwrap();
    let text = write(plan);
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = text.split('"').skip(1).step_by(2).flat_map(|value| value.split(|c| !is_word(c)));
    // branches have identifiers too, and a name may be another thing's: the specimen keeps them apart
    words.filter(|word| *word == id).count()
}

/// Attributes have no order.
fn sorted(element: &Element) -> Element {
    let mut element = element.clone();
    element.attributes.sort();
    element.children = element.children.iter().map(sorted).collect();
    element
}

#[test]
fn everything_that_is_said_in_one_of_several_ways_can_be_said_in_each() {
    let plan = plan();
    let mut chosen = 0;
    for_each(&plan, &mut |draft, path, description| {
        let element = draft.element().at(path).unwrap();
        for row in rows(description, element) {
            let Row::OneOf(one) = row else { continue };
            for way in 0..one.ways.len() {
                chosen += usize::from(check_choice(&plan, draft, path, one, way));
            }
        }
    });
    assert!(chosen > 150, "{chosen}");
}

fn check_choice(plan: &FlightPlan, draft: &Draft, path: &[usize], one: &OneOf, way: usize) -> bool {
    let what = format!("{:?} {path:?} {} {}", draft.subject(), one.label, one.ways[way].label);
    let edit = draft.edit(plan, path, &Change::Choose(*one, way)).unwrap_or_else(|e| panic!("{what}: {e}"));
    let after = made(plan, &edit, &what);
    let changed = Draft::of(&after, draft.subject()).unwrap();
    assert_eq!(one.way(changed.element().at(path).unwrap()), Some(way), "{what}");
    after != *plan
}

#[test]
fn elements_inside_can_be_added_removed_and_put_in_another_order() {
    let plan = plan();
    let (mut added, mut moved) = (BTreeSet::new(), 0);
    for_each(&plan, &mut |draft, path, description| {
        let element = draft.element().at(path).unwrap();
        for row in rows(description, element) {
            let Row::Children(children) = row else { continue };
            let change = |change: Change, what: &str| {
                let what = format!("{:?} {path:?} {what} {}", draft.subject(), children.label);
                let edit = draft.edit(&plan, path, &change).unwrap_or_else(|e| panic!("{what}: {e}"));
                let after = Draft::of(&made(&plan, &edit, &what), draft.subject()).unwrap();
                children.count(after.element().at(path).unwrap())
            };
            let (count, indices) = (children.count(element), children.indices(element).collect::<Vec<_>>());
            for what in children.of {
                match count < children.most {
                    true => assert_eq!(change(Change::Add(what), "add"), count + 1),
                    false => assert_eq!(change(Change::Become(indices[0], what), "become"), count),
                }
                added.insert(what.element);
            }
            if count > children.least {
                assert_eq!(change(Change::Remove(indices[0]), "remove"), count - 1);
            }
            if let [first, .., last] = indices[..] {
                assert_eq!(change(Change::Move(first, 1), "move"), count);
                assert_eq!(change(Change::Move(last, -1), "move"), count);
                assert!(draft.edit(&plan, path, &Change::Move(last, 1)).is_err(), "it is the last");
                moved += 1;
            }
        }
    });
    assert!(added.len() >= 19, "{added:?}");
    assert!(moved >= 8, "{moved}");
}

#[test]
fn what_is_alike_can_become_each_other() {
    let plan = plan();
    let draft = Draft::of(&plan, &Subject::Leg("scan".into())).unwrap();
    let edit = draft.edit(&plan, &[], &Change::Rename("crissCross")).unwrap();
    let after = made(&plan, &edit, "rename");
    assert_eq!(after.any_leg(&"scan".into()).unwrap().kind_name(), "crissCross");
    let draft = Draft::of(&plan, &Subject::Zone("mast".into())).unwrap();
    let edit = draft.edit(&plan, &[], &Change::Rename("keepIn")).unwrap();
    assert_eq!(made(&plan, &edit, "rename").zones[1].kind, flight_plan::ZoneKind::KeepIn);
}

#[test]
fn a_place_stays_where_it_is_when_it_is_said_in_another_way() {
    let plan = plan();
    let draft = Draft::of(&plan, &Subject::Leg("cf".into())).unwrap();
    let to = draft.description().rows().find_map(|row| match row {
        Row::OneOf(one) if one.label == "To" => Some(*one),
        _ => None,
    });
    let edit = draft.edit(&plan, &[], &Change::Choose(to.unwrap(), 1)).unwrap();
    let after = made(&plan, &edit, "a position");
    let LegKind::Cf { to, .. } = &after.any_leg(&"cf".into()).unwrap().kind else { panic!() };
    let at = plan.fixes[0].position;
    assert_eq!(to.place, flight_plan::Place::Position(flight_plan::Value::Constant(at)));
}

#[test]
fn what_the_document_can_not_say_is_refused_in_words() {
    let plan = plan();
    let draft = Draft::of(&plan, &Subject::Leg("orbit".into())).unwrap();
    let set = |attribute: &str, value: &str| {
        let rows = draft.description().deep_rows();
        let property = rows.iter().find_map(|row| match row {
            Row::Property(p) if p.attribute == attribute => Some(*p),
            _ => None,
        });
        draft.edit(&plan, &[], &Change::Set(property.unwrap(), Some(value.into())))
    };
    assert_eq!(
        set("radius", "wide").unwrap_err(),
        "`radius` must be a finite number, or = and an expression, not \"wide\""
    );
    assert!(set("turn", "up").unwrap_err().contains("left, right"));
    assert!(set("radius", "=").is_ok(), "the checks refuse it");
    let gone = draft.edit(&FlightPlan::default(), &[], &Change::Remove(0));
    assert!(gone.is_err());
}

#[test]
fn a_broken_draft_can_be_mended_one_property_after_the_other() {
    let broken = EVERYTHING.replace("radius=\"250\" turns=\"2\"", "radius=\"?\" turns=\"2\"");
    let plan = read(&broken).plan;
    let draft = Draft::of(&plan, &Subject::Leg("orbit".into())).unwrap();
    let property = |attribute: &str| {
        let rows = draft.description().deep_rows();
        let found = rows.iter().find_map(|row| match row {
            Row::Property(p) if p.attribute == attribute => Some(*p),
            _ => None,
        });
        found.unwrap()
    };
    let turns = draft.edit(&plan, &[], &Change::Set(property("turns"), Some("3".into())));
    assert!(turns.unwrap().apply(&plan).is_ok(), "the other one stays broken");
    let radius = draft.edit(&plan, &[], &Change::Set(property("radius"), Some("200".into()))).unwrap();
    assert_eq!(read(write(&radius.apply(&plan).unwrap())).problems, []);
}
