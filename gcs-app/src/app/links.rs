//! Links to vehicles: opening and closing them, and questions over them.

use super::App;
use crate::link::{Call, Order};
use crate::state::{Outcome, Ticket, Vehicle, VehicleName};
use usal::contract::GatewayRequest;

impl App {
    /// Opens a link to a vehicle and shows that one; an older link to the same vehicle is closed.
    pub(super) fn connect(&mut self, endpoint: &str, vehicle: &VehicleName, now_s: f64) {
        self.disconnect(vehicle);
        // a demo's vehicle is gone with its window
        if !self.view.is_demo {
            self.connections.add(endpoint, vehicle.as_str());
        }
        let link = self.links.connect(endpoint, vehicle);
        self.vehicles.open(vehicle, link, endpoint, now_s);
    }

    pub(super) fn disconnect(&self, vehicle: &VehicleName) {
        if let Some(link) = self.vehicles.get(vehicle).and_then(Vehicle::open_link) {
            self.links.order(Order::Disconnect { link });
        }
    }

    /// Sends a question to a vehicle and notes it; its number, if there is such a vehicle.
    pub(super) fn call(
        &mut self,
        vehicle: &VehicleName,
        label: &str,
        call: Call,
        now_s: f64,
    ) -> Option<Ticket> {
        let asked = self.vehicles.get_mut(vehicle)?;
        let ticket = asked.requests.open(label, now_s);
        let failed = match asked.open_link() {
            None => Some("there is no link: connect first"),
            Some(link) if self.links.order(Order::Call { link, ticket, call }) => None,
            Some(_) => Some("the thread of the links has ended: restart the program"),
        };
        if let Some(why) = failed {
            asked.requests.settle(ticket, Outcome::Refused(why.into()), now_s);
        }
        Some(ticket)
    }
}

/// A request, for people.
pub(super) fn gateway_label(request: &GatewayRequest) -> &'static str {
    match request {
        GatewayRequest::Launch => "Launch",
        GatewayRequest::Hold => "Hold (gateway)",
        GatewayRequest::Resume => "Resume (gateway)",
        GatewayRequest::Direct { .. } => "Direct",
        GatewayRequest::Safe => "Enter Safe mode",
        GatewayRequest::Recover => "Leave Safe mode",
        GatewayRequest::SetRunways { .. } => "Store runways",
        GatewayRequest::SetSafe(_) => "Set Safe mode",
        GatewayRequest::Terminate { .. } => "Terminate",
    }
}
