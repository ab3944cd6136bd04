//! Handles of a leg's numbers and choices: how far a place is along a line, or in which direction it lies, is the number.

pub use super::ruler::Ruler;

use super::axes::Axes;
use super::{Handle, Handled, Reader, bound_radius};
use crate::units::{self, Units};
use aircraft::Profile;
use flight_plan::{
    Area, Edit, FlightPlan, Holding, HoldingLength, Id, Leg, LegKind, Pattern, Place, Scan, ScanEntry,
    ScanStyle, Spacing, TurnDirection, Value, VariableValue,
};
use geometry::{LatLon, LocalFrame, Polygon, Vec2};

/// From a fix to the handle of the course that leads there, metres.
const COURSE_M: f64 = 500.0;
/// Handles of directions are so much farther out than what they turn.
const BEYOND: f64 = 1.25;
/// One turn more moves the handle of the turns by this share of the radius.
const TURN: f64 = 1.0 / 6.0;
/// The mark of the other side is so far from the middle, as a share of the radius.
const ASIDE: f64 = 0.75;

/// What people call a number that has a handle.
pub fn name(number: &str) -> &'static str {
    match number {
        "heading" => "Heading",
        "course" => "Course",
        "bearing" => "Bearing",
        "spacing" => "Spacing",
        "overshoot" => "Overshoot",
        "innerRadius" => "Inner radius",
        "width" => "Width",
        "length" => "Length",
        "time" => "Time",
        "turns" => "Turns",
        _ => "Value",
    }
}

/// A number with its name and unit.
pub fn words(number: &str, value: f64, u: Units) -> String {
    let shown = match number {
        "heading" | "course" | "bearing" => units::bearing(value),
        "time" => units::duration(value),
        "turns" => format!("{value:.0}"),
        _ => u.length().show(value),
    };
    format!("{} {shown}", name(number))
}

/// The edit that sets a number; of a number that is a variable, the variable's value at the start.
pub fn edit(plan: &FlightPlan, leg: &Id, number: &str, value: f64) -> Option<Edit> {
    let value = match number {
        "heading" | "course" | "bearing" | "overshoot" | "innerRadius" => value,
        _ => value.max(1.0),
    };
    let numbers = plan.any_leg(leg)?.numbers();
    let (_, now) = numbers.into_iter().find(|(name, _)| *name == number)?;
    let Some(Value::Expression(source)) = now else {
        let value = Some(Value::Constant(value));
        return Some(Edit::SetNumber { leg: leg.clone(), name: number.into(), value });
    };
    let (name, added) = bound_radius(source)?;
    let variable = plan.variable(&name)?;
    let least = variable.min.unwrap_or(f64::MIN);
    let value = (value - added).clamp(least, variable.max.unwrap_or(f64::MAX).max(least));
    Some(Edit::SetVariable { name, value: VariableValue::Number(value) })
}

/// The edit of a click on a mark that stands for a choice; `None`: it is none.
pub fn choice(plan: &FlightPlan, what: &Handled) -> Option<Edit> {
    let mut leg = plan.any_leg(what.leg()?)?.clone();
    match (what, &mut leg.kind) {
        (Handled::Entry { entry, .. }, LegKind::Scan(scan)) => {
            // once more: again the nearest
            scan.entry = if scan.entry == *entry { ScanEntry::Nearest } else { *entry };
        }
        (Handled::Side { .. }, kind) => {
            let turn = turn_mut(kind)?;
            *turn = other(*turn);
        }
        _ => return None,
    }
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

/// The edit that moves the centre of an arc.
pub fn move_arc_centre(plan: &FlightPlan, leg: &Id, to: LatLon) -> Option<Edit> {
    let mut leg = plan.any_leg(leg)?.clone();
    let LegKind::Rf { centre, .. } = &mut leg.kind else { return None };
    *centre = to;
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

/// The direction in which a leg turns, if it is a choice.
fn turn_mut(kind: &mut LegKind) -> Option<&mut TurnDirection> {
    match kind {
        LegKind::Hf(holding) | LegKind::Ha(holding) | LegKind::Hm { holding, .. } => Some(&mut holding.turn),
        LegKind::Orbit { turn, .. }
        | LegKind::Pattern(
            Pattern::Spiral { turn, .. }
            | Pattern::ExpandingSquare { turn, .. }
            | Pattern::Sector { turn, .. }
            | Pattern::Contour { turn, .. }
            | Pattern::FigureEight { turn, .. },
        ) => Some(turn),
        _ => None,
    }
}

fn other(turn: TurnDirection) -> TurnDirection {
    match turn {
        TurnDirection::Left => TurnDirection::Right,
        TurnDirection::Right => TurnDirection::Left,
    }
}

/// The handles of a leg's numbers and choices.
pub(super) fn handles(leg: &Leg, reader: &Reader<'_>) -> Vec<Handle> {
    let mut maker = Maker { leg, reader, handles: Vec::new() };
    // a leg whose values are not known yet has none
    let _ = maker.add();
    maker.handles
}

struct Maker<'a> {
    leg: &'a Leg,
    reader: &'a Reader<'a>,
    handles: Vec<Handle>,
}

impl Maker<'_> {
    fn add(&mut self) -> Option<()> {
        match &self.leg.kind {
            LegKind::Rf { centre, .. } if centre.is_valid() => {
                self.put(Handled::ArcCentre(self.leg.id.clone()), *centre);
            }
            LegKind::Cf { to, course_deg } => self.course(&to.place, course_deg, 180.0)?,
            LegKind::Fa { from, course_deg } => self.course(&from.place, course_deg, 0.0)?,
            LegKind::Hf(holding) | LegKind::Ha(holding) | LegKind::Hm { holding, .. } => {
                self.holding(holding)?
            }
            LegKind::Orbit { centre, radius_m, turns, .. } => {
                self.other_way(centre, radius_m)?;
                self.turns(centre, 180.0, turns, radius_m, 1.0)?;
            }
            LegKind::Scan(scan) => self.scan(scan)?,
            LegKind::Pattern(pattern) => self.pattern(pattern)?,
            LegKind::Call(call) => {
                let from = self.reader.place(call.anchor.as_ref()?)?;
                let bearing_deg = self.reader.number(call.bearing_deg.as_ref()?)?;
                self.number("bearing", bearing_deg, Ruler::Around { from, plus_deg: 0.0 }, COURSE_M);
            }
            _ => {}
        }
        Some(())
    }

    fn put(&mut self, what: Handled, at: LatLon) {
        self.handles.push(Handle { what, at });
    }

    fn number(&mut self, number: &'static str, value: f64, ruler: Ruler, far_m: f64) {
        let at = ruler.place(value, far_m);
        if at.is_valid() {
            self.put(Handled::Number { leg: self.leg.id.clone(), number, ruler }, at);
        }
    }

    fn course(&mut self, place: &Place, course_deg: &Value<f64>, plus_deg: f64) -> Option<()> {
        let from = self.reader.place(place)?;
        let course_deg = self.reader.number(course_deg)?;
        self.number("course", course_deg, Ruler::Around { from, plus_deg }, COURSE_M);
        Some(())
    }

    /// Course and length at the outbound end; the side on the other side of the inbound course.
    fn holding(&mut self, holding: &Holding) -> Option<()> {
        let from = self.reader.place(&holding.fix.place)?;
        let course_deg = match &holding.inbound_course_deg {
            Some(course) => self.reader.number(course)?,
            None => 0.0,
        };
        let profile = Profile::by_name(&self.reader.plan.aircraft).unwrap_or_default();
        let (number, value, per_m) = match &holding.leg {
            HoldingLength::Distance(metres) => ("length", self.reader.number(metres)?, 1.0),
            HoldingLength::Time(seconds) => {
                ("time", self.reader.number(seconds)?, 1.0 / profile.cruise_airspeed_mps)
            }
        };
        let (length_m, out_deg) = (value / per_m, course_deg + 180.0);
        self.number(number, value, Ruler::Along { from, bearing_deg: out_deg, per_m }, 0.0);
        let around = Ruler::Around { from, plus_deg: 180.0 };
        self.number("course", course_deg, around, length_m * BEYOND + COURSE_M / 4.0);
        let aside_deg = if holding.turn == TurnDirection::Right { -90.0 } else { 90.0 };
        let turn_m = 2.0 * profile.turn_radius_m(profile.cruise_airspeed_mps);
        let middle = from.destination(out_deg, length_m / 2.0);
        let what = Handled::Side { leg: self.leg.id.clone(), is_holding: true };
        self.put(what, middle.destination(course_deg + aside_deg, turn_m));
        Some(())
    }

    /// A click on the mark in a circle turns the leg the other way.
    fn other_way(&mut self, centre: &Place, radius_m: &Value<f64>) -> Option<()> {
        let (centre, radius_m) = (self.reader.place(centre)?, self.reader.number(radius_m)?);
        let at = centre.destination(225.0, radius_m * ASIDE);
        self.put(Handled::Side { leg: self.leg.id.clone(), is_holding: false }, at);
        Some(())
    }

    /// Outwards from a place so many radii from the middle, a step for each turn.
    fn turns(
        &mut self,
        centre: &Place,
        bearing_deg: f64,
        turns: &Value<f64>,
        radius_m: &Value<f64>,
        radii: f64,
    ) -> Option<()> {
        let (centre, radius_m) = (self.reader.place(centre)?, self.reader.number(radius_m)?);
        let (turns, per_m) = (self.reader.number(turns)?, 1.0 / (radius_m * TURN).max(1.0));
        let from = centre.destination(bearing_deg, radius_m * radii);
        self.number("turns", turns, Ruler::Along { from, bearing_deg, per_m }, 0.0);
        Some(())
    }

    fn scan(&mut self, scan: &Scan) -> Option<()> {
        let (frame, corners) = self.outline(&scan.area)?;
        let set = scan.heading_deg.as_ref().and_then(|heading| self.reader.number(heading));
        let fewest = || Polygon::new(corners.clone(), Vec::new()).ok().map(|p| p.fewest_tracks_heading_deg());
        let heading_deg = set.or_else(fewest)?;
        let along = Axes::of(&corners, heading_deg);
        // creeping lines run across the heading
        let tracks_deg = if scan.style == ScanStyle::Creeping { heading_deg + 90.0 } else { heading_deg };
        let tracks = Axes::of(&corners, tracks_deg);
        let from = frame.to_geo(along.middle());
        let far_m = along.half_m() * BEYOND + 50.0;
        self.number("heading", heading_deg, Ruler::Around { from, plus_deg: 0.0 }, far_m);
        // beside the middle, where an outline has a mark
        let aside = frame.to_geo(tracks.place(0.0, 0.4));
        self.spacing(&scan.spacing, Ruler::Along { from: aside, bearing_deg: tracks_deg + 90.0, per_m: 1.0 });
        if let Some(overshoot_m) = self.reader.number(&scan.overshoot_m) {
            let end = frame.to_geo(tracks.place(0.4, -1.0));
            let ruler = Ruler::Along { from: end, bearing_deg: tracks_deg + 180.0, per_m: 1.0 };
            self.number("overshoot", overshoot_m, ruler, 0.0);
        }
        for (entry, across, along) in [
            (ScanEntry::StartLeft, -1.0, -1.0),
            (ScanEntry::StartRight, 1.0, -1.0),
            (ScanEntry::EndLeft, -1.0, 1.0),
            (ScanEntry::EndRight, 1.0, 1.0),
        ] {
            let what = Handled::Entry { leg: self.leg.id.clone(), entry, chosen: scan.entry == entry };
            self.put(what, frame.to_geo(tracks.place(across * 0.75, along * 1.2)));
        }
        Some(())
    }

    /// An area's outline in a plane.
    fn outline(&self, area: &Area) -> Option<(LocalFrame, Vec<Vec2>)> {
        let ring = match area {
            Area::Circle { centre, radius_m } => {
                let (centre, radius_m) = (self.reader.place(centre)?, self.reader.number(radius_m)?);
                (0..12).map(|i| centre.destination(f64::from(i) * 30.0, radius_m)).collect()
            }
            Area::Polygon { corners, .. } => corners.clone(),
            Area::Expression(source) => self.reader.polygon(source)?,
        };
        let frame = LocalFrame::around(&ring)?;
        let corners = ring.iter().map(|at| frame.to_local(*at)).collect();
        Some((frame, corners))
    }

    /// What a camera sees has no handle.
    fn spacing(&mut self, spacing: &Spacing, ruler: Ruler) {
        if let Spacing::Metres(metres) = spacing
            && let Some(metres) = self.reader.number(metres)
        {
            self.number("spacing", metres, ruler, 0.0);
        }
    }

    fn pattern(&mut self, pattern: &Pattern) -> Option<()> {
        match pattern {
            Pattern::Spiral { centre, inner_radius_m, outer_radius_m, spacing, .. } => {
                self.other_way(centre, outer_radius_m)?;
                let from = self.reader.place(centre)?;
                let inner_m = self.reader.number(inner_radius_m)?;
                let ruler = Ruler::Along { from, bearing_deg: 270.0, per_m: 1.0 };
                self.number("innerRadius", inner_m, ruler, 0.0);
                let rim = from.destination(0.0, self.reader.number(outer_radius_m)?);
                self.spacing(spacing, Ruler::Along { from: rim, bearing_deg: 180.0, per_m: 1.0 });
            }
            Pattern::ExpandingSquare { centre, spacing, heading_deg, radius_m, .. } => {
                self.other_way(centre, radius_m)?;
                let heading_deg = self.heading(centre, heading_deg, radius_m)?;
                let from = self.reader.place(centre)?;
                self.spacing(spacing, Ruler::Along { from, bearing_deg: heading_deg, per_m: 1.0 });
            }
            Pattern::Sector { centre, radius_m, heading_deg, .. } => {
                self.other_way(centre, radius_m)?;
                self.heading(centre, heading_deg, radius_m)?;
            }
            Pattern::FigureEight { centre, radius_m, heading_deg, turns, .. } => {
                self.other_way(centre, radius_m)?;
                let heading_deg = self.heading(centre, heading_deg, radius_m)?;
                self.turns(centre, heading_deg + 180.0, turns, radius_m, 0.25)?;
            }
            Pattern::Corridor { route, width_m, spacing } => {
                let (from, way_deg) = self.beside(route)?;
                let width_m = self.reader.number(width_m)?;
                let right = Ruler::Along { from, bearing_deg: way_deg + 90.0, per_m: 2.0 };
                self.number("width", width_m, right, 0.0);
                self.spacing(spacing, Ruler::Along { from, bearing_deg: way_deg - 90.0, per_m: 1.0 });
            }
            Pattern::TrackLine { route, spacing, .. } => {
                let (from, way_deg) = self.beside(route)?;
                self.spacing(spacing, Ruler::Along { from, bearing_deg: way_deg + 90.0, per_m: 2.0 });
            }
            Pattern::Contour { area, spacing, inward, .. } => {
                let (frame, corners) = self.outline(area)?;
                let within = frame.to_geo(*corners.first()? * 0.5);
                self.put(Handled::Side { leg: self.leg.id.clone(), is_holding: false }, within);
                // beside the middle, where the outline has a mark
                let edge = *corners.first()? * 0.7 + *corners.get(1)? * 0.3;
                let in_deg = (edge * -1.0).bearing_rad().to_degrees();
                let bearing_deg = if *inward { in_deg } else { in_deg + 180.0 };
                self.spacing(spacing, Ruler::Along { from: frame.to_geo(edge), bearing_deg, per_m: 1.0 });
            }
        }
        Some(())
    }

    fn heading(&mut self, centre: &Place, heading_deg: &Value<f64>, radius_m: &Value<f64>) -> Option<f64> {
        let from = self.reader.place(centre)?;
        let heading_deg = self.reader.number(heading_deg)?;
        let far_m = self.reader.number(radius_m)? * BEYOND;
        self.number("heading", heading_deg, Ruler::Around { from, plus_deg: 0.0 }, far_m);
        Some(heading_deg)
    }

    /// A quarter along the first part of a route, clear of the mark in its middle; and which way it goes.
    fn beside(&self, route: &[Place]) -> Option<(LatLon, f64)> {
        let (from, to) = (self.reader.place(route.first()?)?, self.reader.place(route.get(1)?)?);
        Some((from.interpolate(to, 0.25), from.bearing_deg(to)))
    }
}
