//! Flight plans of the research that RNAV legs for unmanned aircraft come from: XML with a `<MainFP>` of stages, whose legs
//! have an `xsi:type` (`fp:TFLeg`, `fp:IterativeLeg`, `fp:IntersectionLeg`, `fp:Scan`, …). Read only.
//!
//! Written after E. Santamaria et al., "Flight plan specification and management for unmanned aircraft systems" (J. Intell.
//! Robot. Syst. 67, 2012) and after files that others wrote from it. There the legs of a stage are one flat list that refers to
//! itself: a loop names its body, a fork its branches, a leg the one that comes after it. Here loops hold their bodies, and
//! branches meet where the stage ends.

mod flow;
mod leg;
mod listed;
mod locale;
mod stage;

use crate::names::Names;
use crate::note::Notes;
use crate::synthetic::{self, Assumptions, Vehicle};
use crate::text::text_of;
use crate::xml::{self, Element, held};
use crate::{Error, Import, MAX_ITEMS};
use aircraft::Profile;
use flight_plan::{LegKind, Stage, StageKind};
use locale::Locale;
use std::collections::HashSet;
use std::sync::Arc;

/// A document has an element of this name, in which its stages are.
const MAIN: &str = "MainFP";

/// The names of the root of such a document.
pub const ROOTS: [&str; 2] = ["FlightPlan", MAIN];

/// A file begins as such a document does.
pub fn is_one(head: &str) -> bool {
    [format!("<{MAIN}"), format!(":{MAIN}")].iter().any(|tag| head.contains(tag.as_str()))
}

/// Reads a file.
///
/// # Errors
/// No XML, no such document, or more legs than are read.
pub fn read(bytes: &[u8], assumptions: &Assumptions) -> Result<Import, Error> {
    let mut notes = Notes::default();
    let root = xml::parse(&text_of(bytes, &mut notes)?)?;
    let Some(main) = (if root.name == MAIN { Some(&root) } else { root.child(MAIN) }) else {
        return Err(Error::malformed(
            root.place(),
            format!("this is no flight plan of stages: it has no <{MAIN}>"),
        ));
    };
    let stages = || main.children.iter().filter(|c| c.name == "stages").flat_map(|c| &c.children);
    if stages().map(|stage| stage.children.len()).sum::<usize>() > MAX_ITEMS {
        return Err(Error::TooMany { what: "legs", limit: MAX_ITEMS });
    }
    let locale = Locale::of(&root, &mut notes);
    let vehicle = Vehicle { cruise_mps: fastest(stages(), locale), is_vtol: false };
    let mut plan = synthetic::plan(assumptions, vehicle, &mut notes);
    if !main.text_of("name").is_empty() {
        plan.name = held(main.text_of("name"));
    }
    not_carried(&root, main, &mut notes);
    let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
    let ids = stages().flat_map(|stage| &stage.children).filter_map(|leg| leg.attribute("id")).collect();
    let mut names = Names::default();
    let ends = synthetic::ends(assumptions, &mut names);
    let mut reader = Reader { assumptions, notes, names, locale, profile, ids };
    plan.stages.extend(stages().filter_map(|element| reader.stage(element)));
    reader.begin(&mut plan.stages);
    if let Some((runway, [take_off, land])) = ends {
        plan.runways.push(runway);
        plan.stages.insert(0, take_off);
        plan.stages.push(land);
    }
    Ok(Import { plan, notes: reader.notes.into_vec() })
}

/// The fastest of all legs, m/s.
fn fastest<'a>(stages: impl Iterator<Item = &'a Element>, locale: Locale) -> Option<f64> {
    let speed = |leg: &Element| {
        let text = [leg, leg.child("dest").unwrap_or(leg)].map(|e| e.text_of("speed").to_owned());
        text.iter().find_map(|text| locale.number(text)).map(|speed| speed * locale.speed_mps)
    };
    stages.flat_map(|stage| &stage.children).filter_map(speed).reduce(f64::max)
}

/// What of the document is not read.
fn not_carried(root: &Element, main: &Element, notes: &mut Notes) {
    let of_root =
        root.children.iter().filter(|c| c.name != MAIN && c.name != "Locale" && !std::ptr::eq(root, main));
    let of_main = main.children.iter().filter(|c| !["name", "stages", "Locale"].contains(&c.name.as_str()));
    for child in of_root.chain(of_main) {
        let name: String = child.name.chars().take(60).collect();
        let message = match name.contains("FP") || name.to_lowercase().contains("emergency") {
            true => format!("<{name}> is left out: draw an emergency plan to a runway instead"),
            false => format!("<{name}> is left out"),
        };
        notes.again("element-not-carried", child.place(), &message);
    }
}

/// A document on its way into a plan.
struct Reader<'a> {
    assumptions: &'a Assumptions,
    notes: Notes,
    names: Names,
    locale: Locale,
    profile: Profile,
    /// Identifiers of all legs, as they are written.
    ids: HashSet<&'a str>,
}

impl Reader<'_> {
    /// The first leg of a plan has nothing to track from.
    fn begin(&mut self, stages: &mut [Stage]) {
        if self.assumptions.runway.is_none() {
            let message = "the file knows no runway: the plan begins in flight and doesn't land; add a take-off and a landing, or convert it with --runway";
            self.notes.push("no-runway", "file", message);
        }
        let first = stages.first_mut().and_then(|stage| stage.legs.first_mut());
        if let Some(first) = first
            && let LegKind::Tf(to) = &first.kind
        {
            let to = to.clone();
            Arc::make_mut(first).kind = LegKind::Df { to, turn: None };
        }
    }

    fn stage(&mut self, element: &Element) -> Option<Stage> {
        let name = element.attribute("id").or_else(|| element.attribute("name")).unwrap_or_default();
        let id = self.names.take(name, "stage");
        let legs = self.legs(element, &id);
        if legs.is_empty() {
            self.notes.push(
                "empty-stage",
                element.place(),
                format!("stage `{name}` is left out: nothing of it can be flown"),
            );
            return None;
        }
        let mut stage = synthetic::stage(id, held(name).trim(), kind_of_stage(name));
        stage.legs = legs;
        Some(stage)
    }
}

/// What a stage is for, by its name: these documents name them after the phases of a flight.
fn kind_of_stage(name: &str) -> StageKind {
    let name = name.to_lowercase();
    let kinds = [
        (&["depart", "take-off", "takeoff", "take off"][..], StageKind::Departure),
        (&["route", "transit"], StageKind::EnRoute),
        (&["arriv", "home", "return"], StageKind::Arrival),
        (&["approach", "landing"], StageKind::Approach),
    ];
    let found = kinds.iter().find(|(words, _)| words.iter().any(|word| name.contains(word)));
    found.map_or(StageKind::Mission, |(_, kind)| *kind)
}
