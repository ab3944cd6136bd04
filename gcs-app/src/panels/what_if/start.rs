//! When the flight starts: a time of day, today or on a date that is typed with it.

use super::world::slider_reading;
use crate::panels::Scene;
use egui::{Slider, SliderClamping, Ui};
use flight_exec::rehearse::WhatIf;
use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;

const MINUTES_OF_DAY: i64 = 24 * 60;

/// The time of day matters for zones that are not always active, the date for those that are so on some days.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, chosen: &mut WhatIf) {
    let mut known = chosen.start_unix_s.is_some();
    let hover = "Zones are judged at the times of the flight; without it they count as always active. A date can be typed before the time";
    if ui.checkbox(&mut known, "Start at a time of day").on_hover_text(hover).changed() {
        chosen.start_unix_s = known.then(|| scene.utc.as_second() / 60 * 60);
    }
    let Some(start_unix_s) = &mut chosen.start_unix_s else { return };
    let day_min = start_unix_s.div_euclid(60 * MINUTES_OF_DAY) * MINUTES_OF_DAY;
    // from the beginning of the day that is chosen: what is typed may be on another one
    let mut minutes = start_unix_s.div_euclid(60) - day_min;
    let slider = Slider::new(&mut minutes, 0..=MINUTES_OF_DAY - 1)
        .clamping(SliderClamping::Never)
        .custom_formatter(|minutes, _| written((day_min + minutes as i64) * 60, scene.utc))
        .text("UTC");
    if slider_reading(ui, slider, |text| Ok((read(text, scene.utc)? - day_min) as f64)) {
        *start_unix_s = (day_min + minutes) * 60;
    }
}

/// `14:30`, and with its date where that is not today's.
pub fn written(unix_s: i64, now: Timestamp) -> String {
    let date = |at: Timestamp| at.to_zoned(TimeZone::UTC).date();
    match Timestamp::from_second(unix_s) {
        Ok(at) if date(at) == date(now) => at.strftime("%H:%M").to_string(),
        Ok(at) => at.strftime("%Y-%m-%d %H:%M").to_string(),
        Err(_) => String::new(),
    }
}

/// Minutes since 1970 of a time of day, today or on its date.
fn read(text: &str, now: Timestamp) -> Result<i64, String> {
    let today = now.to_zoned(TimeZone::UTC).date();
    let at = match text.trim().rsplit_once([' ', 'T']) {
        Some((date, time)) => date.trim().parse().ok().zip(minutes_of(time)),
        None => minutes_of(text).map(|minutes| (today, minutes)),
    };
    at.and_then(|(date, minutes)| Some(midnight_s(date)? / 60 + minutes)).ok_or_else(|| {
        "A start is written 14:30, which is today, or with its date: 2026-12-01 14:30. Both are UTC".into()
    })
}

fn midnight_s(date: Date) -> Option<i64> {
    Some(date.to_zoned(TimeZone::UTC).ok()?.timestamp().as_second())
}

fn minutes_of(text: &str) -> Option<i64> {
    let (hours, minutes) = text.trim().split_once(':')?;
    let (hours, minutes): (u32, u32) = (hours.parse().ok()?, minutes.parse().ok()?);
    (hours < 24 && minutes < 60).then(|| i64::from(hours * 60 + minutes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn now() -> Timestamp {
        "2026-09-21T14:13:20Z".parse().unwrap()
    }

    #[test]
    fn a_start_is_read_as_it_is_written() {
        let minutes = |text: &str| read(text, now()).unwrap();
        for text in ["00:00", "14:30", "23:59", "2026-12-01 14:30", "2026-09-20 00:00", "1969-12-31 23:59"] {
            assert_eq!(written(minutes(text) * 60, now()), text);
        }
        assert_eq!(minutes("2026-09-21 6:05"), minutes("06:05"), "today");
        assert_eq!(minutes("2026-12-01T14:30") - minutes("2026-11-30 14:30"), MINUTES_OF_DAY);
    }

    #[test]
    fn what_is_no_start_is_told_with_both_forms() {
        for bad in
            ["", "6", "24:00", "12:60", "a:b", "-1:00", "2026-13-01 14:30", "2026-12-01", "2026-12-01 25:00"]
        {
            let told = read(bad, now()).unwrap_err();
            assert!(told.contains("14:30,") && told.contains("2026-12-01 14:30"), "{bad}: {told}");
        }
    }
}
