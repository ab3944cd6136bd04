//! `alternate-out-of-reach`: at some point the energy left, all of it, does not last for the emergency plan that answers there.

use super::View;
use super::alternates::{Alternate, Origin, alternates, flying_s};
use aircraft::power::demanded_power_w;
use flight_plan::Problem;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let origins = view.origins_with_energy();
    for (index, alternate) in alternates(view) {
        let applies = |from: &&Origin| view.emergency_coverage.powered(&from.leg).contains(&index);
        let from_here = origins.iter().filter(|from| alternate.is_from(view, from));
        let missing = from_here.filter(applies).map(|from| (missing_j(view, &alternate, from), from));
        let worst = missing.max_by(|(a, _), (b, _)| a.total_cmp(b));
        if let Some((missing_j, from)) = worst.filter(|(missing_j, _)| *missing_j > 0.0) {
            problems.push(problem(view, &alternate, from, missing_j));
        }
    }
}

/// Energy that is lacking at a point, joules; infinite if the wind does not let the aircraft there.
fn missing_j(view: &View, alternate: &Alternate, from: &Origin) -> f64 {
    let profile = view.profile;
    let Some(time_s) = flying_s(profile, from.position, alternate.entry, view.conditions.wind) else {
        return f64::INFINITY;
    };
    let level_j = time_s * demanded_power_w(profile, profile.cruise_airspeed_mps, 0.0, 1.0);
    let climb_m = (alternate.entry_amsl_m - from.altitude_amsl_m).max(0.0);
    let needed_j = level_j + climb_m * profile.climb_power_w_per_mps + alternate.energy_j;
    needed_j - (profile.energy_j - from.used_j)
}

fn problem(view: &View, alternate: &Alternate, from: &Origin, missing_j: f64) -> Problem {
    let since = if view.flights.under_way { "from now" } else { "after the start" };
    let message = format!(
        "shorten the plan, or name a nearer emergency plan: from {from}, {:.0} min {since}, `{}` {} runway `{}`",
        from.time_s / 60.0,
        alternate.plan.id,
        lack(missing_j),
        alternate.runway.id
    );
    Problem::error("alternate-out-of-reach", message).of(&from.leg)
}

fn lack(missing_j: f64) -> String {
    match missing_j.is_finite() {
        true => format!("lacks {:.0} kJ to", missing_j / 1e3),
        false => "comes against this wind never to".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::flights::Flights;
    use super::*;
    use crate::review::Conditions;
    use aircraft::Profile;
    use flight_plan::Variables;
    use std::sync::Arc;
    use terrain::Terrain;

    /// The bounded layout may end hours before the flight, which is where the least energy is left.
    #[test]
    fn a_leg_that_only_the_preview_comes_to_is_looked_at_too() {
        let document = include_bytes!("../../../../assets/plans/alternates.xml");
        let terrain: Arc<dyn Terrain> = Arc::new(terrain::Flat(300.0));
        let usual = Profile::default();
        let (program, _) =
            flight_plan::compile_reading(flight_plan::read(document), &usual, terrain.as_ref()).unwrap();
        let (program, conditions) = (Arc::new(program), Conditions::default());
        let flights = |profile: &Profile| Flights::of(&program, profile, &terrain, conditions);
        let planned_j = flights(&usual).planned.unwrap().energy_j;
        let tired = Profile { energy_j: 1.02 * planned_j, ..usual };
        let found = |most_waypoints: usize| {
            let mut flights = flights(&tired);
            flights.main.iter_mut().for_each(|flown| flown.waypoints.truncate(most_waypoints));
            let variables = Variables::initial(program.flown());
            let view = View::new(&program, &tired, terrain.as_ref(), conditions, variables, flights);
            let mut problems = vec![];
            check(&view, &mut problems);
            problems.into_iter().map(|problem| problem.subject).collect::<Vec<_>>()
        };
        assert_ne!(found(usize::MAX), []);
        assert_eq!(found(2), found(usize::MAX));
    }

    #[test]
    fn what_no_energy_reaches_is_said_in_words() {
        assert_eq!(lack(1_500.0), "lacks 2 kJ to");
        assert!(!lack(f64::INFINITY).contains("inf"));
    }
}
