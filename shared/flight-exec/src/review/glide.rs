//! `glide-out-of-reach`: if the engine fails at some point, no glide to the runway of the emergency plan that answers there gets to it;
//! `glide-into-terrain`: one would, if no hill were in its way; `glide-just-reached`: it gets there with less height to spare than its
//! margin. Each emergency plan has the worst of these once, with its share of the flight, the first place and the worst one.
//!
//! It is the judgement of a coverage ([`Rehearsal::worst`](crate::rehearse::Rehearsal::worst)): what is judged is no plan's way but what
//! an aircraft does with it ([`Best`]), for without an engine whatever the height does not suffice for is left out. To name a plan for an
//! engine failure makes nothing worse. What is flown near a runway ([`is_near_runway`]) is not counted.
//!
//! A coverage flies the glide besides, which for all points of a flight takes many times as long as its review: where the aircraft comes
//! down beside the runway all the same, only a coverage shows it.

use super::View;
use super::alternates::Origin;
use super::emergency_coverage::Engine;
use super::flights::points;
use crate::rehearse::{Best, Glide, Reach, is_near_runway, route};
use aircraft::glide::{GlideStart, glide};
use flight_plan::{EmergencyPlan, FlownAt, Id, Problem, Runway};
use geometry::LatLon;

/// Seconds between points from which a glide is tried, at least, and most points of a flight.
const EVERY_S: f64 = 5.0;
const MOST_POINTS: f64 = 2000.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    for (is_off_plan, points) in flown(view) {
        let glides = Tried::all(view, points);
        for plan in &view.program.flown().emergency_plans {
            let here: Vec<&Tried> = glides.iter().filter(|glide| *glide.plan == plan.id).collect();
            let found = Found::of(&here, glides.len());
            problems.extend(found.map(|found| found.problem(view, plan, is_off_plan)));
        }
    }
}

/// The glides from the flight as planned.
pub(super) fn on_planned_flight<'a>(view: &'a View) -> Vec<Tried<'a>> {
    flown(view).into_iter().next().map(|(_, points)| Tried::all(view, points)).unwrap_or_default()
}

/// Points of the flight as planned, then of those that take other branches (true); where none of them ends, of those that are laid out.
fn flown(view: &View) -> Vec<(bool, Vec<Origin>)> {
    let flights = &view.flights;
    let planned = flights.planned.iter().count();
    let every_s = |duration_s: f64| (duration_s / MOST_POINTS).max(EVERY_S);
    let whole = flights.whole().enumerate().map(|(index, flight)| {
        (index >= planned, points(flight, view.profile.energy_j, every_s(flight.time_s)))
    });
    let whole: Vec<_> = whole.collect();
    if whole.is_empty() { vec![(false, view.origins(EVERY_S).collect())] } else { whole }
}

/// The best glide from a point of a flight.
pub(super) struct Tried<'a> {
    pub from: Origin,
    /// The emergency plan that answers there, its runway, and whether it is named for an engine failure.
    pub plan: &'a Id,
    runway: &'a Runway,
    named: bool,
    glide: Glide,
    pub reach: Reach,
}

impl<'a> Tried<'a> {
    fn all(view: &'a View, points: Vec<Origin>) -> Vec<Self> {
        points.into_iter().filter_map(|from| Self::from(view, from)).collect()
    }

    /// `None`: it is not counted there, or nothing answers.
    fn from(view: &'a View, from: Origin) -> Option<Self> {
        view.stage_kind(&from.leg).filter(|kind| !is_near_runway(*kind))?;
        let Engine { plan, named } = view.emergency_coverage.engine(&from.leg)?;
        let plan = view.program.flown().emergency_plans.get(plan)?;
        let runway = view.program.plan.runway(&plan.runway)?;
        let air = (view.profile, view.conditions.wind.into(), view.terrain);
        let (way, reserve_m) = ((plan, runway, named), view.conditions.margins.glide_m);
        let best = Best::of(view.program, air, &view.variables, start(&from), way, reserve_m)?;
        let Best { glide, reach } = best;
        Some(Self { from, plan: &plan.id, runway, named, glide, reach })
    }

    /// So much higher it would arrive with its margin, metres; infinite if the wind does not let it.
    pub fn missing_m(&self, view: &View) -> f64 {
        view.conditions.margins.glide_m - self.glide.margin_m
    }
}

pub(super) fn start(from: &Origin) -> GlideStart {
    let Origin { position, altitude_amsl_m, course_deg, .. } = *from;
    GlideStart { position, altitude_amsl_m, course_deg }
}

/// The worst that becomes of the glides to the runway of one emergency plan.
struct Found<'a> {
    reach: Reach,
    /// The glides that end so; there is one.
    first: &'a Tried<'a>,
    all: Vec<&'a Tried<'a>>,
    /// Share of the flight on which they end so, and on which the runway is just reached, percent.
    percent: f64,
    just_percent: f64,
}

impl<'a> Found<'a> {
    /// `of`: the glides that were tried in all of the flight.
    fn of(glides: &[&'a Tried<'a>], of: usize) -> Option<Self> {
        let reach = glides.iter().map(|glide| glide.reach).min().filter(|reach| *reach < Reach::Good)?;
        let ending = |reach: Reach| glides.iter().copied().filter(move |glide| glide.reach == reach);
        let percent = |reach| (100.0 * ending(reach).count() as f64 / of.max(1) as f64).ceil();
        let (percent, just_percent) = (percent(reach), percent(Reach::Tight));
        Some(Self {
            reach,
            first: ending(reach).next()?,
            all: ending(reach).collect(),
            percent,
            just_percent,
        })
    }

    fn problem(&self, view: &View, plan: &EmergencyPlan, is_off_plan: bool) -> Problem {
        let without_hill = self.all.iter().filter(|glide| glide.glide.hill.is_none());
        let lowest = without_hill.max_by(|a, b| a.missing_m(view).total_cmp(&b.missing_m(view)));
        let (code, message, at) = match (self.reach, lowest) {
            (Reach::Out, Some(lowest)) => {
                ("glide-out-of-reach", self.out_of_reach(view, plan, lowest), lowest.from.position)
            }
            (_, Some(lowest)) => {
                ("glide-just-reached", self.just_reached(view, lowest), lowest.from.position)
            }
            (_, None) => {
                let hill = self.first.glide.hill.unwrap_or(self.first.from.position);
                ("glide-into-terrain", self.meets_hill(plan, hill), hill)
            }
        };
        let place = FlownAt { is_off_plan, ..FlownAt::from(at) };
        Problem::warning(code, message).of(&plan.id).with_place(place)
    }

    fn out_of_reach(&self, view: &View, plan: &EmergencyPlan, lowest: &Tried) -> String {
        let Self { percent, just_percent, first, .. } = self;
        let more = match *just_percent > 0.0 {
            true => format!(" and just reached on {just_percent:.0} % more"),
            false => String::new(),
        };
        let Tried { from, runway, .. } = lowest;
        let over_m = from.altitude_amsl_m - runway.elevation_amsl_m;
        let (plan, what) = (&plan.id, falls_short(view, plan, lowest));
        format!(
            "engine failure: runway out of glide on {percent:.0} % of the flight{more}, first on leg `{}`. Be ready to land elsewhere: at worst, from {from} ({over_m:.0} m above the runway), the best glide to `{}`, the runway of `{plan}`, {what}. Departure, arrival and approach are not counted: there an aircraft lands straight ahead",
            first.from.leg, runway.id
        )
    }

    /// As What if calls it: it gets there, but what it has to spare is less than it should be.
    fn just_reached(&self, view: &View, lowest: &Tried) -> String {
        let (percent, spare_m) = (self.percent, view.conditions.margins.glide_m);
        let comes = match lowest.glide.margin_m {
            over_m if over_m >= 0.0 => {
                format!("comes {over_m:.0} m above its threshold, and {spare_m:.0} m are to be spare")
            }
            over_m => format!("lacks {:.0} m to line up with it", -over_m),
        };
        format!(
            "engine failure: runway `{}` is just reached on {percent:.0} % of the flight. At worst, from {}, the best glide {comes}: fly {:.0} m higher there",
            lowest.runway.id,
            lowest.from,
            lowest.missing_m(view).ceil()
        )
    }

    fn meets_hill(&self, plan: &EmergencyPlan, hill: LatLon) -> String {
        let (LatLon { lat_deg, lon_deg }, percent) = (hill, self.percent);
        format!(
            "engine failure: a hill is in the way of the glide on {percent:.0} % of the flight. Fly higher there, or name another emergency plan for the cause `engine`: from {}, the glide to `{}`, the runway of `{}`, runs into a hill at {lat_deg:.5}, {lon_deg:.5}",
            self.first.from, self.first.runway.id, plan.id
        )
    }
}

/// How the worst glide ends, and what to do about it.
fn falls_short(view: &View, plan: &EmergencyPlan, lowest: &Tried) -> String {
    let missing_m = lowest.missing_m(view);
    if !missing_m.is_finite() {
        return "does not get there against the wind: fly nearer to it".into();
    }
    let short_m = (-lowest.glide.margin_m).max(0.0) * view.profile.glide_ratio;
    let away_m = lowest.from.position.distance_m(lowest.runway.threshold);
    let or = match (away_m - short_m).max(0.0) {
        reaches_m if reaches_m > 0.0 && !lowest.glide.along_plan => format!(
            ", or give the cause `engine` an emergency plan to a runway within {reaches_m:.0} m: that far it glides"
        ),
        _ => ", or give the cause `engine` an emergency plan to a nearer runway".into(),
    };
    let entry = entered(view, plan, lowest).unwrap_or_default();
    format!("ends {short_m:.0} m before it: fly {:.0} m higher there{or}{entry}", missing_m.ceil())
}

/// How high a glide comes to the entry of a plan that is named for an engine failure.
fn entered(view: &View, plan: &EmergencyPlan, lowest: &Tried) -> Option<String> {
    let way = route(view.program, plan, lowest.runway, &view.variables);
    let entry = way.first().filter(|_| lowest.named && way.len() > 1)?;
    let course_deg = lowest.from.position.bearing_deg(*entry);
    let points =
        glide(view.profile, view.conditions.wind.into(), start(&lowest.from), &[*entry], course_deg)?;
    let over_m = points.last()?.altitude_amsl_m - lowest.runway.elevation_amsl_m;
    let (over_m, where_to) = (over_m.abs(), if over_m < 0.0 { "below" } else { "above" });
    Some(format!("; at the entry of `{}` it would be {over_m:.0} m {where_to} the runway", plan.id))
}
