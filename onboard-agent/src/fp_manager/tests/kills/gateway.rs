//! A gateway and an autopilot that flies a waypoint a step; neither dies. Without sockets; the tests over loopback
//! put some around it.

use std::collections::VecDeque;
use usal::contract::*;

pub struct Gateway {
    pub state: GatewayState,
    pub flown: Vec<Waypoint>,
    pub joins: Vec<Join>,
    /// All but the storing of runways.
    pub requests: Vec<GatewayRequest>,
    /// As they were stored, each time.
    pub runways: Vec<Vec<SafeRunway>>,
    /// Waypoints of this leg are refused.
    pub refuse_leg: Option<Id>,
    /// Launches are refused with this.
    pub refuse_launch: Option<String>,
    /// To fly on is refused with this.
    pub refuse_resume: Option<String>,
    /// Safe mode is refused so often, as below the height where a take-off may be interrupted.
    pub refuse_safe: usize,
    /// What happened and was not reported yet.
    pub events: VecDeque<GatewayEvent>,
    buffer: VecDeque<Waypoint>,
    highest: Token,
    here: LatLon,
    runway: LatLon,
    pub alarms: Vec<Alarm>,
    /// It gave the aircraft back with an empty buffer: the next waypoints are flown at once.
    awaits_waypoints: bool,
    /// Safe mode was commanded: no join ends it.
    commanded: bool,
    /// Hash of the plan that the one that joined last flew. No heartbeat of it has ever come through.
    plan: Option<String>,
}

impl Gateway {
    /// On the ground, at a place.
    pub fn new(here: LatLon) -> Self {
        Self {
            state: GatewayState::Stop,
            flown: Vec::new(),
            joins: Vec::new(),
            requests: Vec::new(),
            runways: Vec::new(),
            refuse_leg: None,
            refuse_launch: None,
            refuse_resume: None,
            refuse_safe: 0,
            events: VecDeque::new(),
            buffer: VecDeque::new(),
            highest: Token(0),
            here,
            runway: here,
            alarms: Vec::new(),
            awaits_waypoints: false,
            commanded: false,
            plan: None,
        }
    }

    pub fn feed(&mut self, feed: Feed) -> FeedAnswer {
        if is_safe(self.state) || matches!(self.state, GatewayState::Manual | GatewayState::SafeLand) {
            return FeedAnswer::NotNow("join first".into());
        }
        let refused = self.refuse_leg.as_ref().and_then(|leg| feed.waypoints.iter().find(|w| w.leg == *leg));
        if let Some(waypoint) = refused {
            let faults = vec![(waypoint.token, "fence".into(), "not there".into())];
            return FeedAnswer::Refused { faults };
        }
        if let Some(keep) = feed.cancel_after {
            self.buffer.retain(|w| w.token <= keep);
        }
        for waypoint in feed.waypoints {
            assert!(waypoint.token > self.highest, "{:?} fed after {:?}", waypoint.token, self.highest);
            self.highest = waypoint.token;
            self.buffer.push_back(waypoint);
        }
        if !self.buffer.is_empty() && std::mem::take(&mut self.awaits_waypoints) {
            self.state = GatewayState::Nav;
        }
        FeedAnswer::Accepted
    }

    /// In Safe mode, a manager that knows the flight gets the aircraft back: flying on, or to send waypoints first.
    pub fn join(&mut self, join: Join) -> JoinAnswer {
        let knows = join.last_token >= self.highest && self.knows_plan(&join) && !self.commanded;
        let taken = matches!(self.state, GatewayState::Manual | GatewayState::SafeLand);
        let accepted = !taken && (!is_safe(self.state) || knows);
        if accepted {
            self.plan.clone_from(&join.plan);
        }
        self.joins.push(join);
        if accepted && is_safe(self.state) {
            self.awaits_waypoints = self.buffer.is_empty();
            self.state = if self.awaits_waypoints { GatewayState::Hold } else { GatewayState::Nav };
        }
        JoinAnswer {
            instance: None,
            accepted,
            reason: if accepted { String::new() } else { "it does not know the flight".into() },
            waits: taken,
            current: self.buffer.front().map(|w| w.token),
            last: self.buffer.back().map(|w| w.token),
            highest: self.highest,
            finished: self.finished(),
        }
    }

    fn knows_plan(&self, join: &Join) -> bool {
        let known = |plan: &String| self.plan.as_ref().is_none_or(|known| known == plan);
        join.plan.iter().chain(&join.earlier).any(known)
    }

    pub fn request(&mut self, request: &GatewayRequest) -> Result<(), String> {
        match request {
            GatewayRequest::Launch if self.refuse_launch.is_some() => {
                return Err(self.refuse_launch.clone().unwrap_or_default());
            }
            GatewayRequest::Resume if self.refuse_resume.is_some() => {
                return Err(self.refuse_resume.clone().unwrap_or_default());
            }
            GatewayRequest::Launch if self.state != GatewayState::Stop => return Err("it flies".into()),
            GatewayRequest::Launch | GatewayRequest::Resume => {
                assert!(!self.buffer.is_empty(), "{request:?} before the waypoints");
                self.state = GatewayState::Nav;
            }
            GatewayRequest::Hold if self.state == GatewayState::Stop => return Err("on the ground".into()),
            GatewayRequest::Hold => {
                self.awaits_waypoints = false;
                self.state = GatewayState::Hold;
            }
            GatewayRequest::Safe if self.refuse_safe > 0 => {
                self.refuse_safe -= 1;
                return Err("not clear of the ground".into());
            }
            GatewayRequest::Safe => {
                self.commanded = true;
                self.state = GatewayState::SafeHold;
            }
            GatewayRequest::SetRunways { runways } => {
                self.runways.push(runways.clone());
                return Ok(());
            }
            other => panic!("{other:?}"),
        }
        self.requests.push(request.clone());
        Ok(())
    }

    /// Safe.Hold, until the FP Manager joins.
    pub fn safe_hold(&mut self) {
        self.state = GatewayState::SafeHold;
    }

    /// The same after T2: on its way home, and the waypoints are gone.
    pub fn safe_return(&mut self) {
        self.state = GatewayState::SafeReturn;
        self.buffer.clear();
    }

    pub fn alarm(&mut self, id: &str, cause: Cause) {
        let alarm = Alarm {
            id: id.into(),
            severity: Severity::Warning,
            source: "gateway".into(),
            advice: "land".into(),
            cause: Some(cause),
        };
        self.alarms.push(alarm.clone());
        self.events.push_back(GatewayEvent::AlarmRaised(alarm));
    }

    /// Flies a waypoint.
    pub fn fly(&mut self) {
        if self.state != GatewayState::Nav {
            return;
        }
        let Some(reached) = self.buffer.pop_front() else { return };
        self.here = reached.position;
        self.flown.push(reached);
        if self.finished() {
            self.state = GatewayState::Stop;
        }
        let current = self.buffer.front().map(|w| w.token);
        self.events.push_back(GatewayEvent::Progress { current, taken: self.highest });
    }

    pub fn launches(&self) -> usize {
        self.requests.iter().filter(|r| **r == GatewayRequest::Launch).count()
    }

    pub fn end_is_aboard(&self) -> bool {
        self.buffer.back().is_some_and(|w| w.end_of_plan)
    }

    pub fn finished(&self) -> bool {
        self.buffer.is_empty() && self.flown.last().is_some_and(|w| w.end_of_plan)
    }

    /// Somebody brings it back to where it took off.
    pub fn is_carried_back(&mut self) {
        self.here = self.runway;
    }

    pub fn position(&self) -> Position {
        let on_ground = self.state == GatewayState::Stop;
        Position {
            position: self.here,
            altitude_amsl_m: 450.0,
            altitude_home_m: 100.0,
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
            room: 256_usize.saturating_sub(self.buffer.len()),
            end_of_plan: self.end_is_aboard(),
        }
    }

    pub fn status(&self) -> GatewayStatus {
        GatewayStatus {
            state: self.state,
            cause: "test".into(),
            armed: self.state != GatewayState::Stop,
            autopilot: None,
            unfit: None,
            autopilot_mode: "AUTO".into(),
            autopilot_age_s: 0.0,
            fp_manager: None,
            fp_manager_age_s: None,
            waits_for_height_m: None,
            circle: None,
            safe_return_in_s: None,
            alarms: self.alarms.clone(),
        }
    }
}

fn is_safe(state: GatewayState) -> bool {
    matches!(state, GatewayState::SafeHold | GatewayState::SafeReturn)
}
