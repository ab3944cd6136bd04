//! A service of one's own, whole: it counts the waypoints flown and answers one question, "how many?".
//! `cargo run -p onboard-agent --example waypoint_counter` beside a flight; tested in `tests/waypoint_counter.rs`.

use service::{Config, Never, Out, Request, Service, Time, Wiring, run_alone, shutdown};
use usal::contract::{Empty, GatewayEvent, TimedGatewayEvent};
use usal::topics::{Invocation, gateway};
use usal::{Occurrence, Said, Spec, Start};

/// What anybody may ask it.
pub const HOW_MANY: Invocation<Empty, u64> = Invocation::reading("waypoint-counter", "how-many");

/// The service: what it remembers.
#[derive(Default)]
pub struct WaypointCounter {
    flown: u64,
}

/// All that can happen to it.
pub enum Input {
    /// Something happened to the gateway.
    Gateway(Occurrence<TimedGatewayEvent>),
    /// Somebody wants to know.
    HowMany(Request<Empty, u64>),
}

impl Service for WaypointCounter {
    type Input = Input;
    type Output = Never;
    const SPEC: Spec = Spec {
        name: "waypoint-counter",
        about: "counts the waypoints flown",
        says: &[Said::invocation(HOW_MANY)],
    };

    fn wire(wiring: &mut Wiring<Input>) {
        wiring.listen(gateway::EVENTS, Start::Now, Input::Gateway);
        wiring.serve(HOW_MANY, Input::HowMany);
    }

    fn step(&mut self, _: Time, input: Input, out: &mut Out<Input>) {
        match input {
            Input::Gateway(Occurrence::Event { event, .. }) => {
                // the autopilot goes on to the next one
                self.flown += u64::from(matches!(event.value, GatewayEvent::Progress { .. }));
            }
            Input::Gateway(Occurrence::Gap { missed }) => tracing::warn!(missed, "some weren't counted"),
            Input::HowMany(asked) => out.answer(asked.reply, Ok(self.flown)),
        }
    }
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let (_trigger, shutdown) = shutdown();
    run_alone(Config::client("uav1", usal::DEFAULT_ENDPOINT), WaypointCounter::default(), shutdown).await
}
