//! Plans made of fixes on a grid, around one runway.

use aircraft::Profile;
use flight_plan::{Program, compile_document};
use geometry::LatLon;
use std::sync::Arc;
use terrain::Flat;

pub const GROUND_M: f64 = 300.0;
pub const HOME: LatLon = LatLon::new(36.5, -84.2);

/// Fix `x` `y` of the grid: two kilometres apart, `B2` is 2 km east and 4 km north of home.
pub fn fix(name: &str) -> LatLon {
    let bytes = name.as_bytes();
    let (east, north) = (f64::from(bytes[0] - b'A'), f64::from(bytes[1] - b'0'));
    HOME.destination(90.0, 2000.0 * east).destination(0.0, 2000.0 * north)
}

/// A whole document around some legs of a mission stage, with variables and attributes of that stage.
pub fn document_with(legs: &str, variables: &str, stage: &str) -> String {
    let names = ('A'..='F').flat_map(|x| (0..6).map(move |y| format!("{x}{y}")));
    let fixes: String = names
        .map(|n| {
            let p = fix(&n);
            format!(r#"<fix id="{n}" lat="{}" lon="{}"/>"#, p.lat_deg, p.lon_deg)
        })
        .collect();
    format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="test" aircraft="trainer">
        <fixes>{fixes}</fixes>
        <runways>
          <runway id="R" lat="{}" lon="{}" elevation="300" heading="90" length="600" priority="1"/>
        </runways>
        <variables>{variables}</variables>
        <mainPlan emergency="back">
          <stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
          <stage id="m" type="mission" altitude="200" altitudeReference="agl" {stage}>{legs}</stage>
          <stage id="land" type="land" runway="R"/>
        </mainPlan>
        <emergencyPlans>
          <emergencyPlan id="back" runway="R">
            <stage id="b1" type="arrival"><DF id="b-df" fix="A1" altitude="150" altitudeReference="agl"/></stage>
            <stage id="b-land" type="land" runway="R"/>
          </emergencyPlan>
          <emergencyPlan id="other" runway="R">
            <stage id="o1" type="arrival"><DF id="o-df" fix="B1" altitude="150" altitudeReference="agl"/></stage>
            <stage id="o-land" type="land" runway="R"/>
          </emergencyPlan>
        </emergencyPlans>
        </flightPlan>"#,
        HOME.lat_deg, HOME.lon_deg
    )
}

/// The document's program, or its problems, one a line.
pub fn compiled(document: &str) -> Result<Arc<Program>, String> {
    let program = compile_document(document.as_bytes(), &Profile::default(), &Flat(GROUND_M));
    program
        .map(Arc::new)
        .map_err(|problems| Vec::from_iter(problems.iter().map(ToString::to_string)).join("\n"))
}
