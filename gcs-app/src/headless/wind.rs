//! Wind and air on the command line.

use aircraft::air::MOST_DEVIATION_C;
use aircraft::{Autopilot, Wind};
use flight_exec::Conditions;
use flight_exec::rehearse::Start;
use flight_plan::{FlightPlan, LOWEST_AMSL_M};
use geometry::LatLon;
use geometry::geodesy::NEAR_POLE;

/// Strongest wind that is accepted, m/s.
const MAX_MPS: f64 = 50.0;

/// The wind and the time of a command that flies a plan ahead of time, and the habits that it is flown with.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Air {
    /// Where the wind comes from (degrees true) and its speed (m/s).
    #[arg(long, value_name = "DIRECTION,SPEED", value_parser = parse, default_value = "0,0")]
    pub wind: Wind,
    /// When the flight starts (UTC, as 2026-06-01T06:00:00Z); without it every zone counts as active.
    #[arg(long, value_name = "TIME")]
    pub start: Option<jiff::Timestamp>,
    /// Where a plan without a take-off begins, in flight (m AMSL, degrees true) [default: before its first place].
    #[arg(long, value_name = "LAT,LON,ALT,COURSE", value_parser = in_flight, allow_hyphen_values = true)]
    pub begin: Option<Start>,
    /// The autopilot whose habits it is flown with; a review has none.
    #[arg(skip)]
    pub autopilot: Option<Autopilot>,
    /// How much warmer than the standard's the air is for it, °C.
    #[arg(skip)]
    pub isa_deviation_c: f64,
}

impl Air {
    /// A plan that takes off begins on its runway.
    ///
    /// # Errors
    /// It is said where in flight such a plan begins.
    pub fn suits(&self, plan: &FlightPlan) -> anyhow::Result<()> {
        match (self.begin, plan.home()) {
            (Some(_), Some(runway)) => {
                anyhow::bail!("leave --begin out: the plan takes off, and begins on runway `{}`", runway.id)
            }
            _ => Ok(()),
        }
    }

    /// The conditions of a review.
    pub fn conditions(&self) -> Conditions {
        let start_unix_s = self.start.map(jiff::Timestamp::as_second);
        Conditions { wind: self.wind, start_unix_s, begin: self.begin, ..Conditions::default() }
    }
}

/// `DIRECTION,SPEED`: where it comes from in degrees true, and m/s.
///
/// # Errors
/// How to write it.
pub fn parse(text: &str) -> Result<Wind, String> {
    let numbers = text.split_once(',').and_then(|(direction, speed)| {
        Some((direction.trim().parse::<f64>().ok()?, speed.trim().parse::<f64>().ok()?))
    });
    match numbers {
        Some((from_deg, speed_mps))
            if (0.0..=360.0).contains(&from_deg) && (0.0..=MAX_MPS).contains(&speed_mps) =>
        {
            Ok(Wind::from_direction(from_deg, speed_mps))
        }
        _ => Err("write DIRECTION,SPEED, as 270,5: degrees it comes from, 0 to 360, and m/s up to 50".into()),
    }
}

/// How much warmer it is than the standard's air, °C.
///
/// # Errors
/// How to write it.
pub fn deviation(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse::<f64>().ok().filter(|degrees| degrees.abs() <= MOST_DEVIATION_C);
    degrees.ok_or_else(|| {
        format!("write the degrees that it is warmer than the standard, from -{MOST_DEVIATION_C} to {MOST_DEVIATION_C}")
    })
}

/// `LAT,LON,ALT,COURSE`.
fn in_flight(text: &str) -> Result<Start, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[lat, lon, ..])
            if LatLon::new(lat, lon).is_valid() && !LatLon::new(lat, lon).is_navigable() =>
        {
            Err(format!("begin elsewhere: {NEAR_POLE}"))
        }
        Some(&[lat, lon, altitude_amsl_m, heading_deg])
            if LatLon::new(lat, lon).is_navigable()
                && (LOWEST_AMSL_M..=12_000.0).contains(&altitude_amsl_m)
                && (0.0..=360.0).contains(&heading_deg) =>
        {
            Ok(Start::InFlight { position: LatLon::new(lat, lon), altitude_amsl_m, heading_deg })
        }
        _ => Err("write LAT,LON,ALT,COURSE, as 36.319,-84.173,500,52: degrees, m AMSL, degrees true".into()),
    }
}

/// For people: `5 m/s from 270°`, or `calm`.
pub fn shown(wind: &Wind) -> String {
    if wind.speed_mps() < 0.05 {
        return "calm".into();
    }
    format!("{:.0} m/s from {:.0}°", wind.speed_mps(), wind.direction_from_deg())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_in_flight() {
        let expected =
            Start::InFlight { position: LatLon::new(36.3, -84.1), altitude_amsl_m: 500.0, heading_deg: 52.0 };
        assert_eq!(in_flight("36.3, -84.1,500,52"), Ok(expected));
        for bad in [
            "",
            "36,-84,500",
            "36,-84,500,52,1",
            "89.5,0,500,0",
            "36,-84,nan,0",
            "36,-84,1e9,0",
            "36,-84,500,361",
        ] {
            assert!(in_flight(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn near_a_pole_that_is_what_is_wrong() {
        assert!(in_flight("89.5,0,500,0").is_err_and(|why| why.contains("pole")));
        assert!(in_flight("95,0,500,0").is_err_and(|why| why.starts_with("write LAT,LON")));
    }

    #[test]
    fn warmth_of_the_air() {
        assert_eq!([deviation("20"), deviation(" -7.5 ")], [Ok(20.0), Ok(-7.5)]);
        for bad in ["", "warm", "NaN", "41", "-41"] {
            assert!(deviation(bad).unwrap_err().contains("from -40 to 40"), "{bad}");
        }
    }

    #[test]
    fn winds() {
        assert_eq!(shown(&parse("270,5").unwrap()), "5 m/s from 270°");
        assert_eq!(shown(&parse(" 0 , 0 ").unwrap()), "calm");
        assert!(parse("360,5").is_ok());
        for bad in ["", "270", "270,", "a,b", "270,51", "270,-1", "270,NaN", "inf,5", "400,5", "-1,5"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
