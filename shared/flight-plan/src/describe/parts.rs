//! What several elements have in common.

use super::Row::Property as P;
use super::{Children, Description, Kind, OneOf, Property, Quantity, Range, Row, Sort, Way, Word};
use crate::model::Cause;

const ANY: f64 = f64::MAX;

pub(super) const fn text(attribute: &'static str, label: &'static str, help: &'static str) -> Property {
    property(attribute, label, help, Kind::Text).without("none")
}

/// Of an element that has this name alone.
pub(super) const fn element(
    element: &'static str,
    label: &'static str,
    help: &'static str,
    groups: &'static [&'static [Row]],
) -> Description {
    Description { element, label, help, alike: &[], groups }
}

/// Must be there; without a first value.
pub(super) const fn property(
    attribute: &'static str,
    label: &'static str,
    help: &'static str,
    kind: Kind,
) -> Property {
    Property { attribute, label, help, kind, without: None, first: "" }
}

/// A number or a formula, from some least value on.
pub(super) const fn value(
    attribute: &'static str,
    label: &'static str,
    quantity: Quantity,
    least: f64,
    first: &'static str,
) -> Property {
    let range = Range { quantity, least, most: most(quantity) };
    property(attribute, label, "", Kind::Value(range)).first(first)
}

/// A number.
pub(super) const fn number(
    attribute: &'static str,
    label: &'static str,
    quantity: Quantity,
    least: f64,
    first: &'static str,
) -> Property {
    let range = Range { quantity, least, most: most(quantity) };
    property(attribute, label, "", Kind::Number(range)).first(first)
}

const fn most(quantity: Quantity) -> f64 {
    match quantity {
        Quantity::Share => 1.0,
        Quantity::Angle => 360.0,
        _ => ANY,
    }
}

impl Property {
    pub(super) const fn help(self, help: &'static str) -> Self {
        Self { help, ..self }
    }
    pub(super) const fn without(self, said: &'static str) -> Self {
        Self { without: Some(said), ..self }
    }
    pub(super) const fn first(self, first: &'static str) -> Self {
        Self { first, ..self }
    }
}

pub(super) const ID: Row = P(property(
    "id",
    "Identifier",
    "Unique in the plan. By it a flight keeps its place when the plan is changed; what refers to it follows.",
    Kind::Identifier,
));
pub(super) const NAME: Row = P(text("name", "Name", "What people call it."));
pub(super) const HEAD: &[Row] = &[ID, NAME];

pub(super) const TURNS: &[Word] = &[("left", "left"), ("right", "right")];
pub(super) const DATUMS: &[Word] = &[("amsl", "AMSL"), ("agl", "AGL"), ("home", "home")];

pub(super) const TURN: Property =
    property("turn", "Turn", "The side to which it turns.", Kind::Choice(TURNS)).first("right");
pub(super) const FLY_OVER: Row = P(property(
    "flyOver",
    "Fly over",
    "Cross the waypoint before turning, instead of cutting the corner.",
    Kind::Flag,
)
.without("cuts the corner")
.first("true"));

const FIX: Property = property("fix", "Fix", "A fix of the plan.", Kind::Reference(Sort::Fix));
const LAT_LON: Property =
    property("lat", "Position", "Latitude and longitude, degrees.", Kind::LatLon("lon"));
pub(super) const POSITION: Row = P(LAT_LON);
const AT: Property = property(
    "at",
    "Formula",
    "An expression that gives a position, such as a variable.",
    Kind::Formula(crate::Use::Position),
)
.first("= position");

pub(super) const PLACE_WAYS: &[Way] = &[
    Way { label: "a fix", fixed: &[], rows: &[P(FIX)] },
    Way { label: "a position", fixed: &[], rows: &[P(LAT_LON)] },
    Way { label: "a formula", fixed: &[], rows: &[P(AT)] },
];
pub(super) const TO: Row = Row::OneOf(OneOf { label: "To", help: "Where the leg goes.", ways: PLACE_WAYS });
const fn place(label: &'static str, help: &'static str) -> Row {
    Row::OneOf(OneOf { label, help, ways: PLACE_WAYS })
}
pub(super) const ANCHOR: Row = Row::OneOf(OneOf {
    label: "Put at",
    help: "Where the procedure's reference point comes to.",
    ways: &[
        Way { label: "a fix", fixed: &[], rows: &[P(FIX)] },
        Way { label: "a position", fixed: &[], rows: &[P(LAT_LON)] },
        Way { label: "a formula", fixed: &[], rows: &[P(AT)] },
        Way { label: "where it was drawn", fixed: &[], rows: &[] },
    ],
});
pub(super) const ABEAM: &[Way] = &[
    Way { label: "abeam a fix", fixed: &[("on", "abeam")], rows: &[P(FIX)] },
    Way { label: "abeam a position", fixed: &[("on", "abeam")], rows: &[P(LAT_LON)] },
    Way { label: "abeam a formula", fixed: &[("on", "abeam")], rows: &[P(AT)] },
];

pub(super) const CORNER: Description = element("corner", "Corner", "A corner of an outline.", &[&[POSITION]]);
pub(super) const CORNERS: Children = Children {
    label: "Corners",
    help: "The outline, not closed: the last corner is joined to the first.",
    of: &[&CORNER],
    least: 3,
    most: usize::MAX,
};

const RADIUS: Row =
    P(value("radius", "Radius", Quantity::Length, 1.0, "300").help("From its centre to its edge."));
pub(super) const HOLE: Description =
    element("hole", "Hole", "A part of the area that does not belong to it.", &[&[Row::Children(CORNERS)]]);
const AREA: Description = Description {
    element: "area",
    label: "Area",
    help: "What the pattern covers.",
    alike: &[],
    groups: &[&[Row::OneOf(OneOf {
        label: "Area",
        help: "A circle, an outline with holes, or the polygon that a formula gives.",
        ways: &[
            Way {
                label: "an outline",
                fixed: &[],
                rows: &[
                    Row::Children(CORNERS),
                    Row::Children(Children {
                        label: "Holes",
                        help: "Inside the outline, not touching each other.",
                        of: &[&HOLE],
                        least: 0,
                        most: usize::MAX,
                    }),
                ],
            },
            Way { label: "a circle at a fix", fixed: &[], rows: &[P(FIX), RADIUS] },
            Way { label: "a circle at a position", fixed: &[], rows: &[P(LAT_LON), RADIUS] },
            Way {
                label: "a circle at a formula",
                fixed: &[],
                rows: &[
                    P(property(
                        "centre",
                        "Centre",
                        "An expression that gives a position, such as a variable.",
                        Kind::Formula(crate::Use::Position),
                    )
                    .first("= position")),
                    RADIUS,
                ],
            },
            Way {
                label: "a polygon by a formula",
                fixed: &[],
                rows: &[P(property(
                    "polygon",
                    "Polygon",
                    "An expression that gives a polygon: a variable.",
                    Kind::Formula(crate::Use::Polygon),
                ))],
            },
        ],
    })]],
};
const CENTRE: Description = element(
    "centre",
    "Centre",
    "What the pattern is about.",
    &[&[place("Centre", "What the pattern is about.")]],
);
const POINT: Description =
    element("point", "Point", "A point of the route.", &[&[place("Point", "A point of the route.")]]);
const ROUTE: Description = Description {
    element: "route",
    label: "Route",
    help: "What the pattern follows.",
    alike: &[],
    groups: &[&[Row::Children(Children {
        label: "Points",
        help: "In the order in which they are followed.",
        of: &[&POINT],
        least: 2,
        most: usize::MAX,
    })]],
};

const fn exactly_one(label: &'static str, of: &'static [&'static Description]) -> Row {
    Row::Children(Children { label, help: "", of, least: 1, most: 1 })
}

pub(super) const THE_AREA: Row = exactly_one("Area", &[&AREA]);
pub(super) const THE_CENTRE: Row = exactly_one("Centre", &[&CENTRE]);
pub(super) const THE_ROUTE: Row = exactly_one("Route", &[&ROUTE]);

pub(super) const SPEED: Row = P(value("speed", "Airspeed", Quantity::Speed, 1.0, "20")
    .help("Airspeed on the way.")
    .without("inherited"));
pub(super) const ALTITUDE: Row = Row::OneOf(OneOf {
    label: "Altitude",
    help: "The altitude at its end.",
    ways: &[
        Way {
            label: "its own",
            fixed: &[],
            rows: &[
                P(value("altitude", "Altitude", Quantity::Height, -500.0, "150")
                    .help("Metres above its reference.")),
                P(property("altitudeReference", "Above", "What it is measured from.", Kind::Choice(DATUMS))
                    .first("home")),
            ],
        },
        Way { label: "inherited", fixed: &[], rows: &[] },
    ],
});

pub(super) const EMERGENCY: Row = P(property(
    "emergency",
    "Alternate",
    "The emergency plan for every cause that has none of its own.",
    Kind::Reference(Sort::EmergencyPlan),
)
.without("inherited"));
const CAUSES: [Word; Cause::ALL.len()] = {
    let (mut words, mut of) = ([("", ""); Cause::ALL.len()], 0);
    while of < words.len() {
        words[of] = (Cause::ALL[of].word(), Cause::ALL[of].name());
        of += 1;
    }
    words
};
const BY_CAUSE: Description = Description {
    element: "emergency",
    label: "Alternate by cause",
    help: "The emergency plan for one cause.",
    alike: &[],
    groups: &[&[
        P(property("cause", "Cause", "Why the emergency was raised.", Kind::Choice(&CAUSES)).first("engine")),
        P(property(
            "plan",
            "Plan",
            "The emergency plan that is flown.",
            Kind::Reference(Sort::EmergencyPlan),
        )),
    ]],
};
pub(super) const BY_CAUSES: Row = Row::Children(Children {
    label: "By cause",
    help: "Emergency plans for single causes.",
    of: &[&BY_CAUSE],
    least: 0,
    most: CAUSES.len(),
});
