//! The fire-watch mission's logic: a service above the plan that sees the fire grow and move, decides at the
//! intersection, sends a new plan and tells when the fire is out. Pure; the preview follows the same steps.

use flight_exec::rehearse::{self, Scenario, Trigger};
use flight_exec::{Command, Event, PlacePointer, Token};
use flight_plan::{
    Altitude, Edit, FlightPlan, Id, Leg, LegKind, Place, PlanWaypoint, Program, Spot, Value, VariableValue,
};
use geometry::LatLon;
use std::sync::Arc;

/// When a step is due.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum When {
    /// On a passage of a leg.
    On {
        /// The leg.
        leg: Id,
        /// Pass of the innermost loop around it, from 1; 0 outside loops.
        iteration: u64,
        /// After so many of its waypoints.
        waypoints: u64,
    },
    /// When the decision of an intersection is asked for.
    Asked {
        /// The intersection.
        leg: Id,
        /// Pass of the innermost loop around it, from 1; 0 outside loops.
        iteration: u64,
    },
}

/// What a step does.
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// A command to the FP Manager.
    Command(Command),
    /// The active plan with this change is proposed and committed.
    Update(Edit),
}

/// One step of the mission logic.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// For people.
    pub name: &'static str,
    /// What is to be seen then, for who watches.
    pub story: &'static str,
    /// When.
    pub when: When,
    /// What, in order.
    pub acts: Vec<Act>,
}

/// The steps for a plan: those of the fire watch if it has its legs and variables, else none.
pub fn steps_for(plan: &FlightPlan) -> Vec<Step> {
    let has_legs =
        ["sweep", "ask", "look", "patrol", "p2", "h1"].iter().all(|id| plan.leg(&Id::new(id)).is_some());
    let has_variables =
        ["fire_centre", "fire_radius", "fire_out"].iter().all(|name| plan.variable(&Id::new(name)).is_some());
    if has_legs && has_variables { fire_watch() } else { Vec::new() }
}

fn fire_watch() -> Vec<Step> {
    let on = |leg: &str, iteration, waypoints| When::On { leg: Id::new(leg), iteration, waypoints };
    let asked = |iteration| When::Asked { leg: "ask".into(), iteration };
    vec![
        Step {
            name: "the fire grows",
            story: "The fire has grown: the rows around it are laid out anew, while they are being flown",
            when: on("sweep", 1, 4),
            acts: vec![set("fire_radius", VariableValue::Number(430.0))],
        },
        Step {
            name: "back to the watch point",
            story: "The demo decided at the fork: back to the watch point, for another round",
            when: asked(1),
            acts: vec![decide("again")],
        },
        Step {
            name: "the fire moves",
            story: "The fire has moved: the scan moves with it",
            when: on("sweep", 2, 4),
            acts: vec![
                set("fire_centre", VariableValue::Position(LatLon::new(36.2525, -84.2565))),
                set("fire_radius", VariableValue::Number(380.0)),
            ],
        },
        Step {
            name: "a close look",
            story: "The demo decided at the fork: a close look, in circles above the fire",
            when: asked(2),
            acts: vec![decide("close")],
        },
        Step {
            name: "the fire is out",
            story: "The fire is out: the loop ends and the patrol begins",
            when: on("look", 2, 6),
            acts: vec![set("fire_out", VariableValue::Bool(true))],
        },
        Step {
            name: "another way home",
            story: "A new plan was sent in flight: a look at the valley on the way home",
            when: on("p2", 2, 0),
            acts: vec![Act::Update(way_home())],
        },
    ]
}

fn set(name: &str, value: VariableValue) -> Act {
    Act::Command(Command::SetVariable { name: Id::new(name), value })
}

fn decide(branch: &str) -> Act {
    Act::Command(Command::Decide { leg: "ask".into(), branch: Id::new(branch) })
}

/// A look at the valley on the way home: one leg more, after the mountain front.
fn way_home() -> Edit {
    let leg = Leg {
        id: "h2".into(),
        name: "Look at the valley".into(),
        emergency: Default::default(),
        altitude: None::<Altitude>,
        speed_mps: None,
        next: None,
        actions: Vec::new(),
        kind: LegKind::Tf(PlanWaypoint {
            place: Place::Position(Value::Constant(LatLon::new(36.2880, -84.2190))),
            fly_over: false,
        }),
    };
    Edit::InsertLeg { leg: Box::new(leg), at: Spot::After("h1".into()) }
}

/// Follows a flight and says which steps are due; each comes once, in order.
#[derive(Debug, Clone)]
pub struct Script {
    steps: std::collections::VecDeque<Step>,
    /// Steps in all.
    count: usize,
    place: Option<PlacePointer>,
    /// Waypoints of the present passage that have been flown.
    flown: u64,
    steering_to: Option<Token>,
    /// The decision that is open: its fork, the pass, and since when, seconds.
    asked: Option<(Id, u64, f64)>,
}

impl Script {
    /// Before the flight.
    pub fn new(steps: Vec<Step>) -> Self {
        Self {
            count: steps.len(),
            steps: steps.into(),
            place: None,
            flown: 0,
            steering_to: None,
            asked: None,
        }
    }

    /// The executor told something.
    pub fn hear(&mut self, event: &Event, now_s: f64) {
        match event {
            Event::DecisionRequested(request) => {
                self.asked = Some((request.leg.clone(), iteration(self.place.as_ref()), now_s));
            }
            Event::DecisionTaken { .. } => {
                // somebody else was quicker, or it is our own
                if self.is_waiting() {
                    self.steps.pop_front();
                    self.count -= 1;
                }
                self.asked = None;
            }
            _ => {}
        }
    }

    /// The next step is a decision that is open.
    pub fn is_waiting(&self) -> bool {
        self.steps.front().is_some_and(|step| match (&step.when, &self.asked) {
            (When::Asked { leg, iteration }, Some((asked, pass, _))) => (leg, iteration) == (asked, pass),
            _ => false,
        })
    }

    /// The aircraft is at this place and steers to this waypoint.
    pub fn steers_to(&mut self, place: Option<&PlacePointer>, current: Option<Token>) {
        let passage = |p: &PlacePointer| (p.leg.clone(), p.iterations.clone(), p.reverse);
        if place.map(passage) != self.place.as_ref().map(passage) {
            self.flown = 0;
        } else if current != self.steering_to {
            self.flown += 1;
        }
        self.place = place.cloned();
        self.steering_to = current;
    }

    /// The next step, if it is due; it won't come again. A decision is left to others for `patience_s`.
    pub fn next_due(&mut self, now_s: f64, patience_s: f64) -> Option<Step> {
        let due = match &self.steps.front()?.when {
            When::Asked { .. } => {
                let since_s = self.asked.as_ref().map_or(f64::INFINITY, |(.., since_s)| *since_s);
                self.is_waiting() && now_s - since_s >= patience_s
            }
            When::On { leg, iteration, waypoints } => self.is_at(leg, *iteration, *waypoints),
        };
        if due { self.steps.pop_front() } else { None }
    }

    /// Steps in all.
    pub fn steps(&self) -> usize {
        self.count
    }

    /// Steps that have not come.
    pub fn missing(&self) -> impl Iterator<Item = &Step> {
        self.steps.iter()
    }

    fn is_at(&self, leg: &Id, pass: u64, waypoints: u64) -> bool {
        let here = self.place.as_ref().is_some_and(|p| p.leg == *leg);
        here && iteration(self.place.as_ref()) == pass && self.flown >= waypoints
    }
}

/// Pass of the innermost loop around a place; 0 outside loops.
fn iteration(place: Option<&PlacePointer>) -> u64 {
    place.and_then(|p| p.iterations.last()).map_or(0, |i| i.iteration)
}

/// The steps as a scenario of the preview, which knows no `Asked`: decisions are given at the times `asked_s` at
/// which an earlier preview was asked for them (those not known yet are left out).
///
/// # Errors
/// A changed plan is no good.
pub fn scenario(
    steps: &[Step],
    plan: &FlightPlan,
    compile: impl Fn(FlightPlan) -> anyhow::Result<Arc<Program>>,
    asked_s: &[f64],
) -> anyhow::Result<Scenario> {
    let mut asked_s = asked_s.iter();
    let mut triggers = Vec::new();
    for step in steps {
        let at = match &step.when {
            When::On { leg, iteration, waypoints } => rehearse::When::Waypoints {
                leg: leg.clone(),
                iteration: (*iteration > 0).then_some(*iteration),
                count: *waypoints,
            },
            When::Asked { .. } => match asked_s.next() {
                Some(seconds) => rehearse::When::After { seconds: *seconds },
                None => continue,
            },
        };
        let mut then = Vec::new();
        for act in &step.acts {
            then.push(match act {
                Act::Command(command) => rehearse::Act::Command(command.clone()),
                Act::Update(edit) => {
                    rehearse::Act::Update { program: compile(edit.apply(plan)?)?, entry: None }
                }
            });
        }
        triggers.push(Trigger { at, then });
    }
    Ok(Scenario { triggers })
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_exec::{Branching, DecisionRequest, IterationPlace};

    fn place(leg: &str, iteration: u64) -> PlacePointer {
        PlacePointer {
            plan: Branching::Main,
            stage: "watch".into(),
            leg: Id::new(leg),
            iterations: vec![IterationPlace { leg: "rounds".into(), iteration, of: None, reverse: false }],
            reverse: false,
            distance_m: 0.0,
        }
    }

    fn ask() -> Event {
        let (options, default) = (vec![], None);
        Event::DecisionRequested(DecisionRequest {
            leg: "ask".into(),
            options,
            default,
            distance_left_m: 0.0,
            time_left_s: 0.0,
        })
    }

    /// The card called the same branch otherwise.
    #[test]
    fn a_decision_is_told_by_the_name_of_its_branch() {
        let plan = flight_plan::read(crate::assets::FIRE_WATCH).plan;
        let mut told = 0;
        for step in fire_watch() {
            for act in &step.acts {
                let Act::Command(Command::Decide { leg, branch }) = act else { continue };
                let label = plan.branch_label(leg, branch).to_lowercase();
                for words in [step.name, step.story] {
                    assert!(words.to_lowercase().contains(&label), "{words}: {label}");
                }
                told += 1;
            }
        }
        assert_eq!(told, 2);
    }

    #[test]
    fn steps_come_once_and_at_their_place() {
        let mut script = Script::new(fire_watch());
        let mut token = 0;
        let mut fly = |script: &mut Script, leg: &str, iteration: u64, waypoints: u64| -> Vec<&str> {
            let mut names = Vec::new();
            for _ in 0..waypoints {
                token += 1;
                for _ in 0..3 {
                    script.steers_to(Some(&place(leg, iteration)), Some(Token(token)));
                    names.extend(std::iter::from_fn(|| script.next_due(0.0, 0.0)).map(|s| s.name));
                }
            }
            names
        };
        assert!(fly(&mut script, "sweep", 1, 4).is_empty(), "three are flown");
        assert_eq!(fly(&mut script, "sweep", 1, 1), ["the fire grows"]);
        script.hear(&ask(), 0.0);
        assert_eq!(fly(&mut script, "sweep", 1, 20), ["back to the watch point"]);
        assert!(fly(&mut script, "regroup", 1, 9).is_empty());
        assert_eq!(fly(&mut script, "sweep", 2, 9), ["the fire moves"]);
        assert_eq!(
            script.missing().map(|s| s.name).collect::<Vec<_>>(),
            ["a close look", "the fire is out", "another way home"]
        );
    }

    #[test]
    fn a_decision_is_left_to_who_watches_for_a_while_and_whoever_was_quicker_has_decided() {
        let waiting = || {
            let mut script = Script::new(fire_watch());
            script.steps.pop_front();
            script.steers_to(Some(&place("sweep", 1)), Some(Token(1)));
            script.hear(&ask(), 100.0);
            script
        };
        let mut script = waiting();
        assert!(script.next_due(114.0, 15.0).is_none() && script.is_waiting());
        let step = script.next_due(115.0, 15.0).unwrap();
        assert_eq!(step.name, "back to the watch point");
        assert!(step.story.starts_with("The demo decided"), "nobody else did: {}", step.story);
        let mut script = waiting();
        let taken = Event::DecisionTaken { leg: "ask".into(), branch: "close".into(), by: "operator".into() };
        script.hear(&taken, 105.0);
        assert!(script.next_due(120.0, 15.0).is_none() && !script.is_waiting());
        assert_eq!(script.missing().next().map(|step| step.name), Some("the fire moves"));
    }

    #[test]
    fn other_plans_have_no_steps() {
        assert!(steps_for(&FlightPlan::default()).is_empty());
    }

    #[test]
    fn the_script_fits_the_example() {
        let plan = flight_plan::read(crate::assets::FIRE_WATCH.as_bytes()).plan;
        let steps = steps_for(&plan);
        assert_eq!(steps.len(), 6);
        for act in steps.iter().flat_map(|s| &s.acts) {
            match act {
                Act::Update(edit) => {
                    let changed = edit.apply(&plan).unwrap();
                    let profile = aircraft::Profile::by_name(&changed.aircraft).unwrap();
                    let terrain = crate::assets::demo_terrain();
                    assert_eq!(flight_plan::check(&changed, &profile, terrain.as_ref()), []);
                }
                Act::Command(Command::SetVariable { name, value }) => {
                    plan.variable(name).unwrap().accepts(value).unwrap();
                }
                Act::Command(_) => {}
            }
        }
    }
}
