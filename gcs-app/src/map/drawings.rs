//! Drawings of other programs, on the clipboard or in a file that is added to the plan: a line becomes a corridor, an area is scanned, a point is a waypoint.

use super::tools::new_leg::{self, Aim, Side};
use crate::command::Selection;
use crate::formats::{FileFormat, label};
use crate::guide::{Answer, Guide, MissionFigure};
use flight_plan::clipboard::{MAX_BYTES, Pasted};
use flight_plan::create::{self, Approach, Drawn, LegChoice};
use flight_plan::template::Extent;
use flight_plan::{
    Area, Edit, Fix, FlightPlan, Leg, LegKind, Place, Scan, Spot, Thing, Value, Zone, ZoneKind, ZoneShape,
};
use geometry::LatLon;
use interchange::{Areas, Feature, Format, Shape};
use std::path::Path;

/// Most figures that are pasted at once.
const MOST: usize = 100;

/// What a text draws; `None`: it is no drawing. The sentence says why it can't be pasted.
pub fn read(text: &str) -> Option<Result<Vec<Feature>, String>> {
    let format = match FileFormat::of(Path::new("clipboard"), text.as_bytes()) {
        FileFormat::Other(format @ (Format::Kml | Format::GeoJson | Format::Gpx)) => format,
        _ => return None,
    };
    Some(features(format, text).map_err(|why| format!("That {} can't be pasted: {why}.", label(format))))
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
    areas: Areas,
    plan: &FlightPlan,
    selected: Option<&Selection>,
) -> Result<Pasted, String> {
    may_add(features)?;
    let mut with = plan.clone();
    let (mut flown, mut edits, mut things) = (Vec::new(), Vec::new(), Vec::new());
    for feature in features.iter().filter(|feature| !is_of_a_flight(feature)) {
        match thing(feature, areas, &with) {
            Some(thing) => {
                let edit = Edit::Add(Box::new(thing.clone()));
                with = edit.apply(&with).map_err(|error| error.to_string())?;
                edits.push(edit);
                things.push(thing);
            }
            None => flown.push(feature.clone()),
        }
    }
    if flown.is_empty() {
        return Ok(Pasted { legs: Vec::new(), things, edit: Edit::All(edits) });
    }
    let Some(Aim::Spot(at)) = new_leg::aim(&with, selected, &Side::Behind) else {
        return Err("This plan has no stage to add legs to: add one in the plan's list (＋).".into());
    };
    let Pasted { legs, edit, .. } = legs(&flown, at, None, &with)?;
    edits.push(edit);
    Ok(Pasted { legs, things, edit: Edit::All(edits) })
}

/// So many figures can be added to a plan.
pub fn may_add(features: &[Feature]) -> Result<(), String> {
    match features.len() {
        0..=MOST => Ok(()),
        has => Err(format!("It has {has} figures, and {MOST} can be added to a plan at once.")),
    }
}

/// Of our own exports: the path as flown and its runways are no drawing.
fn is_of_a_flight(feature: &Feature) -> bool {
    matches!(feature.mark("legwork"), Some("runway" | "path"))
}

/// `None`: it is flown.
fn thing(feature: &Feature, areas: Areas, plan: &FlightPlan) -> Option<Thing> {
    let name = feature.name.trim().to_owned();
    let marked = match feature.mark("legwork") {
        Some("keep-in") => Some(ZoneKind::KeepIn),
        Some("keep-out") => Some(ZoneKind::KeepOut),
        _ => None,
    };
    let chosen = match areas {
        Areas::Scan => None,
        Areas::KeepIn => Some(ZoneKind::KeepIn),
        Areas::KeepOut => Some(ZoneKind::KeepOut),
    };
    match &feature.shape {
        Shape::Point(vertex) => {
            let description = feature.description.clone();
            Some(Thing::Fix(Fix { name, description, ..create::fix(plan, vertex.position) }))
        }
        Shape::Area { outer, .. } => {
            let shape = ZoneShape::Polygon(outer.clone());
            Some(Thing::Zone(Zone { name, ..create::zone(plan, marked.or(chosen)?, shape) }))
        }
        Shape::Line(_) => None,
    }
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
        let (choice, drawn) = drawn(&feature.shape);
        let leg = new_leg::leg(choice, &drawn, &Aim::Spot(at.clone()), approach.take(), &plan);
        let mut leg =
            leg.ok_or_else(|| format!("Nothing can be made of {}: draw it larger.", feature.place))?;
        feature.name.trim().clone_into(&mut leg.name);
        cut_holes(&mut leg, &feature.shape);
        let next = Spot::After(leg.id.clone());
        legs.push(leg.id.clone());
        let edit = create::insert(&plan, leg, std::mem::replace(&mut at, next));
        plan = edit.apply(&plan).map_err(|error| error.to_string())?;
        edits.push(edit);
    }
    Ok(Pasted { legs, things: Vec::new(), edit: Edit::All(edits) })
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

fn cut_holes(leg: &mut Leg, shape: &Shape) {
    if let Shape::Area { holes: cut, .. } = shape
        && let LegKind::Scan(Scan { area: Area::Polygon { holes, .. }, .. }) = &mut leg.kind
    {
        holes.clone_from(cut);
    }
}

/// Answers the guide to a new mission. The sentence says why that can't be.
pub fn answer(features: &[Feature], guide: &Guide) -> Result<Answer, String> {
    let figure = MissionFigure::of(guide.template)
        .ok_or("This mission has nothing that is drawn: choose another one.")?;
    if guide.threshold.is_none() {
        return Err("Say where you fly first: click there, or type it into the card.".into());
    }
    let found = features.iter().find_map(|feature| match (figure, &feature.shape) {
        (MissionFigure::Line, Shape::Line(line)) => Some(line.iter().map(|vertex| vertex.position).collect()),
        (MissionFigure::Area, Shape::Area { outer, .. }) => Some(outer.clone()),
        _ => None,
    });
    let missing = || format!("There is no {} in what was copied, and the mission needs one.", figure.name());
    let points: Vec<LatLon> = found.ok_or_else(missing)?;
    Ok(Answer::Mission(Extent::Drawn(points)))
}
