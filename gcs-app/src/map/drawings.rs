//! Drawings of other programs, on the clipboard or in a file that is added to the plan: a line becomes a corridor, an area is scanned, a point is a waypoint.

use super::tools::new_leg::{self, Aim, Side};
use crate::command::Selection;
use crate::files::{Choices, Lines};
use crate::formats::{FileFormat, label};
use crate::guide::{Answer, Guide, MissionFigure};
use flight_plan::clipboard::{MAX_BYTES, Pasted};
use flight_plan::create::{self, Approach, Drawn, LegChoice};
use flight_plan::template::{Extent, Template};
use flight_plan::{
    Area, Edit, Fix, FlightPlan, Leg, LegKind, Pattern, Place, Scan, Spacing, Spot, Thing, Value, Zone,
    ZoneKind,
};
use geometry::LatLon;
use interchange::{Areas, DrawnZone, Feature, Format, Shape};
use std::path::Path;

/// Most figures that are pasted at once.
const MOST: usize = 100;

/// In which format a text draws; `None`: it is no drawing.
pub fn format_of(text: &str) -> Option<Format> {
    match FileFormat::of(Path::new("clipboard"), text.as_bytes()) {
        FileFormat::Other(format @ (Format::Kml | Format::GeoJson | Format::Gpx)) => Some(format),
        _ => None,
    }
}

/// What a text draws. The sentence says why it can't be pasted.
pub fn read(format: Format, text: &str) -> Result<Vec<Feature>, String> {
    features(format, text).map_err(|why| format!("That {} can't be pasted: {why}.", label(format)))
}

fn features(format: Format, text: &str) -> Result<Vec<Feature>, String> {
    if text.len() > MAX_BYTES {
        return Err(format!("it has more than {} MB; open it as a file", MAX_BYTES >> 20));
    }
    let features = interchange::features(format, text.as_bytes()).map_err(|error| error.to_string())?;
    match features.len() {
        0 => Err("it has no point, line or area".into()),
        1..=MOST => Ok(features),
        has => Err(format!("it has {has} figures, and {MOST} can be pasted at once; open it as a file")),
    }
}

/// What a file draws as parts of a plan: points are fixes, lines and areas to be scanned are legs behind what is selected,
/// other areas are zones. The sentence says why that can't be.
pub fn add(
    features: &[Feature],
    choices: &Choices,
    plan: &FlightPlan,
    selected: Option<&Selection>,
) -> Result<Pasted, String> {
    may_add(features, choices)?;
    let mut with = plan.clone();
    let (mut flown, mut edits, mut things) = (Vec::new(), Vec::new(), Vec::new());
    for feature in features.iter().filter(|feature| !is_of_a_flight(feature)) {
        let parts = parts(feature, choices.areas);
        if parts.is_empty() {
            flown.extend(flown_as(feature, choices.lines));
        }
        for part in parts {
            let thing = part.thing(&with);
            let edit = Edit::Add(Box::new(thing.clone()));
            with = edit.apply(&with).map_err(|error| error.to_string())?;
            edits.push(edit);
            things.push(thing);
        }
    }
    if flown.is_empty() {
        return Ok(Pasted { legs: Vec::new(), things, edit: Edit::All(edits) });
    }
    let Some(Aim::Spot(at)) = new_leg::mission_aim(&with, selected, &Side::Behind) else {
        return Err("This plan has no stage to add legs to: add one in the plan's list (+).".into());
    };
    let Pasted { legs, edit, .. } = legs(&flown, at, None, &with)?;
    edits.push(edit);
    Ok(Pasted { legs, things, edit: Edit::All(edits) })
}

/// So many figures can be added to a plan, as what was chosen.
pub fn may_add(features: &[Feature], choices: &Choices) -> Result<(), String> {
    if features.len() > MOST {
        return Err(format!("It has {} figures, and {MOST} can be added to a plan at once.", features.len()));
    }
    let counts = counts(features, choices);
    let of = |what: &str| counts.iter().find(|(_, name)| *name == what).map_or(0, |(count, _)| *count);
    match (of("leg"), of("zone")) {
        (0..=MOST, 0..=MOST) => Ok(()),
        (0..=MOST, has) => Err(format!(
            "Its areas and their holes come to {has} zones, and {MOST} can be added at once: take it as a new plan."
        )),
        (has, _) => Err(format!(
            "Its lines have {has} points, and {MOST} legs can be added at once: take them as corridors."
        )),
    }
}

/// There is a line among them: it may be a corridor, or a leg for each of its points.
pub fn has_lines(features: &[Feature]) -> bool {
    features.iter().any(is_line)
}

fn is_line(feature: &Feature) -> bool {
    matches!(feature.shape, Shape::Line(_)) && !is_of_a_flight(feature)
}

/// What comes of a drawing that is added, counted: of each sort its name and how many.
pub fn counts(features: &[Feature], choices: &Choices) -> [(usize, &'static str); 5] {
    let mut counts = [(0, "fix"), (0, "corridor"), (0, "leg"), (0, "scan"), (0, "zone")];
    for feature in features.iter().filter(|feature| !is_of_a_flight(feature)) {
        let (more, what) = match (&feature.shape, choices.lines) {
            (Shape::Point(_), _) => (1, "fix"),
            (Shape::Line(_), Lines::Corridors) => (1, "corridor"),
            (Shape::Line(vertices), Lines::Tracks) => (vertices.len(), "leg"),
            (Shape::Area { .. }, _) => match zones(feature, choices.areas).len() {
                0 => (1, "scan"),
                zones => (zones, "zone"),
            },
        };
        let count = counts.iter_mut().find(|(_, name)| *name == what);
        count.into_iter().for_each(|(count, _)| *count += more);
    }
    counts
}

/// Where the legs of a drawing go, for people.
pub fn whereto(plan: &FlightPlan, selected: Option<&Selection>) -> Option<String> {
    new_leg::mission_aim(plan, selected, &Side::Behind).map(|aim| new_leg::words(&aim, plan))
}

/// The figures that are flown: a line as it is, or its points one by one.
fn flown_as(feature: &Feature, lines: Lines) -> Vec<Feature> {
    match (&feature.shape, lines) {
        (Shape::Line(vertices), Lines::Tracks) => {
            let at = |(number, vertex): (usize, &interchange::Vertex)| Feature {
                name: format!("{} {}", feature.name.trim(), number + 1).trim().to_owned(),
                shape: Shape::Point(vertex.clone()),
                ..feature.clone()
            };
            vertices.iter().enumerate().map(at).collect()
        }
        _ => vec![feature.clone()],
    }
}

/// Of our own exports: the path as flown and its runways are no drawing.
fn is_of_a_flight(feature: &Feature) -> bool {
    matches!(feature.mark("legwork"), Some("runway" | "path"))
}

/// What an area is a zone for, by its mark or as was chosen; `None`: it is scanned.
fn zone_kind(feature: &Feature, areas: Areas) -> Option<ZoneKind> {
    match (feature.mark("legwork"), areas) {
        (Some("keep-in"), _) => Some(ZoneKind::KeepIn),
        (Some("keep-out"), _) => Some(ZoneKind::KeepOut),
        (_, Areas::Scan) => None,
        (_, Areas::KeepIn) => Some(ZoneKind::KeepIn),
        (_, Areas::KeepOut) => Some(ZoneKind::KeepOut),
    }
}

/// A part of a plan that is not flown.
enum Part<'a> {
    Fix(&'a Feature, LatLon),
    Zone(DrawnZone),
}

impl Part<'_> {
    /// In a plan, at the end of its list.
    fn thing(self, plan: &FlightPlan) -> Thing {
        match self {
            Part::Fix(feature, at) => {
                let (name, description) = (feature.name.trim().to_owned(), feature.description.clone());
                Thing::Fix(Fix { name, description, ..create::fix(plan, at) })
            }
            Part::Zone(DrawnZone { name, kind, shape, .. }) => {
                Thing::Zone(Zone { name: name.trim().to_owned(), ..create::zone(plan, kind, shape) })
            }
        }
    }
}

/// The fix or the zones that a figure becomes; none: it is flown.
fn parts(feature: &Feature, areas: Areas) -> Vec<Part<'_>> {
    match &feature.shape {
        Shape::Point(vertex) => vec![Part::Fix(feature, vertex.position)],
        Shape::Area { .. } => zones(feature, areas).into_iter().map(Part::Zone).collect(),
        Shape::Line(_) => Vec::new(),
    }
}

/// The zones that an area becomes; none: it is scanned.
fn zones(feature: &Feature, areas: Areas) -> Vec<DrawnZone> {
    zone_kind(feature, areas).map_or(Vec::new(), |kind| interchange::zones_of(feature, kind))
}

/// Figures as legs, one behind the other. The sentence says why that can't be.
pub fn legs(
    features: &[Feature],
    mut at: Spot,
    mut approach: Option<Approach>,
    plan: &FlightPlan,
) -> Result<Pasted, String> {
    let mut plan = plan.clone();
    let (mut legs, mut edits) = (Vec::new(), Vec::new());
    for feature in features {
        has_places(feature)?;
        let (choice, drawn) = drawn(&feature.shape);
        let leg = new_leg::leg(choice, &drawn, &Aim::Spot(at.clone()), approach.take(), &plan);
        let mut leg =
            leg.ok_or_else(|| format!("Nothing can be made of {}: draw it larger.", feature.place))?;
        feature.name.trim().clone_into(&mut leg.name);
        keep_to_line(&mut leg);
        cut_holes(&mut leg, &feature.shape);
        let next = Spot::After(leg.id.clone());
        legs.push(leg.id.clone());
        let edit = create::insert(&plan, leg, std::mem::replace(&mut at, next));
        plan = edit.apply(&plan).map_err(|error| error.to_string())?;
        edits.push(edit);
    }
    Ok(Pasted { legs, things: Vec::new(), edit: Edit::All(edits) })
}

/// As many places as its shape needs: those that can't be read have been left out. The sentence says why it can't be drawn.
fn has_places(feature: &Feature) -> Result<(), String> {
    let on_earth =
        |vertices: &[interchange::Vertex]| vertices.iter().filter(|v| v.position.is_valid()).count();
    let (has, all, needs) = match &feature.shape {
        Shape::Point(vertex) => (usize::from(vertex.position.is_valid()), 1, 1),
        Shape::Line(line) => (on_earth(line), line.len(), 2),
        Shape::Area { outer, .. } => (outer.iter().filter(|at| at.is_valid()).count(), outer.len(), 3),
    };
    if has >= needs && has == all {
        return Ok(());
    }
    Err(format!(
        "{}: {has} of its coordinates can be read, and it needs {needs} or more, all of them on Earth: mend them (latitudes from -90 to 90, longitudes from -180 to 180) in the program that they come from.",
        feature.place
    ))
}

fn drawn(shape: &Shape) -> (LegChoice, Drawn) {
    let place = |at: LatLon| Place::Position(Value::Constant(at));
    match shape {
        Shape::Point(vertex) => (LegChoice::Tf, Drawn::Place(place(vertex.position))),
        Shape::Line(line) => {
            (LegChoice::Corridor, Drawn::Line(line.iter().map(|vertex| place(vertex.position)).collect()))
        }
        Shape::Area { outer, .. } => (LegChoice::Scan, Drawn::Area(outer.clone())),
    }
}

/// One track along a line that was drawn elsewhere: it is what is to be looked at. Who wants more makes the corridor wider.
fn keep_to_line(leg: &mut Leg) {
    if let LegKind::Pattern(Pattern::Corridor { width_m, spacing: Spacing::Metres(apart_m), .. }) =
        &mut leg.kind
    {
        width_m.clone_from(apart_m);
    }
}

fn cut_holes(leg: &mut Leg, shape: &Shape) {
    if let Shape::Area { holes: cut, .. } = shape
        && let LegKind::Scan(Scan { area: Area::Polygon { holes, .. }, .. }) = &mut leg.kind
    {
        holes.clone_from(cut);
    }
}

/// Answers the guide to a new mission. The sentence says why that can't be.
pub fn answer(features: &[Feature], guide: &Guide) -> Result<Answer, String> {
    if guide.threshold.is_none() {
        return begun(features, guide);
    }
    let figure = MissionFigure::of(guide.template)
        .ok_or("This mission has nothing that is drawn: choose another one.")?;
    let missing = || format!("There is no {} in what was copied, and the mission needs one.", figure.name());
    Ok(Answer::Mission(Extent::Drawn(points(features, figure).ok_or_else(missing)?)))
}

/// Before anything else is answered, a drawing says what is flown and where.
fn begun(features: &[Feature], guide: &Guide) -> Result<Answer, String> {
    let templates = [guide.template, Template::Corridor, Template::Survey].into_iter();
    let mut drawn = templates.filter_map(|of| Some((of, points(features, MissionFigure::of(of)?)?)));
    let (template, points) = drawn.next().ok_or("There is no line and no area in what was copied.")?;
    Ok(Answer::Form(Box::new(guide.begun_by(template, points))))
}

/// Of the first that is such a figure.
fn points(features: &[Feature], figure: MissionFigure) -> Option<Vec<LatLon>> {
    features.iter().find_map(|feature| match (figure, &feature.shape) {
        (MissionFigure::Line, Shape::Line(line)) => Some(line.iter().map(|vertex| vertex.position).collect()),
        (MissionFigure::Area, Shape::Area { outer, .. }) => Some(outer.clone()),
        _ => None,
    })
}
