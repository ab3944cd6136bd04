//! How a simulator is set up, and what can be asked of it while it runs.

use crate::core::autopilot::Home;
use crate::core::faults::{Fault, FaultRequest};
use crate::core::mode::Mode;
use crate::core::personality::Personality;
use aircraft::{Profile, Wind};
use geometry::LatLon;
use std::net::SocketAddr;
use std::str::FromStr;

/// How it is reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// Listens for one TCP client at a time, as ArduPilot's simulator does.
    Tcp(SocketAddr),
    /// Listens for datagrams; answers everybody who sends a good frame.
    Udp(SocketAddr),
    /// Sends datagrams to a ground station from the start, and listens to it alone.
    UdpOut(SocketAddr),
}

/// Everything that can be chosen.
#[derive(Debug, Clone)]
pub struct Config {
    /// Which autopilot it behaves as.
    pub personality: Personality,
    /// Parameters that are set when it is switched on, by the autopilot's names.
    pub params: Vec<(String, f32)>,
    /// How it is reached.
    pub link: Link,
    /// Where it stands at the start.
    pub home: Home,
    /// The wind.
    pub wind: Wind,
    /// So much warmer than the standard's is the air, °C.
    pub isa_deviation_c: f64,
    /// What flies.
    pub profile: Profile,
    /// Simulated seconds per second. 0: as fast as the lockstep partner lets it (1 without one).
    pub speed: f64,
    /// Ask a partner for leave before every step.
    pub lockstep: bool,
    /// Faults from the start.
    pub faults: Vec<FaultRequest>,
    /// For the faults' dice.
    pub seed: u64,
    /// Simulated seconds between points of the track log.
    pub track_interval_s: f64,
}

impl Default for Config {
    /// The trainer on runway R05 of the example mission, no wind, real time, any free TCP port of the loopback.
    fn default() -> Self {
        Self {
            personality: Personality::default(),
            params: Vec::new(),
            link: Link::Tcp(SocketAddr::from(([127, 0, 0, 1], 0))),
            home: Home {
                position: LatLon::new(36.3190, -84.1730),
                altitude_amsl_m: 349.0,
                heading_deg: 52.0,
            },
            wind: Wind::CALM,
            isa_deviation_c: 0.0,
            profile: Profile::default(),
            speed: 1.0,
            lockstep: false,
            faults: Vec::new(),
            seed: 1,
            track_interval_s: 0.5,
        }
    }
}

/// What can be asked of a running simulator.
#[derive(Debug, Clone, PartialEq)]
pub enum Control {
    /// A fault, now or at its time.
    Inject(FaultRequest),
    /// No more faults of that name.
    Clear(&'static str),
    /// Another wind.
    Wind(Wind),
    /// Another flight mode, as by the pilot's switch.
    Mode(Mode),
    /// A fence of the autopilot's own, so many metres around home; `None`: no more.
    Fence(Option<f64>),
    /// Another ground station brings a list of its own aboard.
    Visit {
        /// It leads round this place.
        around: LatLon,
        /// It is to be flown from its first waypoint on.
        starts: bool,
    },
    /// The end.
    Stop,
}

impl FromStr for Control {
    type Err = String;

    /// One line: `fault FAULT`, `clear NAME`, `wind DIRECTION,SPEED`, `mode NAME`, `fence METRES`, `upload LAT,LON`,
    /// `upload-and-fly LAT,LON` or `stop`.
    fn from_str(line: &str) -> Result<Self, String> {
        let (word, rest) = line.trim().split_once(' ').unwrap_or((line.trim(), ""));
        match word {
            "fault" => rest.trim().parse().map(Control::Inject).map_err(|e| format!("{e}")),
            "clear" => Fault::known_name(rest.trim()).map(Control::Clear),
            "wind" => parse_wind(rest).map(Control::Wind),
            "mode" => rest.trim().parse().map(Control::Mode),
            "fence" => parse_fence(rest).map(Control::Fence),
            "upload" | "upload-and-fly" => {
                let starts = word != "upload";
                parse_place(rest).map(|around| Control::Visit { around, starts })
            }
            "stop" | "quit" => Ok(Control::Stop),
            _ => Err(format!(
                "{word:?} is no command; write: fault FAULT, clear NAME, wind DIRECTION,SPEED, mode NAME, fence METRES, \
                 upload LAT,LON, upload-and-fly LAT,LON or stop"
            )),
        }
    }
}

/// `LAT,LON,ALT,HEADING`: degrees, degrees, metres AMSL, degrees true.
///
/// # Errors
/// What is wrong with it.
pub fn parse_home(text: &str) -> Result<Home, String> {
    let wrong = || format!("{text:?} is no home; write LAT,LON,ALT,HEADING, as 36.3190,-84.1730,349,52");
    let [lat, lon, altitude_amsl_m, heading_deg] = numbers(text).ok_or_else(wrong)?;
    let position = LatLon::new(lat, lon);
    if !position.is_valid() || !(-500.0..9000.0).contains(&altitude_amsl_m) {
        return Err(wrong());
    }
    Ok(Home { position, altitude_amsl_m, heading_deg })
}

/// `DIRECTION,SPEED`: where it comes from in degrees true, m/s.
///
/// # Errors
/// What is wrong with it.
pub fn parse_wind(text: &str) -> Result<Wind, String> {
    match numbers(text) {
        Some([from_deg, speed_mps]) if (0.0..=50.0).contains(&speed_mps) => {
            Ok(Wind::from_direction(from_deg, speed_mps))
        }
        _ => Err(format!(
            "{text:?} is no wind; write DIRECTION,SPEED, as 270,5 (degrees it comes from, m/s up to 50)"
        )),
    }
}

fn parse_fence(text: &str) -> Result<Option<f64>, String> {
    match numbers(text) {
        Some([0.0]) => Ok(None),
        Some([radius_m]) if radius_m > 0.0 => Ok(Some(radius_m)),
        _ => Err(format!("{text:?} is no fence; write METRES around home, as 1000; 0 takes it away")),
    }
}

fn parse_place(text: &str) -> Result<LatLon, String> {
    let place = numbers(text).map(|[lat, lon]| LatLon::new(lat, lon)).filter(|place| place.is_valid());
    place.ok_or_else(|| format!("{text:?} is no place; write LAT,LON, as 36.3190,-84.1730"))
}

/// `NAME=VALUE`: a parameter.
///
/// # Errors
/// What is wrong with it.
pub fn parse_param(text: &str) -> Result<(String, f32), String> {
    let param =
        text.split_once('=').and_then(|(name, value)| Some((name.trim(), value.trim().parse().ok()?)));
    match param {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value)),
        _ => Err(format!("{text:?} is no parameter; write NAME=VALUE, as MIS_TKO_LAND_REQ=0")),
    }
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let parsed: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().ok().filter(|n| n.is_finite()))
        .collect::<Option<_>>()?;
    parsed.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_control_protocol() {
        assert_eq!("stop".parse(), Ok(Control::Stop));
        assert_eq!("clear silence\n".parse(), Ok(Control::Clear("silence")));
        assert_eq!("clear low-battery".parse(), Ok(Control::Clear("low-battery")));
        assert_eq!("wind 270,5".parse(), Ok(Control::Wind(Wind::from_direction(270.0, 5.0))));
        assert_eq!("mode rtl".parse(), Ok(Control::Mode(Mode::ReturnToLaunch)));
        assert!(matches!(" fault engine-out@3 ".parse(), Ok(Control::Inject(_))));
        assert_eq!("fence 1000".parse(), Ok(Control::Fence(Some(1000.0))));
        assert_eq!("fence 0".parse(), Ok(Control::Fence(None)));
        let around = LatLon::new(36.5, -84.25);
        assert_eq!("upload 36.5,-84.25".parse(), Ok(Control::Visit { around, starts: false }));
        assert_eq!("upload-and-fly 36.5, -84.25".parse(), Ok(Control::Visit { around, starts: true }));
        for bad in [
            "",
            "fault",
            "fault x",
            "clear",
            "clear x",
            "wind 1",
            "wind 270,NaN",
            "mode",
            "mode upside-down",
            "dance",
        ]
        .into_iter()
        .chain(["fence", "fence -1", "upload", "upload 91,0", "upload-and-fly here"])
        {
            assert!(bad.parse::<Control>().is_err(), "{bad}");
        }
    }

    #[test]
    fn params() {
        assert_eq!(parse_param("NAV_ACC_RAD=12.5"), Ok(("NAV_ACC_RAD".to_owned(), 12.5)));
        for bad in ["", "=1", "NAV_ACC_RAD", "NAV_ACC_RAD=far"] {
            assert!(parse_param(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn homes() {
        let home = parse_home("36.3190, -84.1730, 349, 52").unwrap();
        assert_eq!(home, Config::default().home);
        for bad in ["", "1,2,3", "91,0,0,0", "1,2,1e9,0", "a,b,c,d", "1,2,3,4,5"] {
            assert!(parse_home(bad).is_err(), "{bad}");
        }
    }
}
