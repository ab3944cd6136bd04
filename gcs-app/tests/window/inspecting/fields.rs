//! Every field that takes an expression takes a variable that is dragged onto it.

use super::{Panels, everything, selections};
use egui::accesskit::Role;
use egui::{DragAndDrop, Event, Modifiers, PointerButton, Pos2, Shape, pos2};
use egui_kittest::kittest::NodeT;
use flight_plan::Element;
use flight_plan::describe::{Draft, Kind, Property, Row};
use gcs_app::panels::binding::DraggedVariable;
use std::collections::BTreeSet;

/// A number of an element: what its field is called, where the element is, and the property.
type Field = (String, Vec<usize>, Property);

fn fields(rows: &[Row], element: &Element, prefix: &str, path: &[usize], into: &mut Vec<Field>) {
    for row in rows {
        match row {
            Row::Property(property) if matches!(property.kind, Kind::Value(_)) => {
                into.push((format!("{prefix}{}", property.label), path.to_vec(), *property));
            }
            Row::Property(_) => {}
            Row::OneOf(one) => {
                let way = one.way(element).map_or(&[][..], |way| one.ways[way].rows);
                fields(way, element, prefix, path, into);
            }
            Row::Children(children) => {
                for (number, index) in children.indices(element).enumerate() {
                    let child = &element.children[index];
                    let what = children.of.iter().find(|what| what.element == child.name).unwrap();
                    let prefix = match children.most {
                        1 => prefix.to_owned(),
                        _ => format!("{prefix}{} {}: ", what.label, number + 1),
                    };
                    let path = [path, &[index]].concat();
                    what.groups.iter().for_each(|rows| fields(rows, child, &prefix, &path, into));
                }
            }
        }
    }
}

/// Where a field is, or what stands in its place while nothing is given.
fn place(panels: &Panels, name: &str) -> Pos2 {
    let said = format!("{name}: ");
    let is_it = |label: &str| label == name || label.starts_with(&said);
    let nodes = panels.0.root().children_recursive();
    let field = nodes.into_iter().find(|node| {
        matches!(node.accesskit_node().role(), Role::SpinButton | Role::TextInput | Role::Button)
            && node.accesskit_node().label().is_some_and(|label| is_it(&label))
    });
    field.unwrap_or_else(|| panic!("no {name:?}: {:?}", panels.names())).rect().center()
}

/// One frame with these events.
fn frame(panels: &mut Panels, events: impl IntoIterator<Item = Event>) {
    panels.0.input_mut().events.extend(events);
    panels.0.step();
}

/// Drags a variable to a place; true if a frame was seen there before it was let go.
fn drop_there(panels: &mut Panels, name: &str, at: Pos2) -> bool {
    let far = pos2(419.0, 3999.0);
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    frame(panels, [Event::PointerMoved(far), button(far, true)]);
    DragAndDrop::set_payload(&panels.0.ctx, DraggedVariable(name.into()));
    frame(panels, [Event::PointerMoved(at)]);
    let framed = panels.0.output().shapes.iter().any(|clipped| {
        matches!(&clipped.shape, Shape::Rect(rect) if rect.stroke.width == 1.5 && rect.rect.contains(at))
    });
    frame(panels, [button(at, false)]);
    framed
}

#[test]
fn every_field_of_a_number_takes_a_variable_that_is_dropped_on_it() {
    let plan = everything();
    let mut panels = Panels::open(None);
    let mut tried = BTreeSet::new();
    for (selection, subject) in selections(&plan) {
        let draft = Draft::of(&plan, &subject).unwrap();
        let mut found = Vec::new();
        let groups = draft.description().groups.iter();
        groups.for_each(|rows| fields(rows, draft.element(), "", &[], &mut found));
        let is_new = |(_, path, property): &Field| {
            let element = draft.element().at(path).unwrap();
            tried.insert((element.name.clone(), property.attribute))
        };
        found.retain(is_new);
        if found.is_empty() {
            continue;
        }
        panels.select(selection);
        let names = panels.names();
        for (name, path, property) in found {
            let value = |panels: &Panels| {
                let draft = Draft::of(&panels.plan(), &subject).unwrap();
                draft.element().at(&path).and_then(|element| property.value(element))
            };
            if value(&panels).is_some_and(|value| !value.starts_with('=')) {
                let menu = format!("{name}: bind to a variable");
                assert!(names.contains(&menu), "{subject:?}: no {menu:?}");
            }
            let at = place(&panels, &name);
            assert!(drop_there(&mut panels, "size", at), "{subject:?}: no frame around {name:?}");
            assert_eq!(value(&panels).as_deref(), Some("= size"), "{subject:?}: {name:?}");
            panels.undo();
        }
    }
    assert!(tried.len() > 40, "{}", tried.len());
    assert_eq!(panels.plan(), plan, "one step each");
}
