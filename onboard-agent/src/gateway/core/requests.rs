//! What people and services may ask of the gateway.

use super::Gateway;
use super::direct::Direct;
use super::io::{Intent, Output};
use super::safe::{choose, is_usable};
use super::states::is_flying;
use crate::gateway::order::Time;
use usal::contract::{GatewayRequest, GatewayState, SafeParameters, SafeRunway};

/// Most runways that are stored.
const MAX_RUNWAYS: usize = 32;
/// Why nothing can be gone on with.
const NO_WAYPOINTS: &str = "There are no waypoints to go on with.";

impl Gateway {
    /// Does what is asked, or says why not.
    pub(super) fn request(
        &mut self,
        now: Time,
        asked: GatewayRequest,
        out: &mut Vec<Output>,
    ) -> Result<(), String> {
        self.is_real()?;
        match asked {
            GatewayRequest::Launch => self.launch(out),
            GatewayRequest::Resume => self.resume(now, out),
            GatewayRequest::Hold | GatewayRequest::Direct { .. } => self.lead_away(asked, out),
            GatewayRequest::Safe => self.safe_by_command(now, out),
            GatewayRequest::Recover => self.recover_by_command(now, out),
            GatewayRequest::SetRunways { runways } => self.set_runways(runways, out),
            GatewayRequest::SetSafe(safe) => self.set_safe(safe, out),
            GatewayRequest::Terminate { confirm } => self.terminate(&confirm, out),
        }
    }

    /// An aircraft is at the other end.
    pub(super) fn is_real(&self) -> Result<(), String> {
        if self.settings.replay {
            return Err("This is a replay of a telemetry log: nothing can be commanded.".into());
        }
        Ok(())
    }

    fn launch(&mut self, out: &mut Vec<Output>) -> Result<(), String> {
        self.knows_what_is_aboard()?;
        match self.state {
            GatewayState::Stop => {}
            s => return Err(format!("Launch is for the ground; the state is {s:?}.")),
        }
        match &self.control.capability {
            Some(Ok(_)) => {}
            Some(Err(why)) => return Err(why.clone()),
            None => return Err("The autopilot has not said yet what it is; try again.".into()),
        }
        if self.buffer.is_empty() {
            return Err("There is nothing to fly; start a plan first.".into());
        }
        if !self.telemetry.gps.is_some_and(|(_, g)| g.fix_3d) {
            return Err("There is no GPS fix; wait for it.".into());
        }
        self.begin_launch(out);
        Ok(())
    }

    /// The states in which people and the FP Manager may redirect the aircraft.
    pub(super) fn is_free(&self) -> Result<(), String> {
        match self.state {
            GatewayState::TakeOff
            | GatewayState::Nav
            | GatewayState::Hold
            | GatewayState::Directed
            | GatewayState::Approach
            | GatewayState::Land => Ok(()),
            s => Err(format!("Not possible while the state is {s:?}.")),
        }
    }

    /// Hold, or a direct command, at once.
    pub(super) fn lead(&mut self, asked: &GatewayRequest, out: &mut Vec<Output>) -> Result<(), String> {
        if let GatewayRequest::Direct { heading_deg, altitude_amsl_m, airspeed_mps } = *asked {
            self.control.direct = Some(self.direct_to(heading_deg, altitude_amsl_m, airspeed_mps)?);
            self.control.direct_due = true;
            self.control.set_intent(Intent::Direct, self.telemetry.mode);
            self.order_speed(airspeed_mps, out);
        } else {
            self.hold();
        }
        out.push(Output::Save);
        Ok(())
    }

    fn hold(&mut self) {
        // a hold that was asked for is not ended by waypoints
        self.fp_manager.awaited_since = None;
        self.control.set_intent(Intent::Hold, self.telemetry.mode);
    }

    fn resume(&mut self, now: Time, out: &mut Vec<Output>) -> Result<(), String> {
        if self.state != GatewayState::Manual {
            self.is_free()?;
        }
        if self.buffer.is_empty() && self.state == GatewayState::Manual {
            return self.take_over(now, out);
        }
        if self.buffer.is_empty() {
            return Err(NO_WAYPOINTS.into());
        }
        if self.control.climb_out.asked.is_some() {
            self.cause = "the plan is flown on: what was asked for in the climb is not done".to_owned();
        }
        self.control.set_intent(Intent::Fly, self.telemetry.mode);
        out.push(Output::Save);
        Ok(())
    }

    /// An aircraft that somebody else flies, with nothing of ours aboard, circles until the FP Manager that waits has joined
    /// and sent waypoints.
    fn take_over(&mut self, now: Time, out: &mut Vec<Output>) -> Result<(), String> {
        if !self.fp_manager.waits_to_join(now, &self.safe) || !self.telemetry.is_airborne() {
            return Err(NO_WAYPOINTS.into());
        }
        // what an earlier gateway had put aboard is not flown any more; the rest of what it knew holds
        if let Some(known) = self.adopting.take() {
            self.take_up(&known, out);
        }
        self.control.set_intent(Intent::Hold, self.telemetry.mode);
        self.fp_manager.expect(now);
        self.fp_manager.awaited_since = Some(now);
        out.push(Output::Save);
        Ok(())
    }

    /// Where a direct command leads from here.
    pub(super) fn direct_to(
        &self,
        heading_deg: f64,
        altitude_amsl_m: f64,
        airspeed_mps: f64,
    ) -> Result<Direct, String> {
        let place = self.place_now().ok_or("The position is not known: try again when it is.")?;
        let profile = &self.settings.profile;
        let speeds = profile.min_airspeed_mps..=profile.max_airspeed_mps;
        if !heading_deg.is_finite() || !speeds.contains(&airspeed_mps) {
            return Err(format!("The airspeed has to be within {speeds:?} m/s, the heading a number."));
        }
        let ground_m = self.settings.terrain.as_ref().and_then(|t| t.elevation_m(place)).unwrap_or(-500.0);
        if !(ground_m + 50.0..=profile.ceiling_amsl_m).contains(&altitude_amsl_m) {
            return Err(format!(
                "The altitude has to be within {:.0} and {:.0} m AMSL.",
                ground_m + 50.0,
                profile.ceiling_amsl_m
            ));
        }
        let now_amsl_m = self.telemetry.fix.map_or(altitude_amsl_m, |(_, fix)| fix.altitude_amsl_m);
        Ok(Direct::new((place, now_amsl_m), heading_deg, altitude_amsl_m, airspeed_mps, profile))
    }

    fn safe_by_command(&mut self, now: Time, out: &mut Vec<Output>) -> Result<(), String> {
        // the FP Manager asks for it where no emergency plan answers an alarm
        let cause = match self.alarms.emergency() {
            Some(emergency) => format!("asked for while {emergency}"),
            None => "by command".to_owned(),
        };
        self.enter_safe(now, &cause, out);
        match self.state {
            GatewayState::SafeHold | GatewayState::SafeReturn => {
                self.control.safe_until_command = true;
                Ok(())
            }
            s => Err(format!("Safe mode can't be entered while the state is {s:?}.")),
        }
    }

    fn recover_by_command(&mut self, now: Time, out: &mut Vec<Output>) -> Result<(), String> {
        if !matches!(self.state, GatewayState::SafeHold | GatewayState::SafeReturn) {
            return Err(format!(
                "Recovery is possible in Safe.Hold and Safe.Return; the state is {:?}.",
                self.state
            ));
        }
        if self.fp_manager.is_silent(now, &self.safe) {
            if !self.fp_manager.waits_to_join(now, &self.safe) {
                return Err("The FP Manager is silent; start it first.".into());
            }
            self.fp_manager.expect(now);
        }
        self.recover(now, out);
        out.push(Output::Save);
        Ok(())
    }

    fn set_runways(&mut self, runways: Vec<SafeRunway>, out: &mut Vec<Output>) -> Result<(), String> {
        if runways.len() > MAX_RUNWAYS {
            return Err(format!("At most {MAX_RUNWAYS} runways are stored."));
        }
        if let Some(bad) = runways.iter().find(|r| !is_usable(r, &self.settings.profile)) {
            let least = self.settings.profile.min_runway_m;
            return Err(format!(
                "Runway {} can't be used: its numbers have to be in range and its length at least {least:.0} m.",
                bad.id
            ));
        }
        if runways == self.runways {
            return Ok(());
        }
        if is_flying(self.state) || self.telemetry.armed {
            self.is_in_reach(&runways)?;
        }
        self.runways = runways;
        out.push(Output::Save);
        Ok(())
    }

    /// One of these can be flown to from here.
    fn is_in_reach(&self, runways: &[SafeRunway]) -> Result<(), String> {
        let Some(here) = self.situation() else {
            return Err("Without a position it is not known whether a runway of the list is within reach: \
                        try again when there is one."
                .into());
        };
        if choose(runways, &self.safe, &here).is_none() {
            return Err("Safe mode needs a runway within reach from here, and the list has none: add one, or change the list on the ground.".into());
        }
        Ok(())
    }

    fn set_safe(&mut self, safe: SafeParameters, out: &mut Vec<Output>) -> Result<(), String> {
        let times = (0.5..=60.0).contains(&safe.t1_s) && (0.0..=3600.0).contains(&safe.t2_s);
        if !times || !(40.0..=500.0).contains(&safe.return_height_m) {
            return Err("T1 has to be 0.5 to 60 s, T2 0 to 3600 s, the return height 40 to 500 m.".into());
        }
        self.safe = safe;
        out.push(Output::Save);
        Ok(())
    }
}
