//! A small mission around any runway, so that the same flight can be flown wherever an autopilot is.

use geometry::{LatLon, LocalFrame, Vec2};

/// How long each runway is, metres.
pub const RUNWAY_M: f64 = 600.0;

/// A runway with free sky around it.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Where the take-off begins and the landing ends.
    pub threshold: LatLon,
    /// Metres above sea level.
    pub elevation_m: f64,
    /// Take-off and landing direction, degrees true.
    pub heading_deg: f64,
}

impl Field {
    /// Position `ahead_m` metres along the runway's direction from the threshold and `right_m` to its right.
    pub fn at(&self, ahead_m: f64, right_m: f64) -> LatLon {
        self.threshold.destination(self.heading_deg, ahead_m).destination(self.heading_deg + 90.0, right_m)
    }

    /// How far a position is along the runway from its threshold, and how far beside its centre line, metres.
    pub fn along_and_beside_m(&self, position: LatLon) -> (f64, f64) {
        let from_threshold = LocalFrame::new(self.threshold).to_local(position);
        let ahead = Vec2::from_bearing_rad(self.heading_deg.to_radians());
        (from_threshold.dot(ahead), from_threshold.cross(ahead).abs())
    }

    /// `lat="…" lon="…"` of such a position.
    fn place(&self, ahead_m: f64, right_m: f64) -> String {
        let p = self.at(ahead_m, right_m);
        format!("lat=\"{:.7}\" lon=\"{:.7}\"", p.lat_deg, p.lon_deg)
    }

    /// The mission: take-off, a departure with an RF, three sweeps over a spot that can move, an intersection after
    /// each, home and landing; one emergency plan each for plan, mission stage and the leg `far`, which is flown at 20 m/s.
    ///
    /// `way_back_m` moves the way home further out: two values give two plans for an update in flight.
    pub fn mission(&self, way_back_m: f64) -> String {
        let centre = self.at(1700.0, 300.0);
        let spot = self.at(-600.0, 1400.0);
        let (heading, elevation) = (self.heading_deg, self.elevation_m);
        format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<flightPlan xmlns="urn:legwork:flight-plan:1" name="System test" aircraft="trainer">
  <runways>
    <runway id="R" {threshold} elevation="{elevation}" heading="{heading}" length="{RUNWAY_M}" priority="1"/>
  </runways>
  <variables>
    <variable name="spot" type="position" initial="{spot_lat:.7} {spot_lon:.7}"/>
    <variable name="reach" type="number" unit="m" initial="350" min="200" max="900"/>
    <variable name="found" type="bool" initial="false"/>
  </variables>
  <mainPlan emergency="home">
    <stage id="to" type="take-off" runway="R" altitude="60" altitudeReference="home"/>
    <stage id="dep" type="departure" altitude="120" altitudeReference="home">
      <TF id="out" {out}/>
      <RF id="round" {round} centreLat="{centre_lat:.7}" centreLon="{centre_lon:.7}" turn="right"/>
      <TF id="far" {far} speed="20" emergency="near-home"/>
    </stage>
    <stage id="watch" type="mission" emergency="field" altitude="120" altitudeReference="home">
      <iterative id="loop" form="forward" count="3" until="found" turn="right">
        <scan id="sweep" spacing="200" overshoot="0">
          <area centre="= spot" radius="= reach"/>
        </scan>
        <intersection id="ask" default="on" decideBefore="15s">
          <branch id="on" label="Sweep again"/>
          <branch id="look" label="Close look" next="close"/>
        </intersection>
        <TF id="mark" {mark} next="end"/>
        <orbit id="close" radius="250" turns="1" turn="right"><centre at="= spot"/></orbit>
        <TF id="end" {end}/>
      </iterative>
    </stage>
    <stage id="arr" type="arrival" altitude="120" altitudeReference="home">
      <DF id="back" {back}/>
      <TF id="downwind" {downwind} altitude="90" altitudeReference="home"/>
    </stage>
    <stage id="app" type="approach">
      <TF id="final" {last} altitude="70" altitudeReference="home"/>
    </stage>
    <stage id="ldg" type="land" runway="R"/>
  </mainPlan>
  <emergencyPlans>
    {home}
    {near}
    {field}
  </emergencyPlans>
</flightPlan>
"#,
            threshold = self.place(0.0, 0.0),
            out = self.place(1700.0, 0.0),
            round = self.place(1700.0, 600.0),
            far = self.place(-600.0, 600.0),
            mark = self.place(-1500.0, 1400.0),
            end = self.place(-1600.0, 800.0),
            back = self.place(-way_back_m, -700.0),
            downwind = self.place(-1500.0, -500.0),
            last = self.place(-1000.0, 0.0),
            centre_lat = centre.lat_deg,
            centre_lon = centre.lon_deg,
            spot_lat = spot.lat_deg,
            spot_lon = spot.lon_deg,
            home = self.emergency("home", 700.0),
            near = self.emergency("near-home", 800.0),
            field = self.emergency("field", 900.0),
        )
    }

    /// Each kind of leg as long as it takes to settle on it, without a corner between them: TF and RF forth and back, and a holding.
    pub fn accuracy(&self) -> String {
        let (heading, elevation) = (self.heading_deg, self.elevation_m);
        let centre = |ahead_m: f64, right_m: f64| {
            let p = self.at(ahead_m, right_m);
            format!("centreLat=\"{:.7}\" centreLon=\"{:.7}\"", p.lat_deg, p.lon_deg)
        };
        format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<flightPlan xmlns="urn:legwork:flight-plan:1" name="Accuracy" aircraft="trainer">
  <runways>
    <runway id="R" {threshold} elevation="{elevation}" heading="{heading}" length="{RUNWAY_M}" priority="1"/>
  </runways>
  <variables>
    <variable name="enough" type="bool" initial="false"/>
  </variables>
  <mainPlan emergency="home">
    <stage id="to" type="take-off" runway="R" altitude="60" altitudeReference="home"/>
    <stage id="dep" type="departure" altitude="120" altitudeReference="home">
      <TF id="out" {out}/>
      <RF id="narrow" {narrow} {narrow_centre} turn="right"/>
      <TF id="back" {back}/>
      <RF id="wide" {wide} {wide_centre} turn="left"/>
      <TF id="forth" {forth}/>
      <HM id="hold" {forth} course="{heading}" turn="right" length="900" until="enough" maxLaps="2"/>
    </stage>
    <stage id="arr" type="arrival" altitude="120" altitudeReference="home">
      <DF id="turn" {direct}/>
      <TF id="final" {last} altitude="70" altitudeReference="home"/>
    </stage>
    <stage id="ldg" type="land" runway="R"/>
  </mainPlan>
  <emergencyPlans>{home}</emergencyPlans>
</flightPlan>
"#,
            threshold = self.place(0.0, 0.0),
            out = self.place(4000.0, 0.0),
            narrow = self.place(4000.0, 800.0),
            narrow_centre = centre(4000.0, 400.0),
            back = self.place(0.0, 800.0),
            wide = self.place(0.0, 2000.0),
            wide_centre = centre(0.0, 1400.0),
            forth = self.place(4000.0, 2000.0),
            direct = self.place(-1600.0, -700.0),
            last = self.place(-1000.0, 0.0),
            home = self.emergency("home", 700.0),
        )
    }

    /// Two flights, each around the field and back; behind the landing of the first one the plan waits for a start. `second`: the field
    /// that the second one takes off from, and lands on.
    pub fn two_flights(&self, second: Field) -> String {
        let runway = |id: &str, field: &Field| {
            let (elevation, heading) = (field.elevation_m, field.heading_deg);
            let place = field.place(0.0, 0.0);
            format!(
                r#"<runway id="{id}" {place} elevation="{elevation}" heading="{heading}" length="{RUNWAY_M}" priority="1"/>"#
            )
        };
        format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<flightPlan xmlns="urn:legwork:flight-plan:1" name="Two flights" aircraft="trainer">
  <runways>{first}{second_runway}</runways>
  <mainPlan emergency="home">
    {one}
    {two}
  </mainPlan>
  <emergencyPlans>{home}</emergencyPlans>
</flightPlan>
"#,
            first = runway("R", self),
            second_runway = runway("S", &second),
            one = self.flight("", "R", r#"turnaroundEnergy="0.9" turnaroundTime="60""#),
            two = second.flight("2", "S", ""),
            home = self.emergency("home", 700.0),
        )
    }

    /// Take-off, two legs around the field, a final and the landing, with a suffix to each identifier.
    fn flight(&self, suffix: &str, runway: &str, turnaround: &str) -> String {
        format!(
            r#"<stage id="to{suffix}" type="take-off" runway="{runway}" altitude="60" altitudeReference="home"/>
    <stage id="around{suffix}" type="departure" altitude="110" altitudeReference="home">
      <TF id="out{suffix}" {out}/>
      <TF id="far{suffix}" {far}/>
      <TF id="final{suffix}" {last} altitude="70" altitudeReference="home"/>
    </stage>
    <stage id="land{suffix}" type="land" runway="{runway}" {turnaround}/>"#,
            out = self.place(1700.0, 0.0),
            far = self.place(-600.0, 900.0),
            last = self.place(-1000.0, 0.0),
        )
    }

    /// An emergency plan by way of a point of its own, so that a test sees which one is flown.
    fn emergency(&self, id: &str, left_m: f64) -> String {
        format!(
            r#"<emergencyPlan id="{id}" runway="R">
      <stage id="{id}-way" type="arrival" altitude="100" altitudeReference="home">
        <DF id="{id}-df" {direct}/>
        <TF id="{id}-final" {last} altitude="70" altitudeReference="home"/>
      </stage>
      <stage id="{id}-land" type="land" runway="R"/>
    </emergencyPlan>"#,
            direct = self.place(-1600.0, -left_m),
            last = self.place(-1000.0, 0.0),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: Field =
        Field { threshold: LatLon::new(36.4905, -84.2710), elevation_m: 322.0, heading_deg: 52.0 };

    #[test]
    fn the_mission_can_be_flown() {
        for way_back in [1800.0, 2400.0] {
            let reading = flight_plan::read(FIELD.mission(way_back).as_bytes());
            assert!(reading.problems.is_empty(), "{:?}", reading.problems);
            let profile = aircraft::Profile::default();
            let flat = terrain::Flat(FIELD.elevation_m);
            let problems = flight_plan::compile(reading.plan, &profile, &flat).err();
            assert!(problems.is_none(), "{problems:#?}");
        }
    }

    #[test]
    fn the_flight_for_accuracy_can_be_flown() {
        let reading = flight_plan::read(FIELD.accuracy().as_bytes());
        assert!(reading.problems.is_empty(), "{:?}", reading.problems);
        let flat = terrain::Flat(FIELD.elevation_m);
        let problems = flight_plan::compile(reading.plan, &aircraft::Profile::default(), &flat).err();
        assert!(problems.is_none(), "{problems:#?}");
    }

    #[test]
    fn two_flights_can_be_flown() {
        let reading = flight_plan::read(FIELD.two_flights(FIELD).as_bytes());
        assert!(reading.problems.is_empty(), "{:?}", reading.problems);
        let flat = terrain::Flat(FIELD.elevation_m);
        let problems = flight_plan::compile(reading.plan, &aircraft::Profile::default(), &flat).err();
        assert!(problems.is_none(), "{problems:#?}");
    }
}
