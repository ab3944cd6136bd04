//! A plan flown ahead of time, with a line of progress.

use super::progress;
use super::source::Loaded;
use super::wind::Air;
use crate::report::{Happening, Record, Track, TrackPoint, assemble, flights};
use aircraft::{Profile, Wind};
use flight_exec::Event;
use flight_exec::rehearse::{
    Advance, Options, Preview, PreviewError, Scenario, Start, preview_as_far_as_possible,
};
use flight_exec::review::{ending_conditions, open_end};
use flight_plan::{FlightPlan, Id, Program, Variable, VariableValue};
use std::collections::HashMap;
use std::sync::Arc;
use terrain::Terrain;

/// Seconds between points of the track: a turn of the smallest aircraft is still round.
const TRACK_EVERY_S: f64 = 0.2;

/// How the progress is shown: by legs of the plan, because the number of passes of a loop is not known.
const PROGRESS: &str = "preview {bar:30} leg {pos} of {len}, {msg}";
/// A plan without a take-off begins so far south of its first place, metres.
const BEFORE_FIRST_M: f64 = 1000.0;

/// A flight up to its end, or as far as it comes, with the reason.
type Flown = Result<(Preview, Option<PreviewError>), PreviewError>;

/// A program to be flown ahead of time, and in what.
#[derive(Clone, Copy)]
pub struct Ahead<'a> {
    /// What is flown.
    pub program: &'a Arc<Program>,
    /// By which aircraft.
    pub profile: &'a Profile,
    /// Over which ground.
    pub terrain: &'a Arc<dyn Terrain>,
    /// In which wind, and from where.
    pub air: Air,
    /// What happens on the way.
    pub scenario: &'a Scenario,
}

impl Ahead<'_> {
    /// Flies it; the progress shows time and leg.
    ///
    /// # Errors
    /// It can't be flown to its end.
    pub fn fly(self) -> Result<Preview, PreviewError> {
        to_its_end(self.fly_as_far_as_possible())
    }

    /// As [`Self::fly`]; `report` is told how far it is, and gives false when the flight is no longer wanted.
    ///
    /// # Errors
    /// As [`Self::fly`], and `Cancelled`.
    pub fn fly_reporting(self, report: &mut dyn FnMut(&Advance) -> bool) -> Result<Preview, PreviewError> {
        to_its_end(self.flown(report))
    }

    /// As [`Self::fly`]; a flight that ends too early is there up to its end, with the reason.
    ///
    /// # Errors
    /// It can't be begun.
    pub fn fly_as_far_as_possible(self) -> Flown {
        let contexts = self.program.flown().all_legs();
        let numbered = contexts.iter().zip(1..).map(|(context, number)| (context.leg.id.clone(), number));
        let legs: HashMap<Id, u64> = numbered.collect();
        let bar = progress::bar(PROGRESS);
        bar.set_length(legs.len() as u64);
        progress::shown(&bar, || {
            self.flown(&mut |advance| {
                let leg = advance.place.as_ref().map(|p| &p.leg);
                bar.set_position(leg.and_then(|l| legs.get(l)).copied().unwrap_or(0));
                let minutes = advance.time_s / 60.0;
                bar.set_message(format!("{minutes:.0} min, {}", leg.map_or("", |l| l.as_str())));
                true
            })
        })
    }

    fn flown(self, report: &mut dyn FnMut(&Advance) -> bool) -> Flown {
        let Self { program, profile, terrain, air, scenario } = self;
        let options = Options {
            track_every_s: TRACK_EVERY_S,
            autopilot: air.autopilot,
            isa_deviation_c: air.isa_deviation_c,
            ..Options::default()
        };
        let start = start(program, terrain.as_ref(), air.begin);
        preview_as_far_as_possible(program, profile, terrain, air.wind, start, scenario, &options, report)
    }
}

fn to_its_end(flown: Flown) -> Result<Preview, PreviewError> {
    match flown? {
        (preview, None) => Ok(preview),
        (_, Some(error)) => Err(error),
    }
}

/// Why a flight ahead of time came to no end; who gives the commands can choose for the plan.
pub fn why(program: &Program, error: &PreviewError) -> String {
    match error {
        PreviewError::Waiting { .. } => format!("{error}, or choose a branch with --decide LEG=BRANCH"),
        PreviewError::NoStart => {
            "the plan has neither a take-off nor a place to begin at: say where in flight it begins with --begin LAT,LON,ALT,COURSE"
                .into()
        }
        _ => without_end(program, error).unwrap_or_else(|| error.to_string()),
    }
}

/// What a flight goes round in until its energy is used up or the preview is long enough, and how it is ended here.
pub fn without_end(program: &Program, error: &PreviewError) -> Option<String> {
    let (PreviewError::OutOfEnergy { seconds, leg } | PreviewError::TooLong { seconds, leg }) = error else {
        return None;
    };
    let open = open_end(program, leg)?;
    let (by, option) = match (open.as_fork(), ending_conditions(open).first()) {
        (Some(fork), _) => {
            let other = fork.branches.iter().find(|branch| Some(&branch.id) != fork.default)?;
            ("a decision".into(), format!("--decide {}={}", open.id, other.id))
        }
        (None, Some(until)) => (format!("`{until}`"), set_to_end(program, until)),
        (None, None) => ("a command".into(), "a `maxLaps`, `count` or `until` of its own".into()),
    };
    let minutes = seconds / 60.0;
    Some(format!(
        "`{}` is ended only by {by}, and goes on for {minutes:.0} min here: preview with {option}",
        open.id
    ))
}

/// How a condition becomes true: a variable by its value.
fn set_to_end(program: &Program, until: &str) -> String {
    let is_flag = |v: &&Variable| v.name.as_str() == until && matches!(v.initial, VariableValue::Bool(_));
    match program.plan.variables.iter().find(is_flag) {
        Some(flag) => format!("--set {}=true", flag.name),
        None => "--set NAME=VALUE of what that reads".into(),
    }
}

/// On the runway; of a plan that doesn't take off, where it is said to begin, or before its first place.
fn start(program: &Program, terrain: &dyn Terrain, begin: Option<Start>) -> Start {
    if let Some(begin) = begin {
        return begin;
    }
    match Start::of(program, terrain) {
        Some(Start::InFlight { position, altitude_amsl_m, heading_deg }) => {
            let position = position.destination(180.0, BEFORE_FIRST_M);
            Start::InFlight { position, altitude_amsl_m, heading_deg }
        }
        Some(Start::Runway) | None => Start::Runway,
    }
}

/// Legs that were left out because they can't be laid out, and why.
pub fn left_out(preview: &Preview) -> Vec<(&Id, &str)> {
    let refused = preview.events.iter().filter_map(|(_, event)| match event {
        Event::PatternRefused { leg, reason } => Some((leg, reason.as_str())),
        _ => None,
    });
    refused.collect()
}

/// The previewed track, cut into passages. `plans`: the plan and its updates, as they are flown: with the legs of calls.
pub fn track(preview: &Preview, plans: &[&FlightPlan]) -> Track {
    let points: Vec<TrackPoint> = preview
        .track
        .iter()
        .map(|p| TrackPoint { time_s: p.time_s, position: p.position, altitude_amsl_m: p.altitude_amsl_m })
        .collect();
    assemble::track(&points, &preview.events, plans)
}

/// Of how much of a track no elevation of the ground is known; `None`: it is known below all of it.
fn unknown_ground(track: &Track, terrain: &dyn Terrain) -> Option<String> {
    let points = track.points();
    let unknown = points.iter().filter(|p| terrain.elevation_m(p.position).is_none()).count();
    let percent = (100.0 * unknown as f64 / points.len().max(1) as f64).ceil();
    (unknown > 0).then(|| format!("no elevation known below {percent:.0} % of the path"))
}

/// A record of what would be flown.
pub fn record(loaded: &Loaded, program: &Program, preview: &Preview, wind: &Wind) -> Record {
    let planned = track(preview, &[program.flown()]);
    let happenings: Vec<Happening> = preview.events.iter().map(|(t, e)| assemble::happening(*t, e)).collect();
    let mut notes = vec![
        format!("preview for {}", program.plan.aircraft),
        format!("wind {}", super::wind::shown(wind)),
        format!("plan {}", program.hash().get(..12).unwrap_or(program.hash())),
    ];
    notes.extend(unknown_ground(&planned, loaded.terrain.as_ref()));
    Record {
        title: program.plan.name.clone(),
        notes,
        places: assemble::places(&program.plan),
        zones: program.plan.zones.clone(),
        areas: assemble::areas(program, &planned, &preview.events),
        routes: assemble::routes(program, &planned),
        planned,
        energy: flights::previewed(preview),
        flown: Track::default(),
        authored: Default::default(),
        happenings,
        verdict: Vec::new(),
        by_hand: Vec::new(),
        terrain: loaded.terrain.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headless::source::tests::source;
    use terrain::{Flat, Tiles};

    #[test]
    fn who_waits_for_a_decision_learns_how_to_give_it() {
        let ask = r#"<intersection id="ask"><branch id="on"/><branch id="by" next="side3"/></intersection><TF id="side2""#;
        let square = include_str!("../../../assets/plans/square.xml").replace("<TF id=\"side2\"", ask);
        let (_file, source) = source(square.as_bytes());
        let loaded = source.load().unwrap();
        let (program, profile) = loaded.compile().unwrap();
        let calm = Air::default();
        let (program, terrain, scenario) = (&program, &loaded.terrain, &Scenario::default());
        let error = Ahead { program, profile, terrain, air: calm, scenario }.fly().unwrap_err();
        let said = why(program, &error);
        assert!(said.contains("--decide"), "{said}");
        assert!(!error.to_string().contains("scenario"), "{error}");
    }

    #[test]
    fn a_hold_that_only_a_variable_ends_is_flown_until_then_and_says_which() {
        let named = r#"<variable name="radius" "#;
        let cleared = format!(r#"<variable name="cleared" type="bool" initial="false"/>{named}"#);
        let hold = |legs: &str| {
            let bad =
                include_str!("../../../assets/plans/bad/path/hold-left-at-once.xml").replace(named, &cleared);
            let (before, rest) = bad.split_once("<HM ").unwrap();
            format!("{before}{legs}{}", rest.split_once("/>").unwrap().1)
        };
        let hm = r#"<HM id="hold" fix="C" course="52" turn="right" length="500" "#;
        for (legs, said) in [
            (format!(r#"{hm} until="cleared"/>"#), "`hold` is ended only by `cleared`"),
            (format!(r#"{hm} until="battery &lt; radius * -1.0"/>"#), "--set NAME=VALUE"),
            (format!("{hm}/>"), "`hold` is ended only by a command"),
            (
                format!(
                    r#"<intersection id="ask" default="wait"><branch id="wait"/><branch id="go" next="on"/></intersection>
                       {hm} maxLaps="1" next="ask"/><TF id="on" fix="D"/>"#
                ),
                "preview with --decide ask=go",
            ),
        ] {
            let (_file, source) = source(hold(&legs).as_bytes());
            let loaded = source.load().unwrap();
            let (program, profile) = loaded.compile().unwrap_or_else(|problems| panic!("{problems:?}"));
            let tired = Profile { energy_j: 0.1 * profile.energy_j, ..profile.clone() };
            let (terrain, air, scenario) = (&loaded.terrain, Air::default(), &Scenario::default());
            let ahead = Ahead { program: &program, profile: &tired, terrain, air, scenario };
            let (preview, error) = ahead.fly_as_far_as_possible().unwrap();
            assert!(preview.legs.iter().any(|passage| passage.place.leg.as_str() == "hold"));
            let why = why(&program, &error.unwrap());
            assert!(why.contains(said), "{why}");
        }
    }

    #[test]
    fn a_record_says_of_how_much_the_ground_is_not_known() {
        let planned = crate::report::made_up_record().planned;
        assert_eq!(unknown_ground(&planned, &Flat(300.0)), None);
        let told = unknown_ground(&planned, &Tiles::new());
        assert_eq!(told.as_deref(), Some("no elevation known below 100 % of the path"));
    }
}
