//! Walking a plan: every leg with what is around it.

use crate::{
    Altitude, Area, Branch, DecideBefore, EmergencyPlan, FlightPlan, Id, IterativeForm, Leg, LegKind,
    Pattern, Place, Scan, ScanStyle, Stage, StageKind, TurnDirection, Value,
};
use std::sync::Arc;

/// Which part of the document a stage is in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Section<'a> {
    /// The main plan.
    Main,
    /// An emergency plan.
    Emergency(&'a EmergencyPlan),
}

/// A leg with what is around it.
#[derive(Debug, Clone, PartialEq)]
pub struct LegContext<'a> {
    /// The leg.
    pub leg: &'a Leg,
    /// Its stage.
    pub stage: &'a Stage,
    /// Main plan or emergency plan.
    pub section: Section<'a>,
    /// Iterative legs around it, outermost first.
    pub loops: Vec<&'a Leg>,
    /// The list it is in: its stage's legs or the innermost loop's body.
    pub siblings: &'a [Arc<Leg>],
    /// Its index in that list.
    pub index: usize,
}

impl<'a> LegContext<'a> {
    /// The leg that follows: `next` if it names a sibling, else the next in the document.
    pub fn successor(&self) -> Option<&'a Leg> {
        match &self.leg.next {
            Some(next) => self.siblings.iter().find(|l| l.id == *next),
            None => self.siblings.get(self.index + 1),
        }
        .map(Arc::as_ref)
    }

    /// The altitude that is written for the leg: its own, else that of the loops around it, else the stage's; `None`: it has
    /// that of the leg before. (A take-off's is where the climb-out ends.)
    pub fn altitude(&self) -> Option<&'a Altitude> {
        let around = self.loops.iter().rev().find_map(|leg| leg.altitude.as_ref());
        let stage = self.stage.altitude.as_ref().filter(|_| self.stage.kind != StageKind::TakeOff);
        self.leg.altitude.as_ref().or(around).or(stage)
    }
}

/// How an iterative leg repeats its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loop<'a> {
    /// Forth and back, or round and round.
    pub form: IterativeForm,
    /// How often.
    pub count: Option<&'a Value<f64>>,
    /// CEL condition that ends it.
    pub until: Option<&'a Arc<str>>,
    /// Turn direction of the full turns.
    pub turn: TurnDirection,
}

/// The branches of an intersection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fork<'a> {
    /// Ways on; empty or one: a pure merge.
    pub branches: &'a [Branch],
    /// The branch taken without a decision.
    pub default: Option<&'a Id>,
    /// When the decision is due.
    pub decide_before: DecideBefore,
}

impl Leg {
    /// How it repeats its body, if it is iterative.
    pub fn as_loop(&self) -> Option<Loop<'_>> {
        match &self.kind {
            LegKind::Iterative { form, count, until, turn, .. } => {
                Some(Loop { form: *form, count: count.as_ref(), until: until.as_ref(), turn: *turn })
            }
            _ => None,
        }
    }

    /// Its branches, if it is an intersection.
    pub fn as_fork(&self) -> Option<Fork<'_>> {
        match &self.kind {
            LegKind::Intersection { branches, default, decide_before } => {
                Some(Fork { branches, default: default.as_ref(), decide_before: *decide_before })
            }
            _ => None,
        }
    }

    /// The leg that is flown first: itself or, of a loop or a call, the first one inside, however deep.
    pub fn first_flown(&self) -> &Leg {
        self.body().first().map_or(self, |first| first.first_flown())
    }

    /// The legs inside it: the body of an iterative leg, else none.
    pub fn body(&self) -> &[Arc<Leg>] {
        match &self.kind {
            LegKind::Iterative { body, .. } => body,
            _ => &[],
        }
    }

    /// Where it goes, holds, or what it is about; `None` for control legs and polygons.
    pub fn place(&self) -> Option<&Place> {
        self.kind.place()
    }

    /// What it covers or goes around, if that is an area.
    pub fn area(&self) -> Option<&Area> {
        match &self.kind {
            LegKind::Scan(Scan { area, .. }) | LegKind::Pattern(Pattern::Contour { area, .. }) => Some(area),
            _ => None,
        }
    }

    /// What it is called in the document.
    pub fn kind_name(&self) -> &'static str {
        self.kind.name()
    }
}

impl LegKind {
    /// As [`Leg::place`].
    pub fn place(&self) -> Option<&Place> {
        match self {
            LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => {
                Some(&to.place)
            }
            LegKind::Cf { to, .. } | LegKind::Fa { from: to, .. } => Some(&to.place),
            LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => Some(&h.fix.place),
            LegKind::Orbit { centre, .. } => Some(centre),
            LegKind::Scan(scan) => scan.area.centre(),
            LegKind::Pattern(pattern) => pattern.centre(),
            LegKind::Call(call) => call.anchor.as_ref(),
            LegKind::Iterative { .. } | LegKind::Intersection { .. } => None,
        }
    }

    /// As [`Leg::kind_name`].
    pub fn name(&self) -> &'static str {
        match self {
            LegKind::If(_) => "IF",
            LegKind::Tf(_) => "TF",
            LegKind::Df { .. } => "DF",
            LegKind::Rf { .. } => "RF",
            LegKind::Hf(_) => "HF",
            LegKind::Ha(_) => "HA",
            LegKind::Cf { .. } => "CF",
            LegKind::Fa { .. } => "FA",
            LegKind::Hm { .. } => "HM",
            LegKind::Iterative { .. } => "iterative",
            LegKind::Intersection { .. } => "intersection",
            LegKind::Scan(scan) => match scan.style {
                ScanStyle::Parallel => "scan",
                ScanStyle::Creeping => "creepingLine",
                ScanStyle::CrissCross => "crissCross",
            },
            LegKind::Pattern(pattern) => pattern.name(),
            LegKind::Call(_) => "call",
            LegKind::Orbit { .. } => "orbit",
        }
    }
}

impl Area {
    /// The centre of a circle.
    pub fn centre(&self) -> Option<&Place> {
        match self {
            Area::Circle { centre, .. } => Some(centre),
            Area::Polygon { .. } | Area::Expression(_) => None,
        }
    }
}

impl Pattern {
    /// What it is about, or where its route begins.
    pub fn centre(&self) -> Option<&Place> {
        match self {
            Pattern::Spiral { centre, .. }
            | Pattern::ExpandingSquare { centre, .. }
            | Pattern::Sector { centre, .. }
            | Pattern::FigureEight { centre, .. } => Some(centre),
            Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. } => route.first(),
            Pattern::Contour { area, .. } => area.centre(),
        }
    }

    /// What it is called in the document.
    pub fn name(&self) -> &'static str {
        match self {
            Pattern::Spiral { .. } => "spiral",
            Pattern::ExpandingSquare { .. } => "expandingSquare",
            Pattern::Sector { .. } => "sector",
            Pattern::TrackLine { .. } => "trackLine",
            Pattern::Corridor { .. } => "corridor",
            Pattern::Contour { .. } => "contour",
            Pattern::FigureEight { .. } => "figureEight",
        }
    }
}

impl Stage {
    /// The stage as it is by itself.
    pub fn without_legs(&self) -> Stage {
        let Stage { id, name, kind, emergency, runway, altitude, speed_mps, turnaround, legs: _ } = self;
        Stage {
            id: id.clone(),
            name: name.clone(),
            kind: *kind,
            emergency: emergency.clone(),
            runway: runway.clone(),
            altitude: altitude.clone(),
            speed_mps: speed_mps.clone(),
            turnaround: *turnaround,
            legs: Vec::new(),
        }
    }
}

impl FlightPlan {
    /// Every stage in document order, with its section.
    pub fn all_stages(&self) -> impl Iterator<Item = (Section<'_>, &Stage)> {
        let main = self.stages.iter().map(|s| (Section::Main, s));
        main.chain(
            self.emergency_plans
                .iter()
                .flat_map(|e| e.stages.iter().map(move |s| (Section::Emergency(e), s))),
        )
    }

    /// Every leg in document order, a loop before its body.
    pub fn all_legs(&self) -> Vec<LegContext<'_>> {
        let mut found = Vec::new();
        for (section, stage) in self.all_stages() {
            collect(&stage.legs, stage, section, &mut Vec::new(), &mut found);
        }
        found
    }

    /// A leg by its identifier, with what is around it.
    pub fn leg(&self, id: &Id) -> Option<LegContext<'_>> {
        self.all_stages().find_map(|(section, stage)| {
            let mut loops = Vec::new();
            let (siblings, index) = find(&stage.legs, id, &mut loops)?;
            Some(LegContext { leg: siblings.get(index)?, stage, section, loops, siblings, index })
        })
    }

    /// The leg (not the stage) at a place, with what is around it.
    pub(crate) fn leg_at(&self, path: &crate::LegPath) -> Option<LegContext<'_>> {
        let plan = path.emergency_plan.map(|index| self.emergency_plans.get(index));
        let (section, stages) = match plan {
            None => (Section::Main, &self.stages),
            Some(plan) => (Section::Emergency(plan?), &plan?.stages),
        };
        let stage = stages.get(path.stage)?;
        let (&index, outer) = path.indices.split_last()?;
        let (mut loops, mut siblings) = (Vec::with_capacity(outer.len()), stage.legs.as_slice());
        for &index in outer {
            let around: &Leg = siblings.get(index)?;
            loops.push(around);
            siblings = around.body();
        }
        Some(LegContext { leg: siblings.get(index)?, stage, section, loops, siblings, index })
    }

    /// A leg of a procedure by its identifier there, with the procedure.
    pub fn procedure_leg(&self, id: &Id) -> Option<(&crate::Procedure, &Leg)> {
        self.procedures.iter().find_map(|procedure| Some((procedure, leg_in(&procedure.legs, id)?)))
    }

    /// Every leg of the procedures, those in loops too.
    pub fn procedure_legs(&self) -> Vec<&Arc<Leg>> {
        self.procedures.iter().flat_map(|procedure| crate::create::legs_in(&procedure.legs)).collect()
    }

    /// A leg by its identifier, in a stage or in a procedure.
    pub fn any_leg(&self, id: &Id) -> Option<&Leg> {
        let flown = self.all_stages().find_map(|(_, stage)| leg_in(&stage.legs, id));
        flown.or_else(|| self.procedure_leg(id).map(|(_, leg)| leg))
    }

    /// A stage by its identifier.
    pub fn stage(&self, id: &Id) -> Option<&Stage> {
        self.all_stages().map(|(_, s)| s).find(|s| s.id == *id)
    }

    /// A fix by its identifier.
    pub fn fix(&self, id: &Id) -> Option<&crate::Fix> {
        self.fixes.iter().find(|f| f.id == *id)
    }

    /// A runway by its identifier.
    pub fn runway(&self, id: &Id) -> Option<&crate::Runway> {
        self.runways.iter().find(|r| r.id == *id)
    }

    /// A variable by its name.
    pub fn variable(&self, name: &Id) -> Option<&crate::Variable> {
        self.variables.iter().find(|v| v.name == *name)
    }

    /// A zone by its identifier.
    pub fn zone(&self, id: &Id) -> Option<&crate::Zone> {
        self.zones.iter().find(|z| z.id == *id)
    }

    /// A procedure by its identifier.
    pub fn procedure(&self, id: &Id) -> Option<&crate::Procedure> {
        self.procedures.iter().find(|p| p.id == *id)
    }

    /// An emergency plan by its identifier.
    pub fn emergency_plan(&self, id: &Id) -> Option<&EmergencyPlan> {
        self.emergency_plans.iter().find(|e| e.id == *id)
    }

    /// Indices of the main plan's stages with which a flight begins: the first one, and each behind a landing.
    pub fn flights(&self) -> impl Iterator<Item = usize> {
        let begins = |index: &usize| {
            let before = index.checked_sub(1).and_then(|before| self.stages.get(before));
            before.is_none_or(|stage| stage.kind == crate::StageKind::Land)
        };
        (0..self.stages.len()).filter(begins)
    }

    /// Which flight a stage of the main plan belongs to, from 1.
    pub fn flight_of(&self, stage: usize) -> usize {
        self.flights().take_while(|first| *first <= stage).count()
    }

    /// The runway of the first take-off stage: where the aircraft stands before the first flight, and what `home` altitudes are above
    /// in that.
    pub fn home(&self) -> Option<&crate::Runway> {
        self.runway(self.take_offs().next()?.runway.as_ref()?)
    }

    /// The runway that `home` altitudes are above at a stage of the main plan: of the flight's own take-off; before any, of the first.
    pub fn home_at(&self, stage: usize) -> Option<&crate::Runway> {
        let mut up_to = self.stages.iter().take(stage.saturating_add(1));
        let last = up_to.rfind(|s| s.kind == crate::StageKind::TakeOff);
        last.and_then(|s| self.runway(s.runway.as_ref()?)).or_else(|| self.home())
    }

    /// The home of whatever flight of the plan, for what is flown in any of them (emergency plans, zones); `None`: they take off from
    /// runways of different elevations, or not at all.
    pub fn common_home(&self) -> Option<&crate::Runway> {
        let home = self.home()?;
        let mut others = self.take_offs().filter_map(|s| self.runway(s.runway.as_ref()?));
        others.all(|other| other.elevation_amsl_m == home.elevation_amsl_m).then_some(home)
    }

    fn take_offs(&self) -> impl Iterator<Item = &Stage> {
        self.stages.iter().filter(|s| s.kind == crate::StageKind::TakeOff)
    }

    /// What ground of which no elevation is known is not taken to lie below: the sea, or the lowest runway if that is lower
    /// still, metres AMSL.
    pub fn lowest_ground_amsl_m(&self) -> f64 {
        self.runways.iter().map(|runway| runway.elevation_amsl_m).fold(0.0, f64::min)
    }
}

fn leg_in<'a>(legs: &'a [Arc<Leg>], id: &Id) -> Option<&'a Leg> {
    legs.iter().find_map(|leg| if leg.id == *id { Some(leg.as_ref()) } else { leg_in(leg.body(), id) })
}

/// The list that a leg is in and its index there; what is around it is left in `loops`, outermost first.
fn find<'a>(legs: &'a [Arc<Leg>], id: &Id, loops: &mut Vec<&'a Leg>) -> Option<(&'a [Arc<Leg>], usize)> {
    for (index, leg) in legs.iter().enumerate() {
        if leg.id == *id {
            return Some((legs, index));
        }
        loops.push(leg);
        let inside = find(leg.body(), id, loops);
        if inside.is_some() {
            return inside;
        }
        loops.pop();
    }
    None
}

fn collect<'a>(
    legs: &'a [Arc<Leg>],
    stage: &'a Stage,
    section: Section<'a>,
    loops: &mut Vec<&'a Leg>,
    found: &mut Vec<LegContext<'a>>,
) {
    for (index, leg) in legs.iter().enumerate() {
        found.push(LegContext { leg, stage, section, loops: loops.clone(), siblings: legs, index });
        loops.push(leg);
        collect(leg.body(), stage, section, loops, found);
        loops.pop();
    }
}
