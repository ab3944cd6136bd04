//! What is done on the way: photos, video, variables, services, waits.

use super::{Id, Place, Value};
use std::sync::Arc;

/// Something that is done when a leg is flown, in either direction, once per passage (of an
/// [`Trigger::Every`]: once per multiple).
#[derive(Debug, Clone, PartialEq)]
pub struct LegAction {
    /// When.
    pub trigger: Trigger,
    /// What.
    pub act: Act,
}

/// When an action is due. Distances and times count from where this passage of the leg begins.
#[derive(Debug, Clone, PartialEq)]
pub enum Trigger {
    /// When the leg is begun.
    Start,
    /// When its last waypoint is passed.
    End,
    /// After so many metres on it.
    Distance(Value<f64>),
    /// After so many metres, and again after each such distance.
    Every(Value<f64>),
    /// After so many seconds on it.
    Time(Value<f64>),
    /// Where the aircraft passes a position: abeam of it, on this leg.
    Abeam(Place),
}

/// What an action does.
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// Takes one picture.
    Photo,
    /// Starts a series of pictures, one each so many metres of ground track.
    PhotoSeries {
        /// Metres between pictures.
        every_m: Value<f64>,
    },
    /// Ends the series of pictures.
    PhotoStop,
    /// Starts recording video.
    VideoStart,
    /// Stops recording video.
    VideoStop,
    /// Writes a variable of the plan.
    Set {
        /// Its name.
        variable: Id,
        /// CEL source of the new value, of the variable's type.
        to: Arc<str>,
    },
    /// Calls a service: `legwork/<vehicle>/<service>/invocation/<operation>`. Nobody waits for the answer.
    Invoke {
        /// The service.
        service: String,
        /// Its operation.
        operation: String,
        /// JSON text of the request; empty: `null`.
        argument: String,
    },
    /// Circles at the leg's end for a time before going on. Only with [`Trigger::End`].
    Wait {
        /// Seconds.
        seconds: Value<f64>,
    },
}
