//! What is made of answers and drawings, with the ground below.

use super::App;
use crate::airfields::Ground;
use crate::command::Selection;
use aircraft::Profile;
use flight_plan::template::Outline;
use flight_plan::{Edit, Id, Place, Thing, create};
use geometry::LatLon;

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
        self.document.replace(outline.plan(&profile, self.layers.ground().as_ref()));
        self.view.guide.is_made = true;
        self.map.fit();
    }

    fn ground(&self, at: LatLon) -> Ground {
        Ground::of(self.layers.ground().as_ref(), at)
    }

    fn tell_ground(&mut self, ground: Ground) {
        self.view.notice = Some(format!("The ground is {}", ground.words(self.view.units)));
    }

    pub(super) fn add_runway(&mut self, threshold: LatLon, end: LatLon, both: bool) -> Result<(), String> {
        let ways = [(threshold, end), (end, threshold)];
        let mut plan = self.document.plan().as_ref().clone();
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
        Ok(())
    }

    /// What should be known of the plan that was made: that nothing names it, if that is so.
    pub(super) fn bring_home(&mut self, runway: &Id, outwards: &[Place]) -> Result<Option<String>, String> {
        let plan = self.document.plan().clone();
        let Some(runway) = plan.runway(runway) else { return Ok(None) };
        let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
        let ground = self.layers.ground().as_ref();
        let (id, edit) = create::emergency_plan(&plan, runway, outwards, &profile, ground);
        self.document.edit(&edit)?;
        let made = self.document.plan();
        let is_named = made.emergency.by_cause.iter().any(|(_, named)| *named == id);
        let text = format!(
            "Nothing leads to “{}” yet: drag its row onto a leg, a stage or the main plan",
            made.label(&id)
        );
        self.view.select(Some(Selection::Emergency(id)));
        Ok((!is_named).then_some(text))
    }
}
