//! How far a runway is from the aircraft, and while the engine is out, whether a glide straight to it gets there: an estimate of this
//! window, for who has to choose now. What is flown to it, and where that ends, the vehicle tells.

use super::Scene;
use aircraft::glide::{GlideStart, glide, reserve_m};
use aircraft::{Profile, Wind};
use flight_plan::Runway;

/// A runway as seen from the aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// To the nearest point of it, metres.
    pub away_m: f64,
    /// What a glide straight to its better end has to spare there, besides its reserve, metres; negative: what it lacks. `None`: the
    /// engine runs, or the wind does not let it get there.
    pub spare_m: Option<f64>,
}

/// From where the aircraft is; `None`: that is not known now, or it is on the ground.
pub fn distance(scene: &Scene<'_>, runway: &Runway) -> Option<Distance> {
    let position =
        scene.vehicle.position.as_ref().filter(|v| !v.is_expired(scene.now_s) && !v.value.on_ground)?;
    let away_m = runway.strip().beside_m(position.value.position);
    let glides = scene.vehicle.is_engine_out();
    let ends = [runway.clone(), runway.from_other_end()];
    let spare_m = ends.iter().filter_map(|end| spare_over(scene, end));
    Some(Distance { away_m, spare_m: spare_m.max_by(f64::total_cmp).filter(|_| glides) })
}

fn spare_over(scene: &Scene<'_>, runway: &Runway) -> Option<f64> {
    let profile = Profile::by_name(&scene.vehicle.aboard.as_ref()?.plan.aircraft).ok()?;
    let position = scene.vehicle.position.as_ref()?.value;
    let air = scene.vehicle.air.as_ref().filter(|air| !air.is_expired(scene.now_s)).map(|air| air.value);
    let wind =
        air.map_or(Wind::CALM, |air| Wind { east_mps: air.wind_east_mps, north_mps: air.wind_north_mps });
    let (altitude_amsl_m, course_deg) = (position.altitude_amsl_m, position.track_deg);
    let start = GlideStart { position: position.position, altitude_amsl_m, course_deg };
    let arrives_m =
        glide(&profile, wind.into(), start, &[runway.threshold], runway.heading_deg)?.last()?.altitude_amsl_m;
    Some(arrives_m - runway.elevation_amsl_m - reserve_m(altitude_amsl_m - arrives_m))
}

/// `2.9 km`; with the engine out `2.9 km, 120 m to spare` or `2.9 km, not reached: 220 m too low`.
pub fn in_words(scene: &Scene<'_>, runway: &Runway) -> Option<String> {
    let Distance { away_m, spare_m } = distance(scene, runway)?;
    let (away, height) = (scene.units().distance().show(away_m), scene.units().altitude());
    Some(match spare_m {
        Some(spare_m) if spare_m < 0.0 => format!("{away}, not reached: {} too low", height.show(-spare_m)),
        Some(spare_m) => format!("{away}, {} to spare", height.show(spare_m)),
        None if scene.vehicle.is_engine_out() => format!("{away}, not reached against the wind"),
        None => away,
    })
}

/// Another runway of the plan aboard that a glide straight to it reaches, the one with the most to spare: `R34 0.8 km, 120 m to
/// spare`.
pub fn another(scene: &Scene<'_>, than: &Runway) -> Option<String> {
    let plan = &scene.vehicle.aboard.as_ref()?.plan;
    let others = plan.runways.iter().filter(|other| other.id != than.id);
    let reached =
        others.filter_map(|other| Some((other, distance(scene, other)?.spare_m.filter(|m| *m >= 0.0)?)));
    let (other, _) = reached.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    Some(format!("{} {}", other.id, in_words(scene, other)?))
}
