//! The way to the vehicle. A thread with a runtime of its own owns the session; the window talks to
//! it through two channels and never waits for either.

mod session;

use crate::state::{ActivePlan, Level, Ticket};
use flight_exec::{Command as PlanCommand, ProposalReport, Status};
use std::sync::Arc;
use tokio::sync::mpsc;
use usal::contract::{
    Ahead, Air, Attitude, Engine, GatewayEvent, GatewayRequest, GatewayStatus, Gps, Navigation, PlanEvent,
    PlanVariables, Position, Power, Propose, Stamped,
};

/// What the window wants of the link.
#[derive(Debug, Clone, PartialEq)]
pub enum Order {
    /// Open a session, closing the one before.
    Connect {
        /// Where the vehicle's gateway listens.
        endpoint: String,
        /// The vehicle's name.
        vehicle: String,
    },
    /// Close the session.
    Disconnect,
    /// Ask the vehicle for something.
    Call {
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
}

/// What the link has to tell.
#[derive(Debug)]
pub enum LinkEvent {
    /// The session changed.
    Link(LinkState),
    /// Something was heard of the vehicle.
    Telemetry(Telemetry),
    /// A question was answered, or was not in time.
    Answer {
        /// Of the question.
        ticket: Ticket,
        /// The answer; else a sentence that says why there is none.
        result: Result<Reply, String>,
    },
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
}

/// What services tell of the vehicle.
#[derive(Debug)]
#[expect(missing_docs, reason = "each is the contract's variable or event of that name")]
pub enum Telemetry {
    Position(Stamped<Position>),
    Attitude(Stamped<Attitude>),
    Air(Stamped<Air>),
    Gps(Stamped<Gps>),
    Engine(Stamped<Engine>),
    Power(Stamped<Power>),
    Navigation(Stamped<Navigation>),
    Gateway(Stamped<GatewayStatus>),
    Status(Box<Stamped<Status>>),
    Ahead(Stamped<Ahead>),
    Variables(Stamped<PlanVariables>),
    PlanEvent(Stamped<PlanEvent>),
    GatewayEvent(GatewayEvent),
}

/// How far the session has come.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum LinkState {
    /// Nobody asked for one.
    #[default]
    Off,
    /// Looking for the vehicle; goes on until told otherwise.
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

/// LinkEvent that wait for the window at most; values that come faster than they are drawn are left out,
/// answers and events wait.
const BACKLOG: usize = 4096;

/// The window's end.
#[derive(Debug)]
pub struct Link {
    orders: mpsc::UnboundedSender<Order>,
    news: mpsc::Receiver<LinkEvent>,
}

/// The far end: the session's, or a test's.
#[derive(Debug)]
pub struct Endpoint {
    /// What is asked.
    pub orders: mpsc::UnboundedReceiver<Order>,
    /// What there is to tell.
    pub news: mpsc::Sender<LinkEvent>,
}

/// Called when there is news to draw.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

impl Link {
    /// A link and its far end, without a session.
    pub fn pair() -> (Self, Endpoint) {
        let (order_sender, orders) = mpsc::unbounded_channel();
        let (news, news_receiver) = mpsc::channel(BACKLOG);
        (Self { orders: order_sender, news: news_receiver }, Endpoint { orders, news })
    }

    /// A link whose sessions live on a thread of their own, until the link is dropped.
    pub fn spawn(wake: Wake) -> std::io::Result<Self> {
        let (link, endpoint) = Self::pair();
        std::thread::Builder::new().name("link".into()).spawn(move || session::serve(endpoint, wake))?;
        Ok(link)
    }

    /// Asks for something; never waits. False if the far end is gone.
    pub fn order(&self, order: Order) -> bool {
        self.orders.send(order).is_ok()
    }

    /// The next news, if there are any.
    pub fn news(&mut self) -> Option<LinkEvent> {
        self.news.try_recv().ok()
    }
}
