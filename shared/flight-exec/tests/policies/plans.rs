//! Random plans: every kind of leg and action the language has, nested; small enough that a flight meets all of it.

use crate::grid::{compiled, document_with};
use crate::random::Random;
use crate::writing;
use flight_plan::Program;
use std::sync::Arc;

/// Nearly every draft can be flown.
const MAX_DRAWS: usize = 50;

/// `r` shapes the patterns, `stop` ends loops and holdings, `n` counts passes, `tally` counts what the plan itself writes.
const VARIABLES: &str = r#"<variable name="r" type="number" initial="500" min="10" max="1500"/>
    <variable name="stop" type="bool" initial="false"/>
    <variable name="n" type="number" initial="2" min="1" max="4"/>
    <variable name="tally" type="number" initial="0" min="0" max="100000"/>
    <variable name="note" type="text" initial="" maxLength="8"/>"#;

/// A leg without a name; lists give them theirs.
#[derive(Debug, Clone)]
pub enum Kind {
    /// Variants of a leg are at other places.
    Track(usize),
    Direct,
    Course,
    Start,
    Lap,
    Climb,
    ClimbOnTrack,
    /// A holding that is released, or left by `stop`, or by its laps.
    Hold {
        until: bool,
        laps: Option<u64>,
    },
    /// One of [`writing::PATTERNS`].
    Pattern(usize),
    /// Of a procedure, of which one calls the other.
    Call {
        nested: bool,
    },
    /// Over one leg to the one after it.
    Jump,
    Loop {
        reverse: bool,
        count: Option<u64>,
        until: Option<&'static str>,
        body: Vec<Leg>,
    },
    Fork {
        default: bool,
        due: &'static str,
    },
}

#[derive(Debug, Clone)]
pub struct Leg {
    pub id: String,
    pub kind: Kind,
    pub emergency: Emergency,
    pub own: Own,
    pub actions: Vec<Action>,
}

/// Speed and altitude of a leg's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Own {
    None,
    Constant,
    /// By the variable `n`.
    Variable,
}

/// An emergency plan of a leg's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Emergency {
    None,
    ForEveryCause,
    ForLink,
}

/// When, as an attribute, and what, as an element; nothing twice on a leg, so that what is done can be told apart.
pub type Action = (&'static str, &'static str);

const WHEN: [&str; 6] = [
    r#"on="start""#,
    r#"on="end""#,
    r#"on="abeam" fix="C2""#,
    r#"afterDistance="700""#,
    r#"afterTime="20""#,
    r#"every="400""#,
];
const WHAT: [&str; 8] = [
    "<photo/>",
    r#"<photo every="40"/>"#,
    "<photoStop/>",
    "<videoStart/>",
    "<videoStop/>",
    r#"<set variable="tally" to="= tally + 1.0"/>"#,
    r#"<set variable="r" to="= r + 50.0"/>"#,
    r#"<invoke service="camera" operation="zoom" argument="1"/>"#,
];
const WAIT: Action = (r#"on="end""#, r#"<wait seconds="20"/>"#);

/// What a document is made of.
#[derive(Debug, Clone)]
pub struct Draft {
    pub legs: Vec<Leg>,
    pub emergencies: bool,
    pub by_cause: bool,
    pub landing: bool,
    /// Of another flight, behind the landing; empty: there is none.
    pub second: Vec<Leg>,
    pub names: usize,
}

impl Draft {
    pub fn new(random: &mut Random) -> Self {
        let mut draft = Self {
            legs: Vec::new(),
            emergencies: random.percent(92),
            by_cause: random.percent(40),
            landing: random.percent(85),
            second: Vec::new(),
            names: 0,
        };
        draft.legs = draft.list(2, random);
        if draft.landing && random.percent(20) {
            draft.second = draft.list(1, random);
        }
        draft
    }

    fn list(&mut self, depth: usize, random: &mut Random) -> Vec<Leg> {
        (0..1 + random.below(4)).map(|_| self.leg(depth, random)).collect()
    }

    fn leg(&mut self, depth: usize, random: &mut Random) -> Leg {
        self.names += 1;
        let id = format!("k{}", self.names);
        let kind = self.kind(depth, random);
        let emergency = match random.below(100) {
            0..12 if self.emergencies => Emergency::ForEveryCause,
            12..20 if self.emergencies => Emergency::ForLink,
            _ => Emergency::None,
        };
        let actions = if random.percent(30) { actions(kind.is_flown(), random) } else { Vec::new() };
        let own = match random.below(100) {
            0..20 if kind.is_flown() => Own::Constant,
            20..35 if kind.is_flown() => Own::Variable,
            _ => Own::None,
        };
        Leg { id, kind, emergency, own, actions }
    }

    fn kind(&mut self, depth: usize, random: &mut Random) -> Kind {
        match random.below(if depth > 0 { 24 } else { 17 }) {
            0..3 => Kind::Track(0),
            3 => Kind::Direct,
            4 => Kind::Start,
            5 => Kind::Lap,
            6 => Kind::Climb,
            7..10 => Kind::Pattern(random.below(writing::PATTERNS.len())),
            10 => Kind::Course,
            11 => Kind::ClimbOnTrack,
            12 | 13 => Kind::Hold {
                until: random.percent(40),
                laps: random.percent(50).then(|| 1 + random.below(3) as u64),
            },
            14 => Kind::Jump,
            15 => Kind::Call { nested: random.percent(60) },
            16 | 17 => Kind::Fork { default: random.percent(75), due: random.pick(&["200m", "600m", "15s"]) },
            _ => Kind::Loop {
                reverse: random.percent(50),
                count: random.percent(80).then(|| 1 + random.below(3) as u64),
                until: random.pick(&[None, None, Some("stop"), Some("iteration &gt; 1")]),
                body: self.list(depth - 1, random),
            },
        }
    }

    /// A draft that can be flown: random legs may be too steep or too short for the aircraft.
    pub fn flyable(random: &mut Random, draw: impl Fn(&mut Random) -> Self) -> (Self, Arc<Program>) {
        let mut problems = String::new();
        for _ in 0..MAX_DRAWS {
            let draft = draw(random);
            match compiled(&draft.document()) {
                Ok(program) => return (draft, program),
                Err(why) => problems = why,
            }
        }
        panic!("no draft of {MAX_DRAWS} can be flown, the last one for:\n{problems}")
    }

    /// Another draft that is mostly this one: what an operator would propose.
    pub fn edited(&self, random: &mut Random) -> Self {
        let mut draft = self.clone();
        for _ in 0..1 + random.below(3) {
            draft.names += 1;
            edit(&mut draft.legs, &format!("k{}", draft.names + 50), random);
        }
        draft
    }

    pub fn document(&self) -> String {
        let by_cause = r#"<emergency cause="energy" plan="other"/>"#;
        let legs = format!(
            "{}{}",
            if self.by_cause && self.emergencies { by_cause } else { "" },
            writing::list(&self.legs, "")
        );
        let stage = if self.by_cause && self.emergencies { r#"emergency="back""# } else { "" };
        let mut document = document_with(&legs, VARIABLES, stage);
        document = document.replace("</variables>", &format!("</variables>{}", writing::procedures()));
        if !self.emergencies {
            document = document.replace(r#"<mainPlan emergency="back">"#, "<mainPlan>");
        }
        let landing = r#"<stage id="land" type="land" runway="R"/>"#;
        if !self.landing {
            document = document.replace(landing, "");
        }
        if !self.second.is_empty() {
            let second = writing::list(&self.second, "q");
            let more = format!(
                r#"{landing}<stage id="to2" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
                <stage id="m2" type="mission" altitude="220" altitudeReference="agl">{second}</stage><stage id="land2" type="land" runway="R"/>"#
            );
            document = document.replacen(landing, &more, 1);
        }
        document
    }
}

impl Kind {
    /// It has an end of its own to circle at.
    fn is_flown(&self) -> bool {
        !matches!(self, Kind::Start | Kind::Jump | Kind::Call { .. } | Kind::Loop { .. } | Kind::Fork { .. })
    }
}

/// One or two, and a wait now and then.
fn actions(flown: bool, random: &mut Random) -> Vec<Action> {
    let (when, what) = (random.below(WHEN.len()), random.below(WHAT.len()));
    let mut actions = vec![(WHEN[when], WHAT[what])];
    if random.percent(40) {
        actions.push((WHEN[(when + 1 + random.below(5)) % 6], WHAT[(what + 1 + random.below(7)) % 8]));
    }
    actions.extend(Some(WAIT).filter(|_| flown && random.percent(25)));
    actions
}

/// One edit, in a loop's body now and then: a leg less, one more, another track, or other actions.
fn edit(list: &mut Vec<Leg>, new_id: &str, random: &mut Random) {
    let spot = random.below(list.len());
    if let Kind::Loop { body, .. } = &mut list[spot].kind
        && random.percent(60)
    {
        return edit(body, new_id, random);
    }
    let kind = Kind::Track(1 + random.below(9));
    match random.below(4) {
        0 if list.len() > 1 => drop(list.remove(spot)),
        1 => list[spot].kind = kind,
        2 => list[spot].actions = actions(list[spot].kind.is_flown(), random),
        _ => {
            let (emergency, actions) = (Emergency::None, Vec::new());
            list.insert(spot, Leg { id: new_id.into(), kind, emergency, own: Own::None, actions });
        }
    }
}
