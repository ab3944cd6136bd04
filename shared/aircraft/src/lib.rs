//! Pure: performance profiles, fixed-wing point mass, wind, energy and the waypoint-following
//! guidance that simulator and preview share.
//!
//! One aircraft, flown by everybody: [`dynamics`] moves it, [`autopilot`] steers it along waypoints,
//! the checks read its [`profile`]. No clock, no randomness: time is an argument.
//!
//! ```
//! use aircraft::{Action, Aircraft, Guidance, Profile, Target, Wind};
//! use geometry::LatLon;
//!
//! let profile = Profile::default();
//! let home = LatLon::new(36.4905, -84.2710);
//! let mut aircraft = Aircraft::in_flight(profile.clone(), home, 900.0, 90.0);
//! let mut guidance = Guidance::new(profile);
//! let target = Target {
//!     position: home.destination(90.0, 1000.0),
//!     altitude_amsl_m: 920.0,
//!     airspeed_mps: 25.0,
//!     action: Action::Fly,
//!     fly_over: false,
//!     acceptance_m: None,
//! };
//! guidance.direct(aircraft.state(), target);
//! loop {
//!     let guided = guidance.step(aircraft.state(), None);
//!     if guided.reached {
//!         break;
//!     }
//!     aircraft.step(0.1, &guided.demand, &Wind::CALM);
//! }
//! assert!(aircraft.state().position.distance_m(target.position) < 5.0);
//! ```

pub mod air;
pub mod autopilot;
pub mod dynamics;
pub mod glide;
pub mod glide_in;
pub mod power;
pub mod profile;
pub mod strip;
pub mod wind;

pub use autopilot::{Action, Autopilot, Corners, Guidance, Guided, Habits, Target, wp_radius_m};
pub use dynamics::{Aircraft, Demand, State};
pub use power::{Battery, Engine};
pub use profile::{DESIGN_WIND_MPS, Profile, ProfileError};
pub use strip::Strip;
pub use wind::{Wind, Winds};

/// Standard gravity, m/s² (ISO 80000-3).
pub const GRAVITY_MPS2: f64 = 9.80665;
