//! The ways to the vehicles: one link per connection, several at once. A thread with a runtime of its
//! own owns the sessions; the window talks to it through two channels and never waits for either.

mod outlet;
mod session;
mod subscriptions;

use crate::state::{ActivePlan, Level, Ticket, VehicleName};
use flight_exec::{Command as PlanCommand, Event, Foresight, ProposalReport, Status};
use std::collections::BTreeSet;
use std::sync::Arc;
use tokio::sync::mpsc;
use usal::contract::{
    Ahead, Air, Attitude, AutopilotLinks, Engine, GatewayEvent, GatewayRequest, GatewayStatus, Gps,
    Navigation, PlanVariables, Position, Power, Propose, Recording, Stamped,
};

/// Which connection. Counts up, never used twice in a run: of two links to a vehicle the greater one holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LinkId(pub u64);

/// What the window wants of the links.
#[derive(Debug, Clone, PartialEq)]
pub enum Order {
    /// Open a session, beside those that are open.
    Connect {
        /// What the link is called from now on.
        link: LinkId,
        /// Where the vehicle's gateway listens.
        endpoint: String,
        /// The vehicle's name.
        vehicle: VehicleName,
    },
    /// Close a session.
    Disconnect {
        /// Which.
        link: LinkId,
    },
    /// Ask a vehicle for something.
    Call {
        /// Over which link.
        link: LinkId,
        /// Comes back with the answer.
        ticket: Ticket,
        /// What.
        call: Call,
    },
}

/// A question to the vehicle.
#[derive(Debug, Clone, PartialEq)]
pub enum Call {
    /// To the FP Manager: a plan is put forward.
    Propose(Propose),
    /// To the FP Manager: a command.
    Plan(PlanCommand),
    /// To the gateway: a request.
    Gateway(GatewayRequest),
    /// To the FP Manager: which plan is active?
    PlanAboard,
    /// To the FP Manager: what would follow this command, or, without one, follows now?
    Foresee(Option<PlanCommand>),
}

/// A message of a link, and the vehicle it is about. A recording that is played is a link like any other.
#[derive(Debug)]
pub struct LinkMessage {
    /// Which link.
    pub link: LinkId,
    /// The vehicle at its far end.
    pub vehicle: VehicleName,
    /// What happened.
    pub event: LinkEvent,
}

/// Something that happened on a link.
#[derive(Debug)]
pub enum LinkEvent {
    /// The session changed.
    Link(LinkState),
    /// The services that are there now.
    Services(Arc<BTreeSet<String>>),
    /// A value or an event of the vehicle was received.
    Telemetry(Telemetry),
    /// Something was lost, and will not come again.
    Lost(Loss),
    /// So many messages of others than the service in whose name they came. They are ignored.
    Strangers {
        /// In whose name.
        service: &'static str,
        /// How many since this was told last.
        count: u64,
    },
    /// A question was answered, or was not in time.
    Answer {
        /// Of the question.
        ticket: Ticket,
        /// The answer; else a sentence that says why there is none.
        result: Result<Reply, String>,
    },
}

/// What was lost on the way from the vehicle to the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// So many events of a stream; they are missing in the log.
    Events(u64),
    /// So many values that came faster than the window took them; newer ones followed.
    Values(u64),
}

/// An event and its place in its stream.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbered<T> {
    /// The publisher's number of it: counts up by one.
    pub sequence: u32,
    /// What happened.
    pub event: Stamped<T>,
}

/// A good answer.
#[derive(Debug)]
pub enum Reply {
    /// Done.
    Done,
    /// What a proposal would do.
    Proposal(Box<ProposalReport>),
    /// The active plan, if there is one.
    Plan(Option<ActivePlan>),
    /// What would follow.
    Foresight(Box<Foresight>),
}

/// What services publish of the vehicle.
#[derive(Debug)]
#[expect(
    missing_docs,
    reason = "each is the contract's variable or event of that name; of the FP Manager, in the executor's types"
)]
pub enum Telemetry {
    Position(Stamped<Position>),
    Attitude(Stamped<Attitude>),
    Air(Stamped<Air>),
    Gps(Stamped<Gps>),
    Engine(Stamped<Engine>),
    Power(Stamped<Power>),
    Links(Stamped<AutopilotLinks>),
    Navigation(Stamped<Navigation>),
    Gateway(Box<Stamped<GatewayStatus>>),
    Status(Box<Stamped<Status>>),
    Ahead(Stamped<Ahead>),
    Variables(Stamped<PlanVariables>),
    PlanEvent(Numbered<Event>),
    GatewayEvent(Numbered<GatewayEvent>),
    Recording(Stamped<Recording>),
    Plain(PlainValue),
    PlainEvent(PlainEvent),
}

/// A variable that a service declares and this window has no place of its own for: as rows of name and text.
#[derive(Debug, Clone, PartialEq)]
pub struct PlainValue {
    /// Whose.
    pub service: &'static str,
    /// The variable's name.
    pub name: &'static str,
    /// Its fields; a value without fields is one row without a name.
    pub rows: Stamped<Rows>,
}

/// An event of such a kind.
#[derive(Debug, Clone, PartialEq)]
pub struct PlainEvent {
    /// Whose.
    pub service: &'static str,
    /// The stream's name.
    pub name: &'static str,
    /// Its fields.
    pub rows: Numbered<Rows>,
}

/// Names and texts.
pub type Rows = Vec<(String, String)>;

/// How far the session has come.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum LinkState {
    /// Nobody asked for one.
    #[default]
    Off,
    /// Looking for the vehicle; goes on until it is asked to stop.
    Connecting(String),
    /// The vehicle's services answer.
    Connected(String),
    /// It can't be opened, and why.
    Failed(String),
}

impl LinkState {
    /// A session is wanted.
    pub fn is_wanted(&self) -> bool {
        matches!(self, Self::Connecting(_) | Self::Connected(_))
    }
    /// Where the vehicle's gateway listens; unknown of a link that is closed or has failed.
    pub fn endpoint(&self) -> Option<&str> {
        match self {
            Self::Connecting(endpoint) | Self::Connected(endpoint) => Some(endpoint),
            Self::Off | Self::Failed(_) => None,
        }
    }
    /// For the log.
    pub fn level(&self) -> Level {
        if matches!(self, Self::Failed(_)) { Level::Caution } else { Level::Info }
    }
    /// As a sentence.
    pub fn text(&self) -> String {
        match self {
            Self::Off => "Not connected".into(),
            Self::Connecting(to) => format!("Looking for the vehicle at {to}"),
            Self::Connected(to) => format!("Connected to {to}"),
            Self::Failed(why) => why.clone(),
        }
    }
}

/// Messages that wait for the window at most. Values that come faster than they are drawn are left out
/// and counted; answers and events wait.
pub const BACKLOG: usize = 4096;

/// The window's end of all links.
#[derive(Debug)]
pub struct Links {
    orders: mpsc::UnboundedSender<Order>,
    messages: mpsc::Receiver<LinkMessage>,
    last: LinkId,
}

/// The far end: the sessions', or a test's.
#[derive(Debug)]
pub struct Endpoint {
    /// What is asked.
    pub orders: mpsc::UnboundedReceiver<Order>,
    /// What happened.
    pub messages: mpsc::Sender<LinkMessage>,
}

/// Called when there is something new to draw.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

impl Links {
    /// The window's end and its far end, without a session.
    pub fn pair() -> (Self, Endpoint) {
        let (order_sender, orders) = mpsc::unbounded_channel();
        let (messages, receiver) = mpsc::channel(BACKLOG);
        (Self { orders: order_sender, messages: receiver, last: LinkId(0) }, Endpoint { orders, messages })
    }

    /// Links whose sessions live on a thread of their own, until this end is dropped.
    pub fn spawn(wake: Wake) -> std::io::Result<Self> {
        let (links, endpoint) = Self::pair();
        std::thread::Builder::new().name("link".into()).spawn(move || session::serve(endpoint, wake))?;
        Ok(links)
    }

    /// Opens a link to a vehicle; never waits.
    pub fn connect(&mut self, endpoint: &str, vehicle: &VehicleName) -> LinkId {
        self.last.0 += 1;
        let (link, endpoint) = (self.last, endpoint.to_owned());
        self.order(Order::Connect { link, endpoint, vehicle: vehicle.clone() });
        link
    }

    /// Asks for something; never waits. False if the far end is gone.
    pub fn order(&self, order: Order) -> bool {
        self.orders.send(order).is_ok()
    }

    /// The next message, if there is one.
    pub fn message(&mut self) -> Option<LinkMessage> {
        self.messages.try_recv().ok()
    }
}
