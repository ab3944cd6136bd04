//! Legs whose waypoints are computed from parameters.

use super::Row::Property as P;
use super::legs::TAIL;
use super::parts::{HEAD, THE_AREA, THE_CENTRE, THE_ROUTE, TURN, element, property, value};
use super::{Description, Kind, OneOf, Quantity, Row, Way, Word};

const SPACING: Row = Row::OneOf(OneOf {
    label: "Spacing by",
    help: "How the distance between neighbouring tracks is said.",
    ways: &[
        Way {
            label: "a distance",
            fixed: &[],
            rows: &[P(value("spacing", "Spacing", Quantity::Length, 1.0, "100")
                .help("Distance between neighbouring tracks, at most."))],
        },
        Way {
            label: "a camera",
            fixed: &[],
            rows: &[
                P(value("fieldOfView", "View angle", Quantity::Angle, 1.0, "60")
                    .help("Field of view of the camera across the track.")),
                P(value("overlap", "Overlap", Quantity::Share, 0.0, "0.6")
                    .help("What neighbouring strips have in common.")),
                P(value("height", "Height", Quantity::Height, 1.0, "100")
                    .help("Above the ground.")
                    .without("the leg's altitude")),
            ],
        },
    ],
});
const HEADING: Row =
    P(value("heading", "Heading", Quantity::Angle, 0.0, "0").help("Its first direction, degrees true."));
const RADIUS: Row =
    P(value("radius", "Radius", Quantity::Length, 1.0, "300").help("From its centre to its edge."));
const TURNS: Row =
    P(value("turns", "Turns", Quantity::Count, 0.25, "1").help("How often it is flown round."));
const DIRECTION: Row = P(property(
    "direction",
    "Direction",
    "Whether it goes to the inside or to the outside.",
    Kind::Choice(&[("inward", "inward"), ("outward", "outward")]),
)
.first("inward"));

const SCANS: &[Word] =
    &[("scan", "along the long side"), ("creepingLine", "along the short side"), ("crissCross", "both ways")];
const ORDERS: &[Word] = &[("interleaved", "interleaved"), ("side-by-side", "side by side")];
const ENTRIES: &[Word] = &[
    ("nearest", "nearest corner"),
    ("start-left", "start, left"),
    ("start-right", "start, right"),
    ("end-left", "end, left"),
    ("end-right", "end, right"),
];

pub(super) const ALL: &[Description] = &[
    Description {
        element: "scan",
        label: "Scan",
        help: "Straight tracks over an area.",
        alike: SCANS,
        groups: &[
            HEAD,
            &[
                SPACING,
                P(value("heading", "Heading", Quantity::Angle, 0.0, "0")
                    .help("Direction of the tracks, degrees true in the middle of the area.")
                    .without("the fewest turns")),
                P(value("overshoot", "Overshoot", Quantity::Length, 0.0, "0")
                    .help("How far the tracks go on beyond the edge.")),
                P(property(
                    "entry",
                    "Entry",
                    "Where it begins, seen along the heading.",
                    Kind::Choice(ENTRIES),
                )
                .without("nearest corner")
                .first("start-left")),
                P(property(
                    "order",
                    "Order",
                    "Interleaved, no turn is tighter than the aircraft's, and along a slanted edge tracks go on beyond it, up to abreast of the track that a turn leads to; side by side the way is shorter, and turns swing wide.",
                    Kind::Choice(ORDERS),
                )
                .without("interleaved")
                .first("side-by-side")),
                THE_AREA,
            ],
            TAIL,
        ],
    },
    element(
        "spiral",
        "Spiral",
        "Rounds from one radius to another.",
        &[
            HEAD,
            &[
                THE_CENTRE,
                P(value("innerRadius", "Inner radius", Quantity::Length, 0.0, "0")
                    .help("The smaller radius; 0 is the centre.")),
                P(value("outerRadius", "Outer radius", Quantity::Length, 1.0, "500")
                    .help("The greater radius.")),
                SPACING,
                DIRECTION,
                P(TURN),
            ],
            TAIL,
        ],
    ),
    element(
        "expandingSquare",
        "Expanding square",
        "Legs that become longer, with right-angled turns to one side.",
        &[HEAD, &[THE_CENTRE, SPACING, HEADING, RADIUS, P(TURN)], TAIL],
    ),
    element(
        "sector",
        "Sector search",
        "Spokes through a point, joined by chords.",
        &[
            HEAD,
            &[
                THE_CENTRE,
                RADIUS,
                P(value("sectors", "Sectors", Quantity::Count, 3.0, "3").help("3, 4 or 6.")),
                HEADING,
                P(value("passes", "Passes", Quantity::Count, 1.0, "1")
                    .help("How often; each further pass is turned by 30°.")),
                P(TURN),
            ],
            TAIL,
        ],
    ),
    element(
        "trackLine",
        "Track line",
        "Beside a route, half the spacing to its side.",
        &[
            HEAD,
            &[
                THE_ROUTE,
                SPACING,
                P(property("returns", "Returns", "There on one side and back on the other.", Kind::Flag)
                    .first("true")),
            ],
            TAIL,
        ],
    ),
    element(
        "corridor",
        "Corridor",
        "Tracks along a route, as many as its width needs.",
        &[
            HEAD,
            &[
                THE_ROUTE,
                P(value("width", "Width", Quantity::Length, 1.0, "200").help("Its whole width.")),
                SPACING,
            ],
            TAIL,
        ],
    ),
    element(
        "contour",
        "Contour",
        "Loops along an area's edge, one inside the other.",
        &[
            HEAD,
            &[
                SPACING,
                P(value("loops", "Loops", Quantity::Count, 1.0, "3")
                    .help("How many loops.")
                    .without("until it is filled")),
                P(value("levels", "Levels", Quantity::Count, 1.0, "3")
                    .help("At how many altitudes all loops are flown.")
                    .without("one")),
                P(value("levelStep", "Level step", Quantity::Height, -500.0, "-50")
                    .help("From each altitude to the next; less than 0 descends.")
                    .without("none")),
                DIRECTION,
                P(TURN),
                THE_AREA,
            ],
            TAIL,
        ],
    ),
    element(
        "orbit",
        "Orbit",
        "A circle, flown a number of times.",
        &[HEAD, &[THE_CENTRE, RADIUS, TURNS, P(TURN)], TAIL],
    ),
    element(
        "figureEight",
        "Figure of eight",
        "Two circles that touch at the centre.",
        &[HEAD, &[THE_CENTRE, RADIUS, HEADING, TURNS, P(TURN)], TAIL],
    ),
];
