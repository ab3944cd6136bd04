//! What is done on the way.

use super::Row::Property as P;
use super::parts::{element, property, text, value};
use super::{Children, Description, Kind, OneOf, Property, Quantity, Row, Sort, Way, parts};

const NOTHING: &[&[Row]] = &[];

impl crate::Act {
    /// To people.
    pub const fn name(&self) -> &'static str {
        let what = match self {
            Self::Photo | Self::PhotoSeries { .. } => &PHOTO,
            Self::PhotoStop => &PHOTO_STOP,
            Self::VideoStart => &VIDEO_START,
            Self::VideoStop => &VIDEO_STOP,
            Self::Set { .. } => &SET,
            Self::Invoke { .. } => &INVOKE,
            Self::Wait { .. } => &WAIT,
        };
        what.label
    }
}

const PHOTO: Description = element(
    "photo",
    "Take photos",
    "One picture, or a series of them.",
    &[&[P(value("every", "One each", Quantity::Length, 0.1, "50")
        .help("Distance over the ground between the pictures of a series.")
        .without("one picture"))]],
);
const PHOTO_STOP: Description =
    element("photoStop", "End the photos", "Ends the series of pictures.", NOTHING);
const VIDEO_START: Description = element("videoStart", "Start the video", "Begins recording.", NOTHING);
const VIDEO_STOP: Description = element("videoStop", "End the video", "Ends recording.", NOTHING);
const SET: Description = element(
    "set",
    "Set a variable",
    "Writes a variable of the plan.",
    &[&[
        P(property("variable", "Variable", "The variable.", Kind::Reference(Sort::Variable))),
        P(property("to", "To", "Its new value: an expression of its type.", Kind::Formula(crate::Use::Any))),
    ]],
);
const INVOKE: Description = element(
    "invoke",
    "Call a service",
    "Calls a service aboard; the flight does not wait for the answer.",
    &[&[
        P(Property { without: None, ..text("service", "Service", "Its name.") }.first("camera")),
        P(Property { without: None, ..text("operation", "Operation", "What it is asked for.") }
            .first("trigger")),
        P(text("argument", "Argument", "JSON that goes with the request.")),
    ]],
);
const WAIT: Description = element(
    "wait",
    "Wait",
    "Circles at the leg's end for a time; only at its end.",
    &[&[P(value("seconds", "For", Quantity::Time, 0.0, "30").help("How long it circles."))]],
);

const WHEN: Row = Row::OneOf(OneOf {
    label: "When",
    help: "When it is done. Distances and times count from where the leg begins.",
    ways: &[
        Way { label: "at the leg's start", fixed: &[("on", "start")], rows: &[] },
        Way { label: "at the leg's end", fixed: &[("on", "end")], rows: &[] },
        parts::ABEAM[0],
        parts::ABEAM[1],
        parts::ABEAM[2],
        Way { label: "after a distance", fixed: &[], rows: &[AFTER] },
        Way { label: "every so far", fixed: &[], rows: &[EVERY] },
        Way { label: "after a time", fixed: &[], rows: &[AFTER_TIME] },
    ],
});
const AFTER: Row =
    P(value("afterDistance", "After", Quantity::Length, 0.0, "100").help("Distance on the leg."));
const EVERY: Row = P(value("every", "Every", Quantity::Length, 0.1, "100")
    .help("After this distance, and again after each such distance."));
const AFTER_TIME: Row = P(value("afterTime", "After", Quantity::Time, 0.0, "10").help("Time on the leg."));

const ACTION: Description = Description {
    element: "action",
    label: "Action",
    help: "Something that is done on the way, once for each time that the leg is flown.",
    alike: &[],
    groups: &[&[
        Row::Children(Children {
            label: "What",
            help: "What is done.",
            of: &[&PHOTO, &PHOTO_STOP, &VIDEO_START, &VIDEO_STOP, &SET, &INVOKE, &WAIT],
            least: 1,
            most: 1,
        }),
        WHEN,
    ]],
};

pub(super) const ACTIONS: Row = Row::Children(Children {
    label: "Actions",
    help: "What is done on the way.",
    of: &[&ACTION],
    least: 0,
    most: usize::MAX,
});
