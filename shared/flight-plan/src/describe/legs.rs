//! Legs that fly a path of their own, and control legs.

use super::Row::Property as P;
use super::actions::ACTIONS;
use super::parts::{
    ALTITUDE, ANCHOR, BY_CAUSES, EMERGENCY, FLY_OVER, HEAD, SPEED, TO, TURN, element, property, text, value,
};
use super::{Children, Description, Kind, OneOf, Property, Quantity, Row, Sort, Way, Word};
use crate::create::LegChoice;

pub(super) const TAIL: &[Row] = &[
    ALTITUDE,
    SPEED,
    ACTIONS,
    EMERGENCY,
    BY_CAUSES,
    P(property("next", "Next", "The leg that follows, in the same list.", Kind::Reference(Sort::Leg))
        .without("the leg after it")),
];

const COURSE: Row = P(value("course", "Course", Quantity::Angle, 0.0, "0")
    .help("The track's direction at the fix, degrees true."));
const HOLDING: &[Row] = &[
    TO,
    FLY_OVER,
    P(value("course", "Inbound course", Quantity::Angle, 0.0, "0")
        .help("The course to the fix, degrees true.")
        .without("as the path arrives")),
    P(TURN),
    Row::OneOf(OneOf {
        label: "Straight legs",
        help: "How long the straight legs of the racetrack are.",
        ways: &[
            Way {
                label: "a distance",
                fixed: &[],
                rows: &[P(value("length", "Leg length", Quantity::Length, 1.0, "600")
                    .help("Length of the straight legs."))],
            },
            Way {
                label: "a time",
                fixed: &[],
                rows: &[P(value("time", "Leg time", Quantity::Time, 1.0, "60")
                    .help("Time on each of the straight legs."))],
            },
        ],
    }),
];
const UNTIL: Property =
    property("until", "Until", "It ends when this condition holds.", Kind::Condition).first("iteration >= 3");

const FORMS: &[Word] = &[("forward", "round and round"), ("reverse", "forth and back")];
const BRANCH: Description = element(
    "branch",
    "Branch",
    "A way on from the fork.",
    &[&[
        P(property("id", "Identifier", "Unique at its fork.", Kind::Identifier)),
        P(text("label", "Label", "What the operator reads.")),
        P(property("next", "Leads to", "The leg it leads to, in the same list.", Kind::Reference(Sort::Leg))
            .without("the leg after it")),
        P(property(
            "when",
            "When",
            "It is taken when this condition holds and nobody has decided.",
            Kind::Condition,
        )
        .without("only when decided")
        .first("battery < 0.3")),
    ]],
);
const ARGUMENT: Description = element(
    "argument",
    "Argument",
    "The value of one of the procedure's parameters.",
    &[&[
        P(property("name", "Parameter", "The parameter.", Kind::Reference(Sort::Parameter))),
        P(property(
            "value",
            "Value",
            "An expression of the parameter's type.",
            Kind::Formula(crate::Use::Any),
        )
        .first("= 0.0")),
    ]],
);

const fn many(label: &'static str, help: &'static str, of: &'static [&'static Description]) -> Row {
    Row::Children(Children { label, help, of, least: 0, most: usize::MAX })
}

pub(super) const ALL: &[Description] = &[
    element(
        "IF",
        LegChoice::If.label(),
        "Where a path starts; flies nothing.",
        &[HEAD, &[TO, FLY_OVER], TAIL],
    ),
    element(
        "TF",
        LegChoice::Tf.label(),
        "The shortest track from the previous waypoint.",
        &[HEAD, &[TO, FLY_OVER], TAIL],
    ),
    element(
        "DF",
        LegChoice::Df.label(),
        "Straight from where the aircraft is.",
        &[
            HEAD,
            &[
                TO,
                FLY_OVER,
                P(Property { help: "The side of its first turn.", ..TURN }.without("the shorter way")),
            ],
            TAIL,
        ],
    ),
    element(
        "RF",
        LegChoice::Rf.label(),
        "An arc of constant radius.",
        &[
            HEAD,
            &[
                TO,
                FLY_OVER,
                P(property("centreLat", "Centre", "The centre of the arc.", Kind::LatLon("centreLon"))),
                P(TURN),
            ],
            TAIL,
        ],
    ),
    element(
        "CF",
        LegChoice::Cf.label(),
        "A course into a fix, intercepted and tracked.",
        &[HEAD, &[TO, FLY_OVER, COURSE], TAIL],
    ),
    element(
        "FA",
        LegChoice::Fa.label(),
        "A track from a fix until the leg's altitude is reached.",
        &[HEAD, &[TO, FLY_OVER, COURSE], TAIL],
    ),
    element(
        "HF",
        LegChoice::Hf.label(),
        "A racetrack, left at the first crossing of its fix.",
        &[HEAD, HOLDING, TAIL],
    ),
    element(
        "HA",
        LegChoice::Ha.label(),
        "A racetrack, left at the first crossing at or beyond the leg's altitude.",
        &[HEAD, HOLDING, TAIL],
    ),
    element(
        "HM",
        LegChoice::Hm.label(),
        "A racetrack, left when its condition holds, its laps are flown or somebody releases it.",
        &[
            HEAD,
            HOLDING,
            &[
                P(UNTIL.without("only when released")),
                P(value("maxLaps", "Most laps", Quantity::Count, 1.0, "10")
                    .help("It is left after so many laps at the latest.")
                    .without("any number")),
            ],
            TAIL,
        ],
    ),
    element(
        "iterative",
        LegChoice::Iterative.label(),
        "Flies the legs inside it again and again.",
        &[
            HEAD,
            &[
                P(property("form", "Form", "Round and round, or forth and back.", Kind::Choice(FORMS))
                    .first("forward")),
                P(value("count", "Count", Quantity::Count, 1.0, "2")
                    .help("How often; with a condition: at most.")
                    .without("until its condition holds")),
                P(UNTIL.without("only by its count")),
                P(Property { help: "The side of the full turns at each end.", ..TURN }),
            ],
            TAIL,
        ],
    ),
    element(
        "intersection",
        LegChoice::Intersection.label(),
        "Ways part here, or come together.",
        &[
            HEAD,
            &[
                many("Branches", "The ways on; none or one: ways come together here.", &[&BRANCH]),
                P(property(
                    "default",
                    "Default",
                    "The branch that is taken when nobody has decided and no condition holds.",
                    Kind::Reference(Sort::Branch),
                )
                .without("none: hold and ask")),
                P(property(
                    "decideBefore",
                    "Decide before",
                    "How far ahead of the fork the decision is due.",
                    Kind::Ahead,
                )
                .first("30s")),
            ],
            TAIL,
        ],
    ),
    element(
        "call",
        LegChoice::Call.label(),
        "A procedure, flown here.",
        &[
            HEAD,
            &[
                P(property("procedure", "Procedure", "The procedure.", Kind::Reference(Sort::Procedure))),
                ANCHOR,
                P(value("bearing", "Bearing", Quantity::Angle, 0.0, "0")
                    .help("What the procedure's bearing is turned to, degrees true.")
                    .without("not turned")),
                many("Arguments", "Values of the procedure's parameters.", &[&ARGUMENT]),
            ],
            TAIL,
        ],
    ),
];
