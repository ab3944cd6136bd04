//! What is made of answers and drawings, with the ground below.

use super::{App, even};
use crate::airfields::Ground;
use crate::command::Selection;
use crate::guide::Guide;
use crate::runways;
use aircraft::Profile;
use flight_plan::create::WayHome;
use flight_plan::template::Outline;
use flight_plan::{Altitude, AltitudeReference, Edit, FlightPlan, Id, Place, Runway, Thing, Value, create};
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// So many directions of a runway are tried around its threshold, where nobody has said one.
const HEADINGS: u32 = 12;

impl App {
    /// A step that can be undone, like any other.
    pub(super) fn create(&mut self, mut outline: Outline) {
        let profile = Profile::by_name(&outline.aircraft).unwrap_or_default();
        // what was wrong with the answers is over
        self.view.notice = None;
        let ground = self.ground(outline.runway.threshold);
        // the form has shown who knows it
        if ground == Ground::Unknown {
            self.tell_ground(ground);
        }
        outline.runway.elevation_amsl_m = ground.amsl_m().round();
        let asked = outline.runway.id.clone();
        let others = self.other_runways(&outline.runway);
        let outline = outline.flyable(others, &profile, self.layers.ground().as_ref());
        if outline.runway.id != asked {
            let runway = &outline.runway.id;
            let why = format!(
                "The ground around leaves no way to {asked}: the plan takes off and lands on {runway}"
            );
            self.view.notice = Some(why);
        }
        self.document.replace(outline.plan(&profile, self.layers.ground().as_ref()));
        self.view.guide.is_made = true;
        self.map.fit();
    }

    /// What else a runway may be: its other direction, and where nobody said in which it lies, any other around its threshold.
    fn other_runways(&self, runway: &Runway) -> Vec<Runway> {
        let none = FlightPlan::default();
        let is_blind =
            runway.heading_deg == Guide::default().heading_deg && self.view.guide.landing().is_none();
        let turned = (1..if is_blind { HEADINGS } else { 1 }).map(|turn| {
            let heading_deg = runway.heading_deg + 360.0 * f64::from(turn) / f64::from(HEADINGS);
            let end = runway.threshold.destination(heading_deg, runway.length_m);
            Runway { priority: 1, ..create::runway(&none, runway.threshold, end, runway.elevation_amsl_m) }
        });
        let far_end = runway.from_other_end().threshold;
        let other = create::other_direction(&none, runway, self.ground(far_end).amsl_m());
        std::iter::once(Runway { priority: 1, ..other }).chain(turned).collect()
    }

    fn ground(&self, at: LatLon) -> Ground {
        Ground::of(self.layers.ground().as_ref(), at)
    }

    fn tell_ground(&mut self, ground: Ground) {
        self.view.notice = Some(format!("The ground is {}", ground.words(self.view.units)));
    }

    /// What is against a runway there, if something is. Where one lies, that is selected, and gets the direction that it lacks.
    pub(super) fn add_runway(
        &mut self,
        threshold: LatLon,
        end: LatLon,
        both: bool,
    ) -> Result<Option<String>, String> {
        let ways = [(threshold, end), (end, threshold)];
        let mut plan = self.document.plan().as_ref().clone();
        if let Some(there) = create::lying_there(&plan, threshold, end) {
            let against = normalise_180(there.heading_deg - threshold.bearing_deg(end)).abs() > 90.0;
            let there = there.id.clone();
            return self.lies_already(&there, both || against).map(Some);
        }
        let mut edits = Vec::new();
        let mut made = None;
        for (threshold, end) in ways.into_iter().take(if both { 2 } else { 1 }) {
            let ground = self.ground(threshold);
            if !matches!(ground, Ground::Elevations(_)) {
                self.tell_ground(ground);
            }
            let runway = create::runway(&plan, threshold, end, ground.amsl_m());
            made = made.or_else(|| Some(runway.id.clone()));
            // the second is called as nothing is then
            plan.runways.push(runway.clone());
            edits.push(Edit::Add(Box::new(Thing::Runway(runway))));
        }
        self.document.edit(&Edit::All(edits))?;
        self.view.select(made.map(Selection::Runway));
        Ok(even::objection(self.layers.ground().as_ref(), threshold, end, self.view.units))
    }

    fn lies_already(&mut self, there: &Id, both: bool) -> Result<String, String> {
        let ground = self.layers.ground();
        let lacks = runways::add_other_direction(self.document.plan(), there, ground.as_ref());
        let Some((other, edit)) = lacks.ok().filter(|_| both) else {
            self.view.select(Some(Selection::Runway(there.clone())));
            return Ok(format!("Runway {there} lies there already: it is selected"));
        };
        self.document.edit(&edit)?;
        let text = format!("Runway {there} lies there already: {other}, its other direction, was added");
        self.view.select(Some(Selection::Runway(other)));
        Ok(text)
    }

    /// What should be known of the plan that was made: that nothing names it, or that it climbs, if that is so.
    pub(super) fn bring_home(
        &mut self,
        runway: &Id,
        outwards: &[Place],
        from: Option<(LatLon, f64)>,
    ) -> Result<Vec<String>, String> {
        let plan = self.document.plan().clone();
        let Some(runway) = plan.runway(runway) else { return Ok(Vec::new()) };
        let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
        let ground = self.layers.ground().as_ref();
        let (id, edit) = create::emergency_plan(&plan, WayHome { runway, outwards, from }, &profile, ground);
        self.document.edit(&edit)?;
        let made = self.document.plan();
        let is_named = made.emergency.by_cause.iter().any(|(_, named)| *named == id);
        let text = format!(
            "Nothing leads to “{}” yet: drag its row onto a leg, a stage or the main plan",
            made.label(&id)
        );
        let climb_m =
            from.and_then(|(_, from_m)| Some(begins_amsl_m(made, &id)? - from_m)).filter(|m| *m > 1.0);
        let climbs = climb_m.map(|climb_m| {
            format!(
                "“{}” begins {} above the path where it was drawn from: the ground on its way asks for that",
                made.label(&id),
                self.view.units.altitude().show(climb_m)
            )
        });
        self.view.select(Some(Selection::Emergency(id)));
        Ok((!is_named).then_some(text).into_iter().chain(climbs).collect())
    }
}

/// How high an emergency plan begins, metres AMSL.
fn begins_amsl_m(plan: &FlightPlan, emergency: &Id) -> Option<f64> {
    let first = plan.emergency_plan(emergency)?.stages.first()?.legs.first()?;
    let Altitude { metres: Value::Constant(metres), reference } = first.altitude.as_ref()? else {
        return None;
    };
    match reference {
        AltitudeReference::Amsl => Some(*metres),
        AltitudeReference::Home => Some(metres + plan.common_home()?.elevation_amsl_m),
        AltitudeReference::Agl => None,
    }
}
