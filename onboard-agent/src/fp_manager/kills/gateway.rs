//! A gateway and an autopilot that flies a waypoint a step; neither dies.

use std::collections::VecDeque;
use usal::contract::*;

pub struct Gateway {
    pub state: GatewayState,
    pub flown: Vec<Waypoint>,
    pub launches: usize,
    buffer: VecDeque<Waypoint>,
    highest: Token,
    here: LatLon,
    alarms: Vec<Alarm>,
}

impl Gateway {
    pub fn new() -> Self {
        Self {
            state: GatewayState::Stop,
            flown: Vec::new(),
            launches: 0,
            buffer: VecDeque::new(),
            highest: Token(0),
            here: LatLon::new(36.4905, -84.2710),
            alarms: Vec::new(),
        }
    }

    pub fn feed(&mut self, feed: Feed) -> FeedAnswer {
        if let Some(keep) = feed.cancel_after {
            self.buffer.retain(|w| w.token <= keep);
        }
        for waypoint in feed.waypoints {
            assert!(waypoint.token > self.highest, "{:?} fed after {:?}", waypoint.token, self.highest);
            self.highest = waypoint.token;
            self.buffer.push_back(waypoint);
        }
        FeedAnswer::Accepted
    }

    pub fn join(&self) -> JoinAnswer {
        JoinAnswer {
            accepted: true,
            reason: String::new(),
            current: self.buffer.front().map(|w| w.token),
            last: self.buffer.back().map(|w| w.token),
            highest: self.highest,
        }
    }

    pub fn request(&mut self, request: &GatewayRequest) -> Result<(), String> {
        match request {
            GatewayRequest::Launch if self.state != GatewayState::Stop => return Err("it flies".into()),
            GatewayRequest::Launch => self.launches += 1,
            GatewayRequest::SetRunways { .. } => return Ok(()),
            _ => {}
        }
        let held = *request == GatewayRequest::Hold;
        self.state = if held { GatewayState::Hold } else { GatewayState::Nav };
        Ok(())
    }

    pub fn alarm(&mut self, cause: Cause) -> GatewayEvent {
        let alarm = Alarm {
            id: "energy-low".into(),
            severity: Severity::Warning,
            source: "gateway".into(),
            advice: "land".into(),
            cause: Some(cause),
        };
        self.alarms.push(alarm.clone());
        GatewayEvent::AlarmRaised(alarm)
    }

    /// Flies a waypoint.
    pub fn fly(&mut self) -> Option<GatewayEvent> {
        let reached = (self.state == GatewayState::Nav).then(|| self.buffer.pop_front())??;
        if reached.end_of_plan {
            self.state = GatewayState::Stop;
        }
        self.here = reached.position;
        self.flown.push(reached);
        Some(GatewayEvent::Progress { current: self.buffer.front().map(|w| w.token) })
    }

    pub fn finished(&self) -> bool {
        self.flown.last().is_some_and(|w| w.end_of_plan)
    }

    pub fn position(&self) -> Position {
        let on_ground = self.state == GatewayState::Stop;
        Position {
            position: self.here,
            altitude_amsl_m: 450.0,
            altitude_home_m: 128.0,
            velocity_north_mps: 0.0,
            velocity_east_mps: 22.0,
            velocity_down_mps: 0.0,
            track_deg: 90.0,
            ground_speed_mps: if on_ground { 0.0 } else { 22.0 },
            on_ground,
        }
    }

    pub fn navigation(&self) -> Navigation {
        Navigation {
            current: self.buffer.front().map(|w| w.token),
            next: self.buffer.get(1).map(|w| w.token),
            last: self.buffer.back().map(|w| w.token),
            distance_m: 100.0,
            eta_s: 5.0,
            cross_track_m: 0.0,
            buffer_waypoints: self.buffer.len(),
            buffer_s: 5.0 * self.buffer.len() as f64,
            room: 256,
            end_of_plan: self.buffer.back().is_some_and(|w| w.end_of_plan),
        }
    }

    pub fn status(&self) -> GatewayStatus {
        GatewayStatus {
            state: self.state,
            cause: "test".into(),
            armed: self.state != GatewayState::Stop,
            autopilot_mode: "AUTO".into(),
            autopilot_age_s: 0.0,
            fp_manager_age_s: None,
            safe_return_in_s: None,
            alarms: self.alarms.clone(),
        }
    }
}
