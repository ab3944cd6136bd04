//! The vehicle that a test plays at the far end of the link.

use super::Window;
use flight_exec::{BranchOption, DecisionRequest, Phase, PlacePointer, Status};
use gcs_app::link::{Call, LinkEvent, LinkId, LinkMessage, LinkState, Order, Reply, Telemetry};
use gcs_app::state::Ticket;
use geometry::LatLon;
use usal::contract::{
    Alarm, Attitude, AutopilotKind, Cause, GatewayState, GatewayStatus, Position, Severity, Stamped,
};

pub fn status(phase: Phase) -> Status {
    Status {
        phase,
        plan: None,
        revision: 0,
        place: None,
        emergency: None,
        emergency_in_force: None,
        current: None,
        outstanding: 0,
        decision: None,
        proposed: None,
        wait_left_s: None,
    }
}

pub fn place(stage: &str, leg: &str) -> PlacePointer {
    PlacePointer {
        plan: flight_exec::Branching::Main,
        stage: stage.into(),
        leg: leg.into(),
        iterations: Vec::new(),
        reverse: false,
        distance_m: 0.0,
    }
}

fn option(branch: &str, label: &str) -> BranchOption {
    let preview = (0..5).map(|i| LatLon::new(36.32, -84.17 + 0.002 * f64::from(i))).collect();
    BranchOption { branch: branch.into(), label: label.into(), preview }
}

pub fn decision(default: Option<&str>) -> DecisionRequest {
    DecisionRequest {
        leg: "ask".into(),
        options: vec![option("again", "Sweep again"), option("close", "Close look")],
        default: default.map(Into::into),
        distance_left_m: 900.0,
        time_left_s: 36.0,
    }
}

/// A position near the runway, at a time and an altitude.
pub fn position(time_s: f64, altitude_amsl_m: f64, on_ground: bool) -> Telemetry {
    let value = Position {
        position: LatLon::new(36.3190 + time_s * 1e-5, -84.1730),
        altitude_amsl_m,
        altitude_home_m: altitude_amsl_m - 349.0,
        velocity_north_mps: 20.0,
        velocity_east_mps: 15.0,
        velocity_down_mps: -1.0,
        track_deg: 37.0,
        ground_speed_mps: 25.0,
        on_ground,
    };
    Telemetry::Position(Stamped { time_s, validity_s: 2.0, value })
}

impl Window {
    /// Of the vehicle that most tests have alone, over its first link.
    pub fn send(&mut self, event: LinkEvent) {
        self.send_of("uav1", LinkId(1), event);
    }

    pub fn send_of(&mut self, vehicle: &str, link: LinkId, event: LinkEvent) {
        self.far.messages.try_send(LinkMessage { link, vehicle: vehicle.into(), event }).unwrap();
        self.steps(2);
    }

    pub fn receive(&mut self, telemetry: Telemetry) {
        self.send(LinkEvent::Telemetry(telemetry));
    }

    pub fn receive_status(&mut self, value: Status) {
        self.receive(Telemetry::Status(Box::new(Stamped { time_s: 1.0, validity_s: 2.0, value })));
    }

    /// Connected to a vehicle that stands on the runway.
    pub fn connect(&mut self) {
        self.send(LinkEvent::Link(LinkState::Connected("tcp/127.0.0.1:7447".into())));
        self.receive_position(true);
        self.receive_status(status(Phase::Idle));
    }

    pub fn receive_position(&mut self, on_ground: bool) {
        self.receive(position(1.0, 500.0, on_ground));
    }

    pub fn receive_attitude(&mut self) {
        let value = Attitude {
            roll_deg: 20.0,
            pitch_deg: 4.0,
            heading_deg: 40.0,
            roll_rate_dps: 0.0,
            pitch_rate_dps: 0.0,
            yaw_rate_dps: 0.0,
        };
        self.receive(Telemetry::Attitude(Stamped { time_s: 1.0, validity_s: 2.0, value }));
    }

    pub fn receive_gateway(&mut self, alarms: Vec<usal::contract::Alarm>) {
        let value = GatewayStatus { cause: "waypoints".into(), alarms, ..gateway_status(GatewayState::Nav) };
        self.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value }.into()));
    }

    /// Standing disarmed, or flying armed.
    pub fn receive_gateway_state(&mut self, state: GatewayState) {
        let value = gateway_status(state);
        self.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value }.into()));
    }

    /// A gateway that says which autopilot it has.
    pub fn receive_autopilot(&mut self, name: &str, habits: &str) {
        let autopilot = Some(AutopilotKind {
            name: name.into(),
            habits: Some(habits.into()),
            landing_deg: None,
            version: Some("4.7.0-dev".into()),
        });
        let value = GatewayStatus { autopilot, ..gateway_status(GatewayState::Stop) };
        self.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value }.into()));
    }

    /// The next question that was asked, if there is one.
    pub fn asked(&mut self) -> Option<(Ticket, Call)> {
        match self.far.orders.try_recv() {
            Ok(Order::Call { ticket, call, .. }) => Some((ticket, call)),
            Ok(other) => panic!("{other:?}"),
            Err(_) => None,
        }
    }

    /// Takes all questions that were asked. What the window wants to know for itself before it asks anything else of the kind is
    /// answered: nobody knows.
    pub fn leave_open(&mut self) {
        while let Some((ticket, call)) = self.asked() {
            if call == Call::Foresee(None) {
                self.answer(ticket, Err("it is not known".into()));
            }
        }
    }

    pub fn answer(&mut self, ticket: Ticket, result: Result<Reply, String>) {
        self.send(LinkEvent::Answer { ticket, result });
    }
}

/// The gateway's alarm of an engine that has stopped.
pub fn engine_out() -> Alarm {
    Alarm {
        id: "engine-suspected".into(),
        severity: Severity::Warning,
        source: "gateway".into(),
        advice: "Fly the emergency plan".into(),
        cause: Some(Cause::Engine),
    }
}

/// Of a gateway in this state.
pub fn gateway_status(state: GatewayState) -> GatewayStatus {
    GatewayStatus {
        state,
        cause: "for the test".into(),
        armed: state != GatewayState::Stop,
        autopilot: None,
        unfit: None,
        autopilot_mode: "AUTO".into(),
        autopilot_age_s: 0.1,
        fp_manager: None,
        fp_manager_age_s: Some(0.1),
        waits_for_height_m: None,
        circle: None,
        safe_return_in_s: None,
        alarms: Vec::new(),
    }
}
