//! All vehicles, each under its name. One of them is shown: panels read it, commands go to it.

use super::{Vehicle, VehicleName};
use crate::link::{LinkId, LinkMessage, LinkState};
use std::collections::BTreeMap;
use terrain::Terrain;

/// Most vehicles remembered. Beyond it goes the one that was silent longest, has no link and is not shown.
const CAPACITY: usize = 256;

/// What is known of the vehicles.
#[derive(Debug, Default)]
pub struct Vehicles {
    by_name: BTreeMap<VehicleName, Vehicle>,
    shown: Option<VehicleName>,
    /// What is shown as long as there is none.
    nobody: Vehicle,
}

impl Vehicles {
    /// Takes a message in; it concerns the vehicle that it names and no other.
    pub fn receive(&mut self, message: LinkMessage, now_s: f64) {
        let LinkMessage { link, vehicle, event } = message;
        self.shown.get_or_insert_with(|| vehicle.clone());
        self.entry(&vehicle).receive(link, event, now_s);
    }

    /// A link is being opened to a vehicle, which is shown from now on. What is known of it stays.
    pub fn open(&mut self, name: &VehicleName, link: LinkId, endpoint: &str, now_s: f64) {
        self.shown = Some(name.clone());
        let vehicle = self.entry(name);
        vehicle.begin_link(link, now_s);
        vehicle.link_changed(LinkState::Connecting(endpoint.into()), now_s);
    }

    fn entry(&mut self, name: &VehicleName) -> &mut Vehicle {
        if self.by_name.len() >= CAPACITY && !self.by_name.contains_key(name) {
            self.forget_one();
        }
        self.by_name.entry(name.clone()).or_default()
    }

    fn forget_one(&mut self) {
        let received = |v: &Vehicle| v.received_s.unwrap_or(f64::NEG_INFINITY);
        let idle = self.by_name.iter().filter(|(name, _)| self.shown.as_ref() != Some(*name));
        let oldest = idle.min_by(|(_, a), (_, b)| {
            a.link.is_wanted().cmp(&b.link.is_wanted()).then(received(a).total_cmp(&received(b)))
        });
        if let Some(name) = oldest.map(|(name, _)| name.clone()) {
            self.by_name.remove(&name);
        }
    }

    /// Shows another vehicle, if it is known.
    pub fn show(&mut self, name: &VehicleName) {
        if self.by_name.contains_key(name) {
            self.shown = Some(name.clone());
        }
    }

    /// The vehicle that is shown; one of which nothing is known, as long as there is none.
    pub fn shown(&self) -> &Vehicle {
        self.shown.as_ref().and_then(|name| self.by_name.get(name)).unwrap_or(&self.nobody)
    }

    /// Its name, if there is one.
    pub fn shown_name(&self) -> Option<&VehicleName> {
        self.shown.as_ref()
    }

    /// A vehicle by its name.
    pub fn get(&self, name: &VehicleName) -> Option<&Vehicle> {
        self.by_name.get(name)
    }

    /// A vehicle by its name, to note what is asked of it.
    pub fn get_mut(&mut self, name: &VehicleName) -> Option<&mut Vehicle> {
        self.by_name.get_mut(name)
    }

    /// Those in the air that are watched over an open link.
    pub fn flying(&self) -> impl Iterator<Item = &VehicleName> {
        let is_it = |vehicle: &Vehicle| vehicle.open_link().is_some() && vehicle.is_airborne();
        self.by_name.iter().filter(move |(_, vehicle)| is_it(vehicle)).map(|(name, _)| name)
    }

    /// Those the operator may choose among, by name: a name that was only mistyped is none of them.
    pub fn choices(&self) -> impl Iterator<Item = (&VehicleName, &Vehicle)> {
        let is_choice = |name: &VehicleName, v: &Vehicle| {
            v.received_s.is_some() || v.link.is_wanted() || self.shown.as_ref() == Some(name)
        };
        self.by_name.iter().filter(move |(name, vehicle)| is_choice(name, vehicle))
    }

    /// How many are remembered.
    pub fn len(&self) -> usize {
        self.by_name.len()
    }

    /// There is none yet.
    pub fn is_empty(&self) -> bool {
        self.by_name.is_empty()
    }

    /// A link to some vehicle is wanted.
    pub fn any_link_wanted(&self) -> bool {
        self.by_name.values().any(|v| v.link.is_wanted())
    }

    /// Something was heard from some vehicle.
    pub fn any_heard(&self) -> bool {
        self.by_name.values().any(|v| v.received_s.is_some())
    }

    /// Looks at every aircraft over the ground and among zones, at a time of the window and of the day (seconds since 1970); gives those
    /// that have fallen silent (true) or are heard again (false).
    pub fn look(&mut self, terrain: &dyn Terrain, now_s: f64, unix_s: i64) -> Vec<(VehicleName, bool)> {
        self.by_name.values_mut().for_each(|vehicle| vehicle.look(terrain, now_s, unix_s));
        let changed = self.by_name.iter_mut().filter_map(|(name, v)| Some((name, v.silence_changed(now_s)?)));
        changed.map(|(name, is_silent)| (name.clone(), is_silent)).collect()
    }

    /// Puts the ways that vehicles have told over the ground.
    pub fn look_ahead(&mut self, terrain: &dyn Terrain) {
        self.by_name.values_mut().for_each(|vehicle| vehicle.outlook.look(terrain));
    }

    /// Whether the vehicle that is shown flies elsewhere than the preview has it. Of the others nobody looks: what they would tell of
    /// their way is not drawn.
    pub fn set_elsewhere(&mut self, is_elsewhere: bool) {
        for (name, vehicle) in &mut self.by_name {
            vehicle.outlook.set_elsewhere(is_elsewhere && self.shown.as_ref() == Some(name));
        }
    }

    /// Vehicles that fly an emergency plan, or otherwise than the preview has it, and should be asked now which way.
    pub fn due_for_way(&self, now_s: f64) -> Vec<VehicleName> {
        let due = self.by_name.iter().filter(|(_, vehicle)| vehicle.should_ask_which_way(now_s));
        due.map(|(name, _)| name.clone()).collect()
    }

    /// Commands that are considered, where it should be asked now what follows.
    pub fn due_to_look_ahead(&self, now_s: f64) -> Vec<(VehicleName, flight_exec::Command)> {
        let due = self.by_name.iter().filter_map(|(name, v)| Some((name, v.should_ask_what_follows(now_s)?)));
        due.map(|(name, command)| (name.clone(), command.clone())).collect()
    }

    /// Vehicles that fly a plan which is not known here and should be asked for it now.
    pub fn due_for_plan(&mut self, now_s: f64) -> Vec<VehicleName> {
        let due =
            self.by_name.iter_mut().filter_map(|(name, v)| v.should_ask_for_plan(now_s).then_some(name));
        due.cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Once shown it flew elsewhere; now another one is shown, and nobody looks where it flies.
    #[test]
    fn a_vehicle_that_is_not_shown_any_more_is_not_asked_which_way_it_flies() {
        let mut vehicles = Vehicles::default();
        let names: [VehicleName; 2] = ["one".into(), "two".into()];
        for (name, link) in names.iter().zip([1, 2].map(LinkId)) {
            vehicles.open(name, link, "tcp/127.0.0.1:7447", 0.0);
        }
        vehicles.show(&names[0]);
        vehicles.set_elsewhere(true);
        assert_eq!(vehicles.due_for_way(1.0), [names[0].clone()]);
        vehicles.show(&names[1]);
        vehicles.set_elsewhere(false);
        assert_eq!(vehicles.due_for_way(100.0), []);
    }
}
