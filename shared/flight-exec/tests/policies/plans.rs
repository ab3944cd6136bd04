//! Random plans: every kind of control leg, nested; small enough that a flight meets all of it.

use crate::grid::{HOME, compiled, document_with};
use crate::random::Random;
use flight_plan::Program;
use std::sync::Arc;

/// Nearly every draft can be flown.
const MOST_DRAWS: usize = 50;

/// `r` shapes the scans, `stop` ends loops, `n` counts passes.
const VARIABLES: &str = r#"<variable name="r" type="number" initial="500" min="10" max="1500"/>
    <variable name="stop" type="bool" initial="false"/>
    <variable name="n" type="number" initial="2" min="1" max="4"/>
    <variable name="note" type="text" initial="" maxLength="8"/>"#;

/// A leg without a name; lists give them theirs.
#[derive(Debug, Clone)]
pub enum Kind {
    /// Variants of a leg are at other places.
    Track(usize),
    Direct,
    Start,
    Lap,
    Climb,
    Scan,
    Orbit,
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
    pub emergency: &'static str,
}

/// What a document is made of.
#[derive(Debug, Clone)]
pub struct Draft {
    pub legs: Vec<Leg>,
    pub emergencies: bool,
    pub by_cause: bool,
    pub landing: bool,
    pub names: usize,
}

impl Draft {
    pub fn new(random: &mut Random) -> Self {
        let mut draft = Self {
            legs: Vec::new(),
            emergencies: random.percent(92),
            by_cause: random.percent(40),
            landing: random.percent(85),
            names: 0,
        };
        draft.legs = draft.list(2, random);
        draft
    }

    fn list(&mut self, depth: usize, random: &mut Random) -> Vec<Leg> {
        (0..1 + random.below(4)).map(|_| self.leg(depth, random)).collect()
    }

    fn leg(&mut self, depth: usize, random: &mut Random) -> Leg {
        self.names += 1;
        let id = format!("k{}", self.names);
        let kind = self.kind(depth, random);
        let emergency = if self.emergencies && random.percent(15) { r#" emergency="other""# } else { "" };
        Leg { id, kind, emergency }
    }

    fn kind(&mut self, depth: usize, random: &mut Random) -> Kind {
        match random.below(if depth > 0 { 16 } else { 11 }) {
            0..3 => Kind::Track(0),
            3 => Kind::Direct,
            4 => Kind::Start,
            5 => Kind::Lap,
            6 => Kind::Climb,
            7 => Kind::Scan,
            8 => Kind::Orbit,
            9 => Kind::Jump,
            10 | 11 => Kind::Fork { default: random.percent(75), due: random.pick(&["200m", "600m", "15s"]) },
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
        for _ in 0..MOST_DRAWS {
            let draft = draw(random);
            match compiled(&draft.document()) {
                Ok(program) => return (draft, program),
                Err(why) => problems = why,
            }
        }
        panic!("no draft of {MOST_DRAWS} can be flown, the last one for:\n{problems}")
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
            write(&self.legs, "")
        );
        let stage = if self.by_cause && self.emergencies { r#"emergency="back""# } else { "" };
        let mut document = document_with(&legs, VARIABLES, stage);
        if !self.emergencies {
            document = document.replace(r#"<mainPlan emergency="back">"#, "<mainPlan>");
        }
        if !self.landing {
            document = document.replace(r#"<stage id="land" type="land" runway="R"/>"#, "");
        }
        document
    }
}

/// One edit, in a loop's body now and then: a leg less, one more, or another track.
fn edit(list: &mut Vec<Leg>, new_id: &str, random: &mut Random) {
    let spot = random.below(list.len());
    if let Kind::Loop { body, .. } = &mut list[spot].kind
        && random.percent(60)
    {
        return edit(body, new_id, random);
    }
    let kind = Kind::Track(1 + random.below(9));
    match random.below(3) {
        0 if list.len() > 1 => drop(list.remove(spot)),
        1 => list[spot].kind = kind,
        _ => list.insert(spot, Leg { id: new_id.into(), kind, emergency: "" }),
    }
}

/// A track at each end: every body flies something.
fn write(legs: &[Leg], prefix: &str) -> String {
    let body: String = legs.iter().map(one).collect();
    format!("{}{body}{}", track(&format!("{prefix}s"), ""), track(&format!("{prefix}z"), ""))
}

fn track(id: &str, attributes: &str) -> String {
    format!(r#"<TF id="{id}" {}{attributes}/>"#, spot(id))
}

/// A place of its own for each name, within ten kilometres (FNV-1a of the name).
fn spot(name: &str) -> String {
    let hash = name
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325, |h: u64, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    let metres = |bits: u64| 10_000.0 * (bits % 1009) as f64 / 1009.0;
    let at = HOME.destination(90.0, metres(hash >> 40)).destination(0.0, metres(hash >> 20));
    format!(r#"lat="{:.6}" lon="{:.6}""#, at.lat_deg, at.lon_deg)
}

fn one(leg: &Leg) -> String {
    let Leg { id, emergency, .. } = leg;
    let here = spot(id);
    match &leg.kind {
        Kind::Track(variant) => format!(r#"<TF id="{id}" {}{emergency}/>"#, spot(&format!("{id}{variant}"))),
        Kind::Direct => format!(r#"<DF id="{id}" {here}{emergency}/>"#),
        Kind::Start => format!(r#"<IF id="{id}" {here}/>"#),
        Kind::Lap => format!(r#"<HF id="{id}" {here} course="0" turn="left" length="600"{emergency}/>"#),
        Kind::Climb => format!(
            r#"<HA id="{id}" {here} course="90" turn="right" length="600" altitude="600" altitudeReference="amsl"/>"#
        ),
        Kind::Scan => format!(
            r#"<scan id="{id}" spacing="= r * 0.5" heading="0" overshoot="50"{emergency}><area fix="C3" radius="= r"/></scan>"#
        ),
        Kind::Orbit => format!(
            r#"<orbit id="{id}" radius="= 200.0 + r * 0.2" turns="1" turn="left"><centre fix="D2"/></orbit>"#
        ),
        Kind::Jump => {
            let (over, to) = (format!("{id}-x"), format!("{id}-y"));
            track(id, &format!(r#" next="{to}""#)) + &track(&over, "") + &track(&to, "")
        }
        Kind::Loop { reverse, count, until, body } => {
            let form = if *reverse { "reverse" } else { "forward" };
            let until = until.map_or(String::new(), |u| format!(r#" until="{u}""#));
            let count = count.map_or("= n".into(), |c| c.to_string());
            let body = write(body, &format!("{id}-"));
            format!(
                r#"<iterative id="{id}" form="{form}" count="{count}"{until}{emergency}>{body}</iterative>"#
            )
        }
        Kind::Fork { default, due } => {
            let default = if *default { format!(r#" default="{id}-s""#) } else { String::new() };
            let (long, both) = (format!("{id}-d"), format!("{id}-e"));
            format!(
                r#"<intersection id="{id}"{default} decideBefore="{due}">
                   <branch id="{id}-s" label="s" next="{both}"/><branch id="{id}-l" label="l" next="{long}" when="r &gt; 900.0"/></intersection>
                   {}{}"#,
                track(&long, ""),
                track(&both, "")
            )
        }
    }
}
