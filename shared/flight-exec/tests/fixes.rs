//! Every fix that is offered leads on: a plan never comes to be again what it was before.
#![cfg(test)]

use aircraft::Profile;
use flight_exec::{Conditions, compile_and_review};
use flight_plan::template::{Extent, Outline, Template};
use flight_plan::{AltitudeReference, Edit, FlightPlan, Problem, Runway, read, write};
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain};

/// More than any of these plans needs.
const MOST_FIXES: usize = 16;

fn circuit() -> FlightPlan {
    let threshold = LatLon::new(46.0, 8.0);
    let runway = Runway {
        id: "RWY".into(),
        threshold,
        elevation_amsl_m: 300.0,
        heading_deg: 90.0,
        length_m: 600.0,
        priority: 1,
        approach_entry: None,
    };
    let extent = Extent::Around { centre: threshold.destination(180.0, 1200.0), radius_m: 400.0 };
    let outline =
        Outline { template: Template::Circuit, aircraft: "trainer".into(), runway, extent, height_m: 150.0 };
    outline.plan(&Profile::default(), &Flat(300.0))
}

fn problems(plan: &FlightPlan) -> Vec<Problem> {
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let document = write(plan);
    let reviewed = compile_and_review(document.as_bytes(), &Profile::default(), &flat, Conditions::default());
    reviewed.map_or_else(|problems| problems, |program| program.warnings.clone())
}

/// Presses one *Fix* after the other, each time another one of the list; gives the codes that are left.
fn mended(mut plan: FlightPlan, turn: usize) -> Vec<&'static str> {
    let mut before = vec![write(&plan)];
    for step in 0..MOST_FIXES {
        let found = problems(&plan);
        let fixes: Vec<&Problem> = found.iter().filter(|problem| problem.fix.is_some()).collect();
        let Some(chosen) = fixes.get((step + turn) % fixes.len().max(1)) else {
            return found.iter().map(|problem| problem.code).collect();
        };
        plan = chosen.fix.as_ref().unwrap().apply(&plan).unwrap_or_else(|error| panic!("{error}: {chosen}"));
        let document = write(&plan);
        assert_eq!(read(&document).problems, [], "{chosen}");
        assert!(!before.contains(&document), "it was that before `{chosen}`: {document}");
        before.push(document);
    }
    panic!("no end after {MOST_FIXES} fixes")
}

#[test]
fn fixes_never_go_in_a_circle() {
    // where the approach begins, its end, both, and the way there, so many metres above the runway
    let seeds: [&[(&str, f64)]; 4] = [
        &[("a2", 600.0), ("r-a2", 600.0)],
        &[("ap1", 190.0)],
        &[("a2", 600.0), ("ap1", 190.0)],
        &[("mission", 1200.0)],
    ];
    for seed in seeds {
        let raise =
            |(of, metres): &(&str, f64)| Edit::relevel(&(*of).into(), *metres, AltitudeReference::Home, 0.0);
        let seeded = Edit::All(seed.iter().map(raise).collect()).apply(&circuit()).unwrap();
        assert!(!problems(&seeded).is_empty(), "{seed:?} is no seed");
        for turn in 0..2 {
            let left = mended(seeded.clone(), turn);
            assert!(!left.iter().any(|code| code.contains("steep")), "{seed:?} {left:?}");
        }
    }
}
