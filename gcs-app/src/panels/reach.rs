//! How far a runway is, and without an engine, whether a glide straight to it gets there: an estimate of this window, for who has to
//! choose. What is flown to it, and where that ends, the vehicle or the preview tells.

use super::Scene;
use crate::units::Units;
use aircraft::glide::{GlideStart, glide, reserve_m};
use aircraft::glide_in::End;
use aircraft::{Profile, Wind, Winds};
use flight_plan::{FlightPlan, Runway};

/// A place to glide from, if there is no engine.
struct Start {
    /// Where, how high, which way; and in which winds if the engine is out.
    from: GlideStart,
    without_engine: Option<(Profile, Winds)>,
}

/// A runway as seen from there, metres.
#[derive(Clone, Copy)]
struct Seen {
    /// To the nearest point of it.
    away_m: f64,
    /// How a glide straight to its better end ends. `None`: the engine runs, or the wind does not let it get there.
    arrives: Option<Arrives>,
}

/// How a glide ends, metres.
#[derive(Clone, Copy)]
struct Arrives {
    /// Above the threshold; negative: so much is lacking.
    above_m: f64,
    /// The same without the reserve.
    spare_m: f64,
}

impl Start {
    /// Where the aircraft is; `None`: that is not known now, or it is on the ground.
    fn now(scene: &Scene<'_>) -> Option<Self> {
        let vehicle = scene.vehicle;
        let live =
            vehicle.position.as_ref().filter(|v| !v.is_expired(scene.now_s) && !v.value.on_ground)?.value;
        let (position, altitude_amsl_m, course_deg) = (live.position, live.altitude_amsl_m, live.track_deg);
        let without_engine = vehicle.aboard.as_ref().filter(|_| vehicle.is_engine_out()).and_then(|aboard| {
            let air = vehicle.air.as_ref().filter(|air| !air.is_expired(scene.now_s)).map(|air| air.value);
            let wind = air.map(|air| Wind { east_mps: air.wind_east_mps, north_mps: air.wind_north_mps });
            Some((Profile::by_name(&aboard.plan.aircraft).ok()?, wind.unwrap_or(Wind::CALM).into()))
        });
        Some(Self { from: GlideStart { position, altitude_amsl_m, course_deg }, without_engine })
    }

    /// At the preview's cursor, in the world that is tried there, without an engine.
    fn at_cursor(scene: &Scene<'_>) -> Option<Self> {
        let (plan, forecast) = (scene.document.plan(), scene.forecast());
        let at = forecast.at(scene.view.cursor_s?)?;
        let course_deg = forecast.approach_at(at.time_s)?.course_deg?;
        let without_engine = Some((Profile::by_name(&plan.aircraft).ok()?, scene.view.what_if.winds(plan)));
        let from = GlideStart { position: at.position, altitude_amsl_m: at.altitude_amsl_m, course_deg };
        Some(Self { from, without_engine })
    }

    fn seen(&self, runway: &Runway, plan: &FlightPlan) -> Seen {
        let away_m = runway.strip().beside_m(self.from.position);
        let named = end(runway);
        let ends =
            [Some(named), named.opposite(plan.runways.iter().map(end), |_| None)].into_iter().flatten();
        let arrives = ends.filter_map(|end| self.arrives(end));
        Seen { away_m, arrives: arrives.max_by(|a, b| a.spare_m.total_cmp(&b.spare_m)) }
    }

    fn arrives(&self, end: End) -> Option<Arrives> {
        let (profile, winds) = self.without_engine.as_ref()?;
        let way = glide(profile, *winds, self.from, &[end.strip.threshold], end.strip.heading_deg)?;
        let arrives_m = way.last()?.altitude_amsl_m;
        let above_m = arrives_m - end.elevation_amsl_m;
        Some(Arrives { above_m, spare_m: above_m - reserve_m(self.from.altitude_amsl_m - arrives_m) })
    }

    /// `2.9 km`; without an engine `2.9 km, 120 m to spare at the threshold` (besides the reserve), `2.9 km, just reached: 20 m high over the
    /// threshold` or `2.9 km, not reached: 220 m too low at the threshold`.
    fn in_words(&self, runway: &Runway, plan: &FlightPlan, units: Units) -> String {
        let Seen { away_m, arrives } = self.seen(runway, plan);
        let (away, height) = (units.distance().show(away_m), units.altitude());
        match arrives {
            Some(Arrives { above_m, .. }) if above_m < 0.0 => {
                format!("{away}, not reached: {} too low at the threshold", height.show(-above_m))
            }
            Some(Arrives { above_m, spare_m }) if spare_m < 0.0 => {
                format!("{away}, just reached: {} high over the threshold", height.show(above_m))
            }
            Some(Arrives { spare_m, .. }) => {
                format!("{away}, {} to spare at the threshold", height.show(spare_m))
            }
            None if self.without_engine.is_some() => format!("{away}, not reached against the wind"),
            None => away,
        }
    }

    /// Another runway than this that is reached, the one with the most to spare: `R34 0.8 km, 120 m to spare at the threshold`.
    fn another(&self, plan: &FlightPlan, than: &Runway, units: Units) -> Option<String> {
        let others = plan.runways.iter().filter(|other| other.id != than.id);
        let reached =
            others.filter_map(|other| Some((other, self.spare_m(other, plan).filter(|m| *m >= 0.0)?)));
        let (other, _) = reached.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        Some(format!("{} {}", other.id, self.in_words(other, plan, units)))
    }

    fn spare_m(&self, runway: &Runway, plan: &FlightPlan) -> Option<f64> {
        Some(self.seen(runway, plan).arrives?.spare_m)
    }
}

/// The end of a runway that is named.
fn end(runway: &Runway) -> End {
    End { strip: runway.strip(), elevation_amsl_m: runway.elevation_amsl_m }
}

/// How far a runway is from the aircraft, and with the engine out, whether it is reached.
pub fn in_words(scene: &Scene<'_>, runway: &Runway) -> Option<String> {
    Some(Start::now(scene)?.in_words(runway, &scene.vehicle.aboard.as_ref()?.plan, scene.units()))
}

/// Another runway of the plan aboard that the aircraft reaches: `R34 0.8 km, 120 m to spare at the threshold`.
pub fn another(scene: &Scene<'_>, than: &Runway) -> Option<String> {
    Start::now(scene)?.another(&scene.vehicle.aboard.as_ref()?.plan, than, scene.units())
}

/// Another runway of the plan that is reached from the preview's cursor, if the engine fails there.
pub fn another_at_cursor(scene: &Scene<'_>, than: &Runway) -> Option<String> {
    Start::at_cursor(scene)?.another(scene.document.plan(), than, scene.units())
}

/// The engine is out, and none of the runways of the plan aboard is reached.
pub fn reaches_none(scene: &Scene<'_>) -> bool {
    let Some(start) = Start::now(scene).filter(|start| start.without_engine.is_some()) else { return false };
    let Some(aboard) = &scene.vehicle.aboard else { return false };
    let plan = aboard.plan.as_ref();
    let is_reached =
        |runway: &Runway| start.seen(runway, plan).arrives.is_some_and(|arrives| arrives.above_m >= 0.0);
    !plan.runways.is_empty() && !plan.runways.iter().any(is_reached)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn without_an_engine_a_runway_is_judged_by_its_better_end_and_with_one_by_its_distance() {
        let text = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><runways>
            <runway id="R05" lat="46" lon="9" elevation="300" heading="90" length="600"/>
            <runway id="R34" lat="46.02" lon="9" elevation="300" heading="340" length="600"/></runways><mainPlan/></flightPlan>"#;
        let plan = flight_plan::read(text.as_bytes()).plan;
        let [near, far] = &plan.runways[..] else { unreachable!() };
        let words = |out_m: f64, altitude_amsl_m: f64, engine: bool, wind: Wind| {
            let position = LatLon::new(46.0, 9.0).destination(270.0, out_m);
            let from = GlideStart { position, altitude_amsl_m, course_deg: 90.0 };
            let without_engine = (!engine).then(|| (Profile::by_name("trainer").unwrap(), wind.into()));
            let start = Start { from, without_engine };
            (start.in_words(near, &plan, Units::Si), start.another(&plan, far, Units::Si))
        };
        assert_eq!(
            words(800.0, 500.0, true, Wind::CALM),
            ("0.8 km".into(), None),
            "nothing is to spare with an engine"
        );
        let (said, another) = words(800.0, 500.0, false, Wind::CALM);
        assert!(said.starts_with("0.8 km, ") && said.ends_with(" m to spare at the threshold"), "{said}");
        assert_eq!(another, Some(format!("R05 {said}")));
        let (said, another) = words(2800.0, 500.0, false, Wind::CALM);
        assert!(
            said.starts_with("2.8 km, not reached: ") && said.ends_with(" m too low at the threshold"),
            "{said}"
        );
        assert_eq!(another, None);
        let (said, another) = words(1300.0, 420.0, false, Wind::CALM);
        assert!(
            said.starts_with("1.3 km, just reached: ") && said.ends_with(" m high over the threshold"),
            "{said}"
        );
        assert_eq!(another, None, "without its reserve it is not offered");
        let storm = Wind::from_direction(90.0, 60.0);
        assert_eq!(words(800.0, 500.0, false, storm).0, "0.8 km, not reached against the wind");
    }
}
