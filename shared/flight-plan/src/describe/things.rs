//! The plan, and its parts beside legs.

use super::Row::Property as P;
use super::parts::{
    ALTITUDE, BY_CAUSES, CORNERS, DATUMS, EMERGENCY, HEAD, ID, NAME, POSITION, SPEED, element, number,
    property, text,
};
use super::{Children, Description, Kind, OneOf, Property, Quantity, Row, Sort, Way, Word};
use crate::words;

const PLAN: Description = element(
    "flightPlan",
    "Plan",
    "The whole plan.",
    &[&[
        NAME,
        P(property(
            "aircraft",
            "Aircraft",
            "The performance profile for which the plan was written.",
            Kind::Reference(Sort::Aircraft),
        )),
        P(Property {
            help: "The emergency plan of everything that names none of its own.",
            without: Some("none"),
            ..plain(EMERGENCY)
        }),
        BY_CAUSES,
    ]],
);

/// The property of a row.
const fn plain(row: Row) -> Property {
    match row {
        P(property) => property,
        _ => property("", "", "", Kind::Text),
    }
}

const FIX: Description = element(
    "fix",
    "Fix",
    "A named position.",
    &[HEAD, &[POSITION, P(text("description", "Description", "For the reader."))]],
);

const RUNWAY: Description = element(
    "runway",
    "Runway",
    "A runway, seen in its landing direction.",
    &[&[
        ID,
        P(Property { label: "Threshold", help: "The landing threshold.", ..plain(POSITION) }),
        P(number("elevation", "Elevation", Quantity::Height, -500.0, "0")
            .help("Of the threshold, above mean sea level.")),
        P(number("heading", "Heading", Quantity::Angle, 0.0, "0")
            .help("The landing direction, degrees true.")),
        P(number("length", "Length", Quantity::Length, 1.0, "600").help("What can be used of it.")),
        P(number("priority", "Priority", Quantity::Rank, 1.0, "1")
            .help("Which of several runways is preferred; 1 is the best.")),
        P(property(
            "approachEntry",
            "Approach from",
            "Where the approach to a landing begins.",
            Kind::Position,
        )
        .without("straight in")),
    ]],
);

const UNIT: Row = P(text("unit", "Unit", "Of the number, for the reader."));
const fn bound(attribute: &'static str, label: &'static str, help: &'static str) -> Row {
    P(number(attribute, label, Quantity::Plain, f64::MIN, "0").help(help).without("no limit"))
}
const MAX_LENGTH: Row = P(number("maxLength", "At most", Quantity::Count, 0.0, "100")
    .help("The most characters of a text, the most corners of a polygon.")
    .without("no limit of its own"));
const fn initial(kind: Kind, first: &'static str) -> Row {
    P(property("initial", "Initial value", "Its value when the flight begins.", kind).first(first))
}
const NUMBER: Kind =
    Kind::Number(super::Range { quantity: Quantity::Plain, least: f64::MIN, most: f64::MAX });

const VARIABLE: Description = element(
    "variable",
    "Variable",
    "A value that people and services write in flight.",
    &[&[
        P(property(
            "name",
            "Name",
            "Its name in expressions: letters, digits and _. What reads it follows.",
            Kind::Identifier,
        )),
        Row::OneOf(OneOf {
            label: "Type",
            help: "What its values are.",
            ways: &[
                Way {
                    label: words::NUMBER,
                    fixed: &[("type", "number")],
                    rows: &[
                        initial(NUMBER, "0"),
                        UNIT,
                        bound("min", "At least", "Its least value."),
                        bound("max", "At most", "Its greatest value."),
                    ],
                },
                Way {
                    label: words::YES_OR_NO,
                    fixed: &[("type", "bool")],
                    rows: &[initial(Kind::Flag, "false")],
                },
                Way {
                    label: words::TEXT,
                    fixed: &[("type", "text")],
                    rows: &[initial(Kind::Text, ""), MAX_LENGTH],
                },
                Way {
                    label: words::POSITION,
                    fixed: &[("type", "position")],
                    rows: &[initial(Kind::Position, "")],
                },
                Way {
                    label: words::AREA,
                    fixed: &[("type", "polygon")],
                    rows: &[initial(Kind::Positions, ""), MAX_LENGTH],
                },
            ],
        }),
        P(property(
            "writers",
            "Written by",
            "Who may write it in flight: operator, or names of services, with spaces between them.",
            Kind::Names,
        )
        .without("anybody")
        .first("operator")),
    ]],
);

const ACTIVE: Description = element(
    "active",
    "Period",
    "When the zone is active.",
    &[&[
        P(property("from", "From", "UTC.", Kind::Instant).first("2026-01-01T06:00:00Z")),
        P(property("until", "Until", "UTC.", Kind::Instant).first("2026-01-01T20:00:00Z")),
    ]],
);
const ZONES: &[Word] = &[("keepIn", "keep-in zone"), ("keepOut", "keep-out zone")];
const NO_FLOOR: Way = Way { label: "the ground", fixed: &[], rows: &[] };
const NO_CEILING: Way = Way { label: "none", fixed: &[], rows: &[] };

const ZONE: Description = Description {
    element: "keepOut",
    label: "Zone",
    help: "Where the whole path must be, or must not be.",
    alike: ZONES,
    groups: &[
        HEAD,
        &[
            Row::OneOf(OneOf {
                label: "Lower limit",
                help: "From where on it reaches up.",
                ways: &[
                    Way {
                        label: "an altitude",
                        fixed: &[],
                        rows: &[
                            P(number("floor", "From", Quantity::Height, -500.0, "0")
                                .help("The lower limit.")),
                            P(property(
                                "floorReference",
                                "From above",
                                "What the lower limit is measured from.",
                                Kind::Choice(DATUMS),
                            )
                            .first("amsl")),
                        ],
                    },
                    NO_FLOOR,
                ],
            }),
            Row::OneOf(OneOf {
                label: "Upper limit",
                help: "To where it reaches up.",
                ways: &[
                    Way {
                        label: "an altitude",
                        fixed: &[],
                        rows: &[
                            P(number("ceiling", "Up to", Quantity::Height, -500.0, "500")
                                .help("The upper limit.")),
                            P(property(
                                "ceilingReference",
                                "Up to above",
                                "What the upper limit is measured from.",
                                Kind::Choice(DATUMS),
                            )
                            .first("amsl")),
                        ],
                    },
                    NO_CEILING,
                ],
            }),
            Row::Children(Children {
                label: "Active",
                help: "When it is active; without a period: always. Outside of its periods it does not count, and a zone to stay in confines nothing then.",
                of: &[&ACTIVE],
                least: 0,
                most: usize::MAX,
            }),
            Row::OneOf(OneOf {
                label: "Shape",
                help: "A circle or an outline.",
                ways: &[
                    Way {
                        label: "a circle",
                        fixed: &[],
                        rows: &[
                            P(Property { label: "Centre", ..plain(POSITION) }),
                            P(number("radius", "Radius", Quantity::Length, 1.0, "300")
                                .help("From its centre to its edge.")),
                        ],
                    },
                    Way { label: "an outline", fixed: &[], rows: &[Row::Children(CORNERS)] },
                ],
            }),
        ],
    ],
};

const PARAMETER: Description = element(
    "parameter",
    "Parameter",
    "A name that the procedure's expressions may read.",
    &[&[
        P(property("name", "Name", "Letters, digits and _.", Kind::Identifier)),
        P(property(
            "default",
            "Default",
            "Its value when a call gives none; without one, every call must.",
            Kind::Formula(crate::Use::Any),
        )
        .without("each call says it")
        .first("= 0.0")),
    ]],
);
const PROCEDURE: Description = element(
    "procedure",
    "Procedure",
    "Legs that can be called from anywhere, with arguments.",
    &[
        HEAD,
        &[
            P(property(
                "reference",
                "Reference",
                "The point that is moved to the place of a call.",
                Kind::Position,
            )
            .without("can't be moved")),
            P(number("bearing", "Bearing", Quantity::Angle, 0.0, "90")
                .help("The direction that is turned to the bearing of a call.")
                .without("000°")),
            Row::Children(Children {
                label: "Parameters",
                help: "What a call may say.",
                of: &[&PARAMETER],
                least: 0,
                most: usize::MAX,
            }),
        ],
    ],
);

const EMERGENCY_PLAN: Description = element(
    "emergencyPlan",
    "Emergency plan",
    "Another way down: stages of its own that end on a runway.",
    &[
        HEAD,
        &[P(property(
            "runway",
            "Lands on",
            "The runway on which it ends. Its approach goes with it to another one.",
            Kind::Reference(Sort::Runway),
        ))],
    ],
);

const STAGES: &[Word] = &[
    ("take-off", "take-off"),
    ("departure", "departure"),
    ("en-route", "en-route"),
    ("mission", "mission"),
    ("arrival", "arrival"),
    ("approach", "approach"),
    ("land", "landing"),
];
const STAGE: Description = element(
    "stage",
    "Stage",
    "Legs with one purpose. What it says holds for its legs.",
    &[
        HEAD,
        &[
            P(property("type", "Type", "What it is for.", Kind::Choice(STAGES)).first("mission")),
            P(property("runway", "Runway", "Of a take-off or a landing.", Kind::Reference(Sort::Runway))
                .without("none")),
            ALTITUDE,
            SPEED,
            EMERGENCY,
            BY_CAUSES,
        ],
        &[
            Row::OneOf(OneOf {
                label: "Next begins",
                help: "Of a landing before another flight: with how much energy that one begins.",
                ways: &[
                    Way { label: "with what is left", fixed: &[("turnaroundEnergy", "kept")], rows: &[] },
                    Way {
                        label: "with a share",
                        fixed: &[],
                        rows: &[P(number("turnaroundEnergy", "Share", Quantity::Share, 0.05, "1")
                            .help("Of the energy that the aircraft holds."))],
                    },
                    Way { label: "with a full battery", fixed: &[], rows: &[] },
                ],
            }),
            P(number("turnaroundTime", "Ground time", Quantity::Time, 0.0, "600")
                .help("Of a landing before another flight: how long it is expected to stand until it is started again.")
                .without("none")),
        ],
    ],
);

pub(super) const ALL: &[Description] = &[PLAN, FIX, RUNWAY, VARIABLE, ZONE, PROCEDURE, EMERGENCY_PLAN, STAGE];
