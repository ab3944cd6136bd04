//! What goes into the executor and what comes out of it.

use crate::{Convert, same_fields, same_variants};
use flight_exec as domain;

impl Convert<contract::Token> for domain::Token {
    fn convert(self) -> contract::Token {
        contract::Token(self.0)
    }
}

impl Convert<domain::Token> for contract::Token {
    fn convert(self) -> domain::Token {
        domain::Token(self.0)
    }
}

same_variants!(domain::Action = contract::Action {
    TakeOff { heading_deg },
    Fly,
    Loiter { radius_m },
    Land { heading_deg },
});

same_fields!(
    domain::Waypoint = contract::Waypoint {
        token,
        position,
        altitude_amsl_m,
        airspeed_mps,
        action,
        fly_over,
        on_arc,
        leg,
        end_of_plan,
    }
);

same_variants!(domain::Command = contract::Command {
    Start,
    Hold,
    Resume,
    SkipLeg,
    GoTo { leg },
    SetCount { leg, count },
    Decide { leg, branch },
    SetVariable { name, value },
    Emergency { cause, plan },
    ReturnToMain { leg },
    AbortToSafe,
    Rewind,
    Commit { hash, entry },
});

same_fields!(domain::Refusal = contract::Refusal { code, reason });

same_variants!(
    domain::Phase = contract::Phase { Idle, Flying, Holding, AwaitingDecision, Finished, Grounded }
);

same_variants!(domain::Branching = contract::Branching { Main, Emergency(plan) });

same_fields!(domain::IterationPlace = contract::IterationPlace { leg, iteration, of, reverse });

same_fields!(
    domain::PlacePointer = contract::PlacePointer { plan, stage, leg, iterations, reverse, distance_m }
);

same_fields!(domain::BranchOption = contract::BranchOption { branch, label, preview });

same_fields!(
    domain::DecisionRequest =
        contract::DecisionRequest { leg, options, default, distance_left_m, time_left_s }
);

same_fields!(
    domain::Status = contract::PlanStatus {
        phase,
        plan,
        revision,
        place,
        emergency,
        emergency_in_force,
        current,
        outstanding,
        decision,
        proposed,
        wait_left_s,
    }
);

same_fields!(domain::PathPoint = contract::PathPoint { time_s, position, altitude_amsl_m });

same_fields!(
    domain::Foresight = contract::Foresight {
        path,
        next_leg,
        left_out,
        short_of_altitude_m,
        clearance_m,
        problems,
        time_s,
        distance_m,
        battery_left,
        landed,
        cut_short,
    }
);

same_fields!(domain::EntryReport = contract::EntryReport { leg, position, in_m, in_s });

same_fields!(
    domain::ProposalReport = contract::ProposalReport {
        hash,
        acceptable,
        problems,
        added,
        removed,
        changed,
        unchanged,
        next_leg,
        next_position,
        next_in_m,
        next_in_s,
        differs_in_m,
        differs_in_s,
        entry_needed,
        entries,
    }
);

same_variants!(domain::ResolvedAct = contract::ResolvedAct {
    Photo,
    PhotoSeries { every_m },
    PhotoStop,
    VideoStart,
    VideoStop,
    Set { variable, value },
    Invoke { service, operation, argument },
    Wait { seconds },
});

same_variants!(domain::Event = contract::PlanEvent {
    LegEntered { place },
    IterationFinished { leg, finished, of },
    DecisionRequested(request),
    DecisionTaken { leg, branch, by },
    VariableChanged { name, value, by },
    ActionDone { leg, passage, act },
    ActionRefused { leg, passage, reason },
    PatternRefused { leg, reason },
    ExpressionFailed { leg, reason },
    PlanActivated { hash, revision },
    EmergencyStarted { cause, plan, from_leg },
    EmergencyUnanswered { cause, plan, code, reason },
    PhaseChanged { phase },
    WaypointsRejected { leg, reason },
    ProblemAhead { leg, code, reason },
    NotGranted { request, reason },
    NotJournalled { reason },
    Journalled,
});
