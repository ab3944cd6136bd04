//! A small plan over flat ground of 300 m.

/// A take-off, these legs 200 m above the ground, and a landing; with the fixes A, B and C.
pub fn document(legs: &str) -> String {
    format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="small" aircraft="trainer">
        <fixes><fix id="A" lat="36.52" lon="-84.18"/><fix id="B" lat="36.55" lon="-84.18"/><fix id="C" lat="36.55" lon="-84.22"/></fixes>
        <runways><runway id="R" lat="36.5" lon="-84.2" elevation="300" heading="90" length="600" priority="1"/></runways>
        <mainPlan>
          <stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
          <stage id="m" type="mission" altitude="200" altitudeReference="agl">{legs}</stage>
          <stage id="land" type="land" runway="R"/>
        </mainPlan></flightPlan>"#
    )
}
