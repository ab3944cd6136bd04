//! How a draft is written down.

use crate::grid::HOME;
use crate::plans::{Emergency, Kind, Leg, Own};
use geometry::LatLon;

/// Every pattern: element, attributes, what is inside.
pub const PATTERNS: [(&str, &str, &str); 12] = [
    ("scan", r#"spacing="= r * 0.5" heading="0" overshoot="50""#, DISC),
    ("creepingLine", r#"spacing="= r * 0.5" overshoot="30""#, DISC),
    ("crissCross", r#"spacing="= r * 0.6" heading="20" overshoot="30""#, DISC),
    ("spiral", r#"spacing="200" outerRadius="= r + 200.0" direction="outward" turn="left""#, CENTRE),
    (
        "spiral",
        r#"spacing="200" innerRadius="150" outerRadius="= r + 200.0" direction="inward" turn="right""#,
        CENTRE,
    ),
    ("expandingSquare", r#"spacing="300" heading="30" radius="= r + 100.0" turn="right""#, CENTRE),
    ("sector", r#"radius="= r + 600.0" sectors="3" heading="10" passes="1" turn="right""#, CENTRE),
    ("trackLine", r#"spacing="= r * 0.5 + 200.0" returns="true""#, ROUTE),
    ("corridor", r#"width="= r" spacing="200""#, ROUTE),
    ("contour", r#"spacing="= 100.0 + r * 0.2" direction="inward" turn="left""#, SQUARE),
    ("figureEight", r#"radius="= 200.0 + r * 0.3" heading="40" turns="1" turn="left""#, CENTRE),
    ("orbit", r#"radius="= 200.0 + r * 0.2" turns="1" turn="left""#, r#"<centre fix="D2"/>"#),
];
const DISC: &str = r#"<area fix="C3" radius="= r"/>"#;
const SQUARE: &str = r#"<area><corner lat="36.54" lon="-84.17"/><corner lat="36.54" lon="-84.15"/><corner lat="36.555" lon="-84.15"/><corner lat="36.555" lon="-84.17"/></area>"#;
const CENTRE: &str = r#"<centre fix="C3"/>"#;
const ROUTE: &str = r#"<route><point fix="B3"/><point fix="C4"/><point fix="D4"/></route>"#;

/// A track at each end: every body flies something.
pub fn list(legs: &[Leg], prefix: &str) -> String {
    let body: String = legs.iter().map(one).collect();
    format!("{}{body}{}", track(&format!("{prefix}s"), ""), track(&format!("{prefix}z"), ""))
}

/// `gate`: an arc between two tracks. `round`: a loop forth and back with as many passes as a parameter says, a fork, and a call of
/// the gate.
pub fn procedures() -> String {
    let start = HOME.destination(45.0, 3000.0);
    let bend = start.destination(0.0, 1500.0);
    let centre = bend.destination(90.0, 600.0);
    let end = centre.destination(0.0, 600.0);
    let aside = |metres| at(start.destination(60.0, metres));
    format!(
        r#"<procedures>
        <procedure id="gate" reference="{0} {1}" bearing="0"><TF id="ga" {start}/><TF id="gb" {bend}/>
          <RF id="gc" {end} centreLat="{2}" centreLon="{3}" turn="right"/><TF id="gd" {exit}/></procedure>
        <procedure id="round" reference="{0} {1}" bearing="0"><parameter name="times"/>
          <iterative id="l" form="reverse" count="= times"><TF id="a" {a}/><TF id="b" {b}/></iterative>
          <intersection id="i" default="i-s" decideBefore="200m"><branch id="i-s" label="s" next="e"/>
            <branch id="i-l" label="l" next="d" when="r &gt; 900.0"/></intersection>
          <TF id="d" {d}/><TF id="e" {e}/><call id="g" procedure="gate" {bend} bearing="120"/></procedure>
        </procedures>"#,
        start.lat_deg,
        start.lon_deg,
        centre.lat_deg,
        centre.lon_deg,
        start = at(start),
        bend = at(bend),
        end = at(end),
        exit = at(end.destination(90.0, 1500.0)),
        a = aside(1000.0),
        b = aside(3000.0),
        d = aside(5000.0),
        e = aside(7000.0),
    )
}

fn at(position: LatLon) -> String {
    format!(r#"lat="{}" lon="{}""#, position.lat_deg, position.lon_deg)
}

fn track(id: &str, attributes: &str) -> String {
    format!(r#"<TF id="{id}" {}{attributes}/>"#, spot(id))
}

/// A place of its own for each name, within ten kilometres.
fn spot(name: &str) -> String {
    let metres = |bits: u64| 10_000.0 * (bits % 1009) as f64 / 1009.0;
    let (east, north) = (hash(name) >> 40, hash(name) >> 20);
    let position = HOME.destination(90.0, metres(east)).destination(0.0, metres(north));
    format!(r#"lat="{:.6}" lon="{:.6}""#, position.lat_deg, position.lon_deg)
}

/// FNV-1a.
fn hash(name: &str) -> u64 {
    let mix = |h: u64, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3);
    name.bytes().fold(0xcbf2_9ce4_8422_2325, mix)
}

/// An element with what every leg may have: an emergency plan of its own, and actions.
fn element(tag: &str, leg: &Leg, attributes: &str, inside: &str) -> String {
    let (attribute, by_cause) = match leg.emergency {
        Emergency::None => ("", ""),
        Emergency::ForEveryCause => (r#"emergency="other""#, ""),
        Emergency::ForLink => ("", r#"<emergency cause="link" plan="other"/>"#),
    };
    let actions = leg.actions.iter().map(|(when, what)| format!("<action {when}>{what}</action>"));
    let actions: String = actions.collect();
    let own = own(leg);
    format!(r#"<{tag} id="{}" {attributes} {own} {attribute}>{by_cause}{actions}{inside}</{tag}>"#, leg.id)
}

/// Of each leg others; a climb's altitude is its end.
fn own(leg: &Leg) -> String {
    let climbs = matches!(leg.kind, Kind::Climb | Kind::ClimbOnTrack);
    let altitude = |metres: String| {
        if climbs { String::new() } else { format!(r#"altitude="{metres}" altitudeReference="amsl""#) }
    };
    let (slow, low) = (hash(&leg.id) % 10, hash(&leg.id) / 10 % 5);
    match leg.own {
        Own::None => String::new(),
        Own::Constant => format!(r#"speed="{}" {}"#, 18 + slow, altitude((480 + 20 * low).to_string())),
        Own::Variable => format!(r#"speed="= 18.0 + 2.0 * n" {}"#, altitude("= 480.0 + 20.0 * n".into())),
    }
}

fn one(leg: &Leg) -> String {
    let id = &leg.id;
    let here = spot(id);
    let flown = |tag: &str, attributes: &str| element(tag, leg, &format!("{here} {attributes}"), "");
    let course = hash(id) % 360;
    match &leg.kind {
        Kind::Track(variant) => element("TF", leg, &spot(&format!("{id}{variant}")), ""),
        Kind::Direct => flown("DF", ""),
        Kind::Course => flown("CF", &format!(r#"course="{course}""#)),
        Kind::Start => flown("IF", ""),
        Kind::Lap => flown("HF", r#"course="0" turn="left" length="600""#),
        Kind::Climb => {
            flown("HA", r#"course="90" turn="right" length="600" altitude="600" altitudeReference="amsl""#)
        }
        Kind::ClimbOnTrack => {
            flown("FA", &format!(r#"course="{course}" altitude="600" altitudeReference="amsl""#))
        }
        Kind::Hold { until, laps } => {
            let until = if *until { r#"until="stop""# } else { "" };
            let laps = laps.map_or(String::new(), |n| format!(r#"maxLaps="{n}""#));
            flown("HM", &format!(r#"course="45" turn="right" length="600" {until} {laps}"#))
        }
        Kind::Pattern(which) => {
            let (tag, attributes, inside) = PATTERNS[*which];
            element(tag, leg, attributes, inside)
        }
        Kind::Call { nested } => {
            let (procedure, argument) =
                if *nested { ("round", r#"<argument name="times" value="= n"/>"#) } else { ("gate", "") };
            let attributes = format!(r#"{here} procedure="{procedure}" bearing="{course}""#);
            element("call", leg, &attributes, argument)
        }
        Kind::Jump => {
            let (over, to) = (format!("{id}-x"), format!("{id}-y"));
            flown("TF", &format!(r#"next="{to}""#)) + &track(&over, "") + &track(&to, "")
        }
        Kind::Loop { reverse, count, until, body } => {
            let form = if *reverse { "reverse" } else { "forward" };
            let until = until.map_or(String::new(), |u| format!(r#"until="{u}""#));
            let count = count.map_or("= n".into(), |c| c.to_string());
            let attributes = format!(r#"form="{form}" count="{count}" {until}"#);
            element("iterative", leg, &attributes, &list(body, &format!("{id}-")))
        }
        Kind::Fork { default, due } => fork(leg, *default, due),
    }
}

fn fork(leg: &Leg, default: bool, due: &str) -> String {
    let id = &leg.id;
    let default = if default { format!(r#"default="{id}-s""#) } else { String::new() };
    let (long, both) = (format!("{id}-d"), format!("{id}-e"));
    let branches = format!(
        r#"<branch id="{id}-s" label="s" next="{both}"/><branch id="{id}-l" label="l" next="{long}" when="r &gt; 900.0"/>"#
    );
    let fork = element("intersection", leg, &format!(r#"{default} decideBefore="{due}""#), &branches);
    fork + &track(&long, "") + &track(&both, "")
}
