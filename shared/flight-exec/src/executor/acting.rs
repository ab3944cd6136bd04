//! Passages and waits begin and end: actions are done, each at its time.

use super::Executor;
use crate::api::{Event, Output, ResolvedAct};
use crate::flight::{Acting, Flight, Horizon, Moment, Scene};
use crate::layout::stretch::IssuedWaypoint;
use flight_plan::{Env, Program};

impl Executor {
    /// The actions, the path ahead, and what actions are worked out from.
    pub(super) fn acting(&mut self) -> (&mut Acting, &Horizon, Scene<'_>) {
        let flight = self.setup.flight_state(&self.life);
        let Flight { acting, horizon, reported, .. } = &mut self.flight;
        let scene = Scene {
            program: &self.setup.program,
            flight,
            debounce_s: self.setup.config.debounce_s,
            values: &mut self.life.values,
            clock: &mut self.life.clock,
            reported,
        };
        (acting, horizon, scene)
    }

    /// In a new plan, what is being flown may have actions for the first time.
    pub(super) fn follow_what_acts_now(&mut self) {
        let distance_flown_m = self.path_ahead().distance_flown_m();
        let Flight { acting, horizon, .. } = &mut self.flight;
        if let Some(front) = horizon.front_entered() {
            acting.follow_from(front, distance_flown_m, &self.setup.program);
        }
    }

    /// A waypoint has been reached: everything up to it is due.
    pub(super) fn act_up_to(&mut self, flown: &IssuedWaypoint, out: &mut Vec<Output>) {
        if !self.flight.acting.is_empty() {
            let (acting, _, mut scene) = self.acting();
            acting.act_up_to(flown, &mut scene, out);
        }
    }

    /// Between waypoints: what is due where the aircraft is now.
    pub(super) fn act_on_the_way(&mut self, out: &mut Vec<Output>) {
        let since_s = self.flight.acting.pass_time(self.life.clock.now_s());
        if self.is_muted() || self.flight.acting.is_empty() {
            return;
        }
        self.flight.acting.fly_for(since_s);
        let path = self.path_ahead();
        let (aircraft, left_to_current_m) = (path.aircraft.map(|a| a.position), path.left_to_current_m());
        let moment = path.horizon.front().map(|h| Moment::on_the_way(h, aircraft, left_to_current_m));
        if let Some(moment) = moment {
            let (acting, _, mut scene) = self.acting();
            acting.act(&moment, &mut scene, out);
        }
    }

    /// When the next action is due by time, in seconds of the executor's clock.
    pub(super) fn next_action_s(&self) -> Option<f64> {
        if self.is_muted() || self.flight.acting.is_empty() {
            return None;
        }
        let env = Env { variables: self.variables(), flight: self.setup.flight_state(&self.life) };
        self.flight.acting.next_due_s(&self.setup.program, &env)
    }

    /// Begins to circle for a time, when the aircraft steers to such a waypoint.
    pub(super) fn begin_wait(&mut self, issued: &IssuedWaypoint, out: &mut Vec<Output>) {
        let is_new = !self.flight.overrides.is_waiting_at(issued.passage);
        let Some(seconds) = issued.wait_s.filter(|_| is_new) else { return };
        let (acting, _, mut scene) = self.acting();
        acting.act_before_wait(issued, &mut scene, out);
        self.flight.overrides.begin_wait(issued.passage, self.life.clock.now_s(), seconds);
        let (leg, passage) = (issued.place.leg.clone(), issued.passage);
        out.push(Output::Event(Event::ActionDone { leg, passage, act: ResolvedAct::Wait { seconds } }));
    }

    /// A new plan that says something else about the wait being flown makes it longer or shorter, counted from where it began. One
    /// that says the same changes nothing, whatever its expression gives by now.
    pub(super) fn wait_anew(&mut self, before: &Program) {
        let Some(front) = self.flight.horizon.front() else { return };
        let waits = |program: &Program| Acting::waits_of(program, &front.place.leg);
        if let Some(seconds) = front.wait_s.filter(|_| waits(before) != waits(&self.setup.program)) {
            self.flight.overrides.set_wait(seconds);
        }
    }

    /// Goes on from a circle that was flown long enough, or is not to be flown any longer.
    pub(super) fn end_wait(&mut self, out: &mut Vec<Output>) {
        self.flight.overrides.end_wait();
        self.replan_from(0, true, out);
    }
}
