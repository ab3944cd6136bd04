//! What an emergency plan gets besides the places that are drawn: the hold where its final begins, and the final down to the runway.

use super::Canvas;
use crate::map::polyline::{self, Style};
use crate::map::text;
use crate::map::view::Mercator;
use crate::theme::Palette;
use aircraft::Profile;
use egui::{Align2, Painter, Stroke, vec2};
use flight_plan::create::{self, WayHome};
use flight_plan::{Id, LegKind, Place, transform};
use geometry::LatLon;

/// All that would be made of the places that were clicked so far.
#[derive(Debug, Default)]
pub struct Besides {
    made_of: Option<Asked>,
    made: Option<Made>,
}

/// What it is made of: a click changes it, the pointer does not.
#[derive(Debug, PartialEq)]
struct Asked {
    version: u64,
    runway: Id,
    outwards: Vec<Place>,
}

#[derive(Debug)]
struct Made {
    /// As it would be flown, from its first place to the threshold.
    line: Vec<LatLon>,
    /// Where it holds.
    hold: LatLon,
}

impl Besides {
    /// Of the way to this runway over these places, from the runway outwards; worked out anew only when they are others.
    pub fn follow(&mut self, way: Option<(&Id, Vec<Place>)>, canvas: &Canvas<'_>) {
        let version = canvas.scene.document.version();
        let asked = way.map(|(runway, outwards)| Asked { version, runway: runway.clone(), outwards });
        if asked != self.made_of {
            self.made = asked.as_ref().and_then(|asked| make(asked, canvas));
            self.made_of = asked;
        }
    }

    /// Draws it, and says what it is.
    pub fn paint(&self, painter: &Painter, canvas: &Canvas<'_>, p: &Palette) {
        let Some(made) = &self.made else { return };
        let line: Vec<Mercator> = made.line.iter().map(|at| (*at).into()).collect();
        let parts = polyline::visible_parts(&line, canvas.view);
        polyline::draw(painter, &parts, Stroke::new(2.0, p.contingency), Style::Dotted, p.halo);
        let hold = canvas.view.place(made.hold);
        painter.circle(hold, 4.5, p.halo, Stroke::new(2.0, p.contingency));
        let beside = hold + vec2(8.0, 8.0);
        text::haloed(painter, beside, Align2::LEFT_TOP, "Enter adds hold and final", 11.5, p.text, p);
    }
}

fn make(asked: &Asked, canvas: &Canvas<'_>) -> Option<Made> {
    let plan = canvas.scene.document.plan();
    let runway = plan.runway(&asked.runway)?;
    let way = WayHome { runway, outwards: &asked.outwards, from: None };
    let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
    let (id, edit) = create::emergency_plan(plan, way, &profile, canvas.scene.layers.ground().as_ref());
    let plan = edit.apply(plan).ok()?;
    let legs = || plan.emergency_plan(&id).into_iter().flat_map(|made| &made.stages).flat_map(|s| &s.legs);
    let holds = |kind: &LegKind| matches!(kind, LegKind::Ha(_) | LegKind::Hf(_));
    let hold = legs().find(|leg| holds(&leg.kind)).and_then(|leg| transform::places(&plan, leg).pop())?;
    let line = legs().flat_map(|leg| transform::places(&plan, leg)).chain([runway.threshold]).collect();
    Some(Made { line, hold })
}
