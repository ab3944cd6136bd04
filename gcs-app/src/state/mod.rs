//! What is known of the vehicles, and how old it is. Messages of links go in, panels read; nothing here
//! draws, waits, sends or looks at a clock: time is an argument, so that a recording and a flight are the
//! same input.

mod aged;
mod circling;
mod ground_below;
pub mod log;
mod losses;
mod names;
mod outlook;
mod recent;
mod repeats;
mod requests;
mod strangers;
pub mod toasts;
mod trail;
mod vehicle;
mod vehicles;
mod watch;
mod why_safe;
mod zones_ahead;

pub use aged::Aged;
pub use circling::{Circle, Circling};
pub use log::{Level, Line, Log};
pub use losses::Losses;
pub use names::Names;
pub use outlook::{Considered, Outlook, Told};
pub use recent::RecentEvents;
pub use requests::{LOOK_AGAIN, LOOK_AHEAD, Outcome, READ_ABOARD, Request, Requests, START, Ticket};
pub use strangers::Strangers;
pub use toasts::Toasts;
pub use trail::Trail;
pub use vehicle::{ActivePlan, LINK_CAUTION_S, LINK_WARNING_S, Proposal, Raised, Vehicle, VehicleName};
pub use vehicles::Vehicles;
pub use watch::{GROUND_STATION, is_safe};
pub use why_safe::{Unanswered, WhySafe};

use repeats::Repeats;
