//! Wind on the command line.

use aircraft::Wind;
use flight_exec::Conditions;

/// Strongest wind that is accepted, m/s.
const MAX_MPS: f64 = 50.0;

/// The wind and the time of a command that flies a plan ahead of time.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Air {
    /// Where the wind comes from (degrees true) and its speed (m/s).
    #[arg(long, value_name = "DIRECTION,SPEED", value_parser = parse, default_value = "0,0")]
    pub wind: Wind,
    /// When the flight starts (UTC, as 2026-06-01T06:00:00Z); without it every zone counts as active.
    #[arg(long, value_name = "TIME")]
    pub start: Option<jiff::Timestamp>,
}

impl Air {
    /// The conditions of a review.
    pub fn conditions(&self) -> Conditions {
        let start_unix_s = self.start.map(jiff::Timestamp::as_second);
        Conditions { wind: self.wind, start_unix_s, ..Conditions::default() }
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
    fn winds() {
        assert_eq!(shown(&parse("270,5").unwrap()), "5 m/s from 270°");
        assert_eq!(shown(&parse(" 0 , 0 ").unwrap()), "calm");
        assert!(parse("360,5").is_ok());
        for bad in ["", "270", "270,", "a,b", "270,51", "270,-1", "270,NaN", "inf,5", "400,5", "-1,5"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
