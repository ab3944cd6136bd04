//! What of a plan is flown: values of variables, branches, an emergency plan.

use super::source::Loaded;
use super::wind::{self, Air};
use aircraft::Autopilot;
use anyhow::{anyhow, bail};
use flight_exec::rehearse::{Act, Preview, Scenario, Trigger, When};
use flight_exec::{Branching, Command};
use flight_plan::suggest::did_you_mean;
use flight_plan::{Cause, FlightPlan, Id, LegKind, Variable, VariableValue};
use geometry::LatLon;
use interchange::{Note, Step};
use std::collections::BTreeMap;
use std::path::Path;

/// Decisions given on the command line.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Selection {
    /// Start with this value of a variable (a position: LAT LON; a polygon: LAT LON, LAT LON, …).
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair)]
    pub set: Vec<(String, String)>,
    /// Take this branch when the intersection (in a call: CALL.LEG) is reached for the first time; otherwise conditions and
    /// defaults decide.
    #[arg(long, value_name = "LEG=BRANCH", value_parser = pair)]
    pub decide: Vec<(String, String)>,
    /// Fly this emergency plan.
    #[arg(long, value_name = "PLAN")]
    pub emergency: Option<String>,
    /// Raise an emergency for this cause: engine, energy, gps, link, traffic, payload or operator; without --emergency the plan that
    /// the leg names for it is flown. After an engine failure the preview says where a glide ends.
    #[arg(long, value_name = "CAUSE", value_parser = cause)]
    pub cause: Option<Cause>,
    /// The leg on which the emergency is raised (in a call: CALL.LEG), and how many seconds later; default: the first leg.
    #[arg(long, value_name = "LEG[+SECONDS]")]
    pub at: Option<String>,
    /// Even if the path breaks a rule: terrain, zones, energy or an emergency plan out of reach.
    #[arg(long)]
    pub anyway: bool,
    /// Leave out legs that can't be laid out (above ground whose elevation is not known), each with a note; without this option nothing
    /// is written then.
    #[arg(long)]
    pub leave_out_legs: bool,
    /// Fly as this autopilot does: px4, arduplane, or with its WP_RADIUS in metres arduplane,50. It has its own corners, and indicated
    /// airspeeds; without this option the plan is flown close to its lines at true airspeeds, as by the review in any case.
    #[arg(long, value_name = "AUTOPILOT")]
    pub autopilot: Option<Autopilot>,
    /// How much warmer than the standard atmosphere the air is (°C): in warm air it is faster at the same indicated airspeed.
    #[arg(long, value_name = "DEGREES", value_parser = wind::deviation, default_value = "0", allow_hyphen_values = true)]
    #[arg(requires = "autopilot")]
    pub isa_deviation: f64,
}

fn pair(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE")?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

fn cause(text: &str) -> Result<Cause, String> {
    let known = serde_json::from_value(text.into());
    known.map_err(|_| "write engine, energy, gps, link, traffic, payload or operator".to_owned())
}

impl Selection {
    /// The air, with whose habits it is flown in, and how warm it is.
    pub fn flown_in(&self, air: Air) -> Air {
        Air { autopilot: self.autopilot, isa_deviation_c: self.isa_deviation, ..air }
    }

    /// Sets the variables' initial values.
    ///
    /// # Errors
    /// No such variable, or a value it can't have.
    pub fn prepare(&self, loaded: &mut Loaded) -> anyhow::Result<()> {
        for (name, text) in &self.set {
            let plan = loaded.plan_mut();
            let known = names_there_are(name, plan.variables.iter().map(|v| v.name.as_str()));
            let variable = plan.variables.iter_mut().find(|v| v.name.as_str() == name);
            let variable = variable.ok_or_else(|| anyhow!("there is no variable `{name}`: {known}"))?;
            let value = value(variable, text)?;
            variable.accepts(&value).map_err(|e| anyhow!("{name}: {e}"))?;
            variable.initial = value;
        }
        Ok(())
    }

    /// What is done on the way. Legs have the names that they have when the plan is flown: `call.leg` in a call.
    ///
    /// # Errors
    /// No such intersection, branch, emergency plan or leg.
    pub fn scenario(&self, plan: &FlightPlan) -> anyhow::Result<Scenario> {
        let (flown, _) = flight_plan::instantiate(plan);
        let plan = flown.as_ref();
        let mut triggers = Vec::new();
        for (leg, branch) in &self.decide {
            let (leg, branch) = branch_of(plan, leg, branch)?;
            let then = vec![Act::Command(Command::Decide { leg, branch })];
            triggers.push(Trigger { at: When::After { seconds: 0.0 }, then });
        }
        if self.is_emergency() {
            let (cause, plan_id) = (self.cause.unwrap_or(Cause::Operator), self.emergency_plan(plan)?);
            let then = vec![Act::Command(Command::Emergency { cause, plan: plan_id })];
            triggers.push(Trigger { at: self.raised_at(plan)?, then });
        } else if let Some(at) = &self.at {
            bail!("say with --emergency PLAN or --cause CAUSE what happens at `{at}`");
        }
        Ok(Scenario { triggers })
    }

    fn is_emergency(&self) -> bool {
        self.emergency.is_some() || self.cause.is_some()
    }

    /// The one that is named; `None`: that of the leg.
    fn emergency_plan(&self, plan: &FlightPlan) -> anyhow::Result<Option<Id>> {
        let Some(name) = &self.emergency else { return Ok(None) };
        let found = plan.emergency_plans.iter().find(|e| e.id.as_str() == name);
        found.map(|emergency| Some(emergency.id.clone())).ok_or_else(|| {
            let known = names_there_are(name, plan.emergency_plans.iter().map(|e| e.id.as_str()));
            anyhow!("there is no emergency plan `{name}`: {known}")
        })
    }

    fn raised_at(&self, plan: &FlightPlan) -> anyhow::Result<When> {
        let Some(at) = &self.at else {
            let first = plan.stages.iter().flat_map(|s| &s.legs).next();
            let first = first.ok_or_else(|| anyhow!("the main plan has no leg"))?;
            return Ok(When::Entering { leg: first.first_flown().id.clone(), iteration: None });
        };
        // no identifier has a plus in it
        let Some((name, later)) = at.split_once('+') else {
            return Ok(When::Entering { leg: known_leg(plan, at)?, iteration: None });
        };
        let seconds = later.trim().parse().ok().filter(|s: &f64| s.is_finite() && *s >= 0.0);
        let seconds = seconds.ok_or_else(|| anyhow!("write --at LEG+SECONDS, as in --at {name}+30"))?;
        Ok(When::Since { leg: known_leg(plan, name.trim())?, seconds })
    }

    /// A passage belongs to the way selected.
    pub fn takes(&self, passage: Option<usize>, preview: &Preview) -> bool {
        if !self.is_emergency() {
            return true;
        }
        let leg = passage.and_then(|p| preview.legs.get(p));
        let is_it = |id: &Id| self.emergency.as_ref().is_none_or(|name| id.as_str() == name);
        leg.is_some_and(|l| matches!(&l.place.plan, Branching::Emergency(id) if is_it(id)))
    }

    /// A note of each leg of a flight that could not be laid out; `None`, after it was said, if the flight may not be written without
    /// them.
    pub fn without(&self, left_out: &[(&Id, &str)], file: &Path) -> Option<Vec<Note>> {
        if !left_out.is_empty() && !self.leave_out_legs {
            print_left_out(left_out, file);
            return None;
        }
        let note = |(leg, reason): &(&Id, &str)| Note {
            code: "leg-left-out",
            place: leg.to_string(),
            message: format!("this leg is left out: {reason}"),
        };
        Some(left_out.iter().map(note).collect())
    }

    /// The waypoints of the way selected, in the order in which they are flown; those replaced before they were reached are none.
    pub fn steps(&self, preview: &Preview) -> Vec<Step> {
        crate::export::steps(preview, |passage| self.takes(passage, preview))
    }
}

/// Why nothing is written: the first legs of each reason.
fn print_left_out(left_out: &[(&Id, &str)], file: &Path) {
    const MOST: usize = 10;
    let file = file.display();
    let mut by_reason: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    left_out.iter().for_each(|(leg, reason)| by_reason.entry(reason).or_default().push(leg.as_str()));
    for (reason, legs) in by_reason {
        let named = legs.iter().take(MOST).copied().collect::<Vec<_>>().join(", ");
        let more = match legs.len().saturating_sub(MOST) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        complain!("{file}: {named}{more} can't be laid out: {reason}");
    }
    complain!(
        "{file}: nothing is written without them; mend the plan, or write the rest with --leave-out-legs"
    );
}

/// The names there are, and which of them was meant; in a sentence about another one.
fn names_there_are<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.collect();
    match known.is_empty() {
        true => "the plan has none".to_owned(),
        false => {
            let meant = did_you_mean(name, known.iter().copied());
            format!("there are {}{meant}", known.join(", "))
        }
    }
}

/// The leg that begins what has this name: a leg, a loop, a call, or a stage. The plan is the one that is flown: its calls are
/// the legs they expand to.
///
/// # Errors
/// There is none, or it is passed without being flown.
pub fn known_leg(plan: &FlightPlan, name: &str) -> anyhow::Result<Id> {
    let id = Id::new(name);
    let begun = match (plan.leg(&id), plan.stage(&id)) {
        (Some(context), _) => context.leg,
        (None, Some(stage)) => match stage.legs.first() {
            Some(first) => first,
            None => return Ok(stage.id.clone()),
        },
        (None, None) => return Err(no_leg(plan, name)),
    };
    let leg = begun.first_flown();
    if matches!(leg.kind, LegKind::Intersection { .. }) {
        bail!("`{}` is passed without being flown: name the leg before or behind it", leg.id);
    }
    Ok(leg.id.clone())
}

/// No leg and no stage has this name.
fn no_leg(plan: &FlightPlan, name: &str) -> anyhow::Error {
    let legs = plan.all_legs();
    let legs = legs.iter().map(|context| context.leg.id.as_str());
    let stages = plan.all_stages().map(|(_, stage)| stage.id.as_str());
    anyhow!("there is no leg `{name}` in the plan{}", did_you_mean(name, legs.chain(stages)))
}

fn branch_of(plan: &FlightPlan, leg: &str, branch: &str) -> anyhow::Result<(Id, Id)> {
    let context = plan.leg(&Id::new(leg)).ok_or_else(|| no_leg(plan, leg))?;
    let LegKind::Intersection { branches, .. } = &context.leg.kind else {
        bail!("`{leg}` is no fork");
    };
    match branches.iter().find(|b| b.id.as_str() == branch) {
        Some(found) => Ok((context.leg.id.clone(), found.id.clone())),
        None => {
            let names: Vec<_> = branches.iter().map(|b| b.id.to_string()).collect();
            let meant = did_you_mean(branch, names.iter().map(String::as_str));
            bail!("`{leg}` has no branch `{branch}`: it has {}{meant}", names.join(", "))
        }
    }
}

fn value(variable: &Variable, text: &str) -> anyhow::Result<VariableValue> {
    let bad = || anyhow!("{}: `{text}` is no value of type {}", variable.name, variable.initial.type_name());
    Ok(match &variable.initial {
        VariableValue::Bool(_) => VariableValue::Bool(text.parse().map_err(|_| bad())?),
        VariableValue::Number(_) => VariableValue::Number(text.parse().map_err(|_| bad())?),
        VariableValue::Text(_) => VariableValue::Text(text.to_owned()),
        VariableValue::Position(_) => VariableValue::Position(position(text).ok_or_else(bad)?),
        VariableValue::Polygon(_) => {
            let corners: Option<Vec<LatLon>> = text.split(',').map(position).collect();
            VariableValue::Polygon(corners.ok_or_else(bad)?)
        }
    })
}

fn position(text: &str) -> Option<LatLon> {
    let (lat, lon) = text.trim().split_once(char::is_whitespace)?;
    let position = LatLon::new(lat.parse().ok()?, lon.trim().parse().ok()?);
    position.is_valid().then_some(position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headless::source::tests::source;

    const FIRE_WATCH: &[u8] = include_bytes!("../../../assets/plans/fire-watch.xml");

    const NAVAID: &str = include_str!("../../../assets/plans/navaid-inspection.xml");

    fn set(pairs: &[&str]) -> anyhow::Result<VariableValue> {
        let (_file, source) = source(FIRE_WATCH);
        let mut loaded = source.load().unwrap();
        let selection =
            Selection { set: pairs.iter().map(|p| pair(p).unwrap()).collect(), ..Selection::default() };
        selection.prepare(&mut loaded)?;
        let name = selection.set.first().map(|(name, _)| name.as_str()).unwrap_or_default();
        Ok(loaded.reading.plan.variable(&name.into()).unwrap().initial.clone())
    }

    #[test]
    fn a_stage_or_a_loop_is_where_it_begins() {
        let (_file, source) = source(FIRE_WATCH);
        let plan = source.load().unwrap().reading.plan;
        let begins = |name: &str| known_leg(&plan, name).map(|id| id.to_string()).map_err(|e| e.to_string());
        for (name, leg) in
            [("sweep", "sweep"), ("rounds", "sweep"), ("watch", "sweep"), ("take-off", "take-off")]
        {
            assert_eq!(begins(name).as_deref(), Ok(leg));
        }
        assert!(begins("ask").unwrap_err().contains("passed without being flown"));
        assert!(begins("nowhere").unwrap_err().contains("there is no leg"));
        assert!(begins("swepp").unwrap_err().ends_with("; did you mean `sweep`?"));
        assert!(begins("take-of").unwrap_err().ends_with("; did you mean `take-off`?"), "a stage");
    }

    #[test]
    fn a_call_is_where_it_begins_and_its_legs_have_its_name() {
        let intersection = r#"<intersection id="again" default="on"><branch id="on"/><branch id="back" next="outbound"/></intersection>"#;
        let document = NAVAID.replace("    </procedure>", &format!("{intersection}</procedure>"));
        let plan = flight_plan::read(document.as_bytes()).plan;
        let (flown, problems) = flight_plan::instantiate(&plan);
        assert_eq!(problems, []);
        for (name, leg) in
            [("radial-190", "radial-190.outbound"), ("radial-190.inbound", "radial-190.inbound")]
        {
            assert_eq!(known_leg(&flown, name).unwrap().as_str(), leg);
        }
        assert!(known_leg(&flown, "inbound").is_err(), "which of the calls' is not said");
        let decide = |text: &str| {
            Selection { decide: vec![pair(text).unwrap()], ..Selection::default() }.scenario(&plan)
        };
        assert_eq!(decide("radial-190.again=back").unwrap().triggers.len(), 1);
        let error = decide("radial-190.again=round").unwrap_err().to_string();
        assert!(error.contains("it has on, back"), "{error}");
        let selection = Selection {
            emergency: Some("return".into()),
            at: Some("radial-280.round".into()),
            ..Selection::default()
        };
        assert_eq!(selection.scenario(&plan).unwrap().triggers.len(), 1);
    }

    #[test]
    fn variables_take_only_what_fits() {
        assert_eq!(set(&["fire_radius=500"]).unwrap(), VariableValue::Number(500.0));
        let fire = LatLon::new(36.35, -84.2);
        assert_eq!(set(&["fire_centre=36.35 -84.2"]).unwrap(), VariableValue::Position(fire));
        for (bad, said) in [
            ("fire_radius=wide", "no value of type number"),
            ("fire_radius=NaN", ""),
            ("fire_radius=1e9", "fire_radius"),
            ("fire_centre=36.35", "no value of type position"),
            ("nobody=1", "there is no variable"),
        ] {
            let error = set(&[bad]).unwrap_err().to_string();
            assert!(error.contains(said), "{bad}: {error}");
        }
        assert!(pair("fire_radius").is_err());
    }

    #[test]
    fn ways_that_are_not_there() {
        let plan = flight_plan::read(FIRE_WATCH).plan;
        let decide = |text: &str| Selection { decide: vec![pair(text).unwrap()], ..Selection::default() };
        let emergency = |plan: &str, at: Option<&str>| Selection {
            emergency: Some(plan.into()),
            at: at.map(str::to_owned),
            ..Selection::default()
        };
        for (selection, said) in [
            (decide("ask=nope"), "has no branch `nope`: it has again, close"),
            (decide("sweep=close"), "no fork"),
            (decide("nope=close"), "no leg `nope`"),
            (emergency("nope", None), "there are return, north-strip"),
            (emergency("return", Some("nope")), "no leg `nope`"),
        ] {
            let error = selection.scenario(&plan).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        let none = flight_plan::FlightPlan { emergency_plans: Vec::new(), ..plan.clone() };
        let error = emergency("nope", None).scenario(&none).unwrap_err().to_string();
        assert!(error.ends_with("`nope`: the plan has none"), "{error}");
        assert_eq!(decide("ask=close").scenario(&plan).unwrap().triggers.len(), 1);
        assert_eq!(emergency("return", None).scenario(&plan).unwrap().triggers.len(), 1);
    }

    #[test]
    fn an_emergency_has_a_cause_and_a_moment() {
        let plan = flight_plan::read(FIRE_WATCH).plan;
        let at =
            |cause: Option<Cause>, at: &str| Selection { cause, at: Some(at.into()), ..Selection::default() };
        let scenario = at(Some(Cause::Engine), "sweep+30").scenario(&plan).unwrap();
        let [trigger] = scenario.triggers.as_slice() else { panic!("{scenario:?}") };
        assert_eq!(trigger.at, When::Since { leg: "sweep".into(), seconds: 30.0 });
        assert!(matches!(
            trigger.then.as_slice(),
            [Act::Command(Command::Emergency { cause: Cause::Engine, plan: None })]
        ));
        let refused = |selection: Selection| selection.scenario(&plan).unwrap_err().to_string();
        assert!(refused(at(Some(Cause::Engine), "sweep+soon")).contains("--at sweep+30"));
        assert!(refused(at(None, "sweep")).contains("--cause CAUSE"));
        assert_eq!(cause("engine"), Ok(Cause::Engine));
        assert!(cause("boredom").unwrap_err().starts_with("write engine"));
    }
}
