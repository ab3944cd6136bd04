//! What several rules advise, in the words of the leg that it is advised for.

use flight_plan::{LegKind, Pattern};

/// How the turns of a leg get more room.
pub(super) fn room_to_turn(kind: Option<&LegKind>) -> &'static str {
    match kind {
        Some(LegKind::Scan(_)) => "widen its `spacing` or give it `overshoot`",
        Some(LegKind::Hf(_) | LegKind::Ha(_) | LegKind::Hm { .. }) => {
            "lengthen its straight legs (`length` or `time`)"
        }
        Some(LegKind::Orbit { .. } | LegKind::Rf { .. }) => "widen its radius",
        Some(LegKind::Pattern(pattern)) => match pattern {
            Pattern::Sector { .. } | Pattern::FigureEight { .. } => "enlarge its `radius`",
            Pattern::Spiral { .. } => "widen its `spacing` or its `innerRadius`",
            Pattern::TrackLine { .. } | Pattern::Corridor { .. } => {
                "widen its `spacing` or straighten its route"
            }
            Pattern::Contour { .. } => "widen its `spacing` or fly fewer `loops`",
            Pattern::ExpandingSquare { .. } => "widen its `spacing`",
        },
        _ => "lengthen this leg or the one before it, or widen the turn between them",
    }
}

/// How a leg that is too steep gets gentler: a pattern or a holding is as long as it is.
pub(super) fn room_to_climb(kind: Option<&LegKind>) -> String {
    let before =
        "reach its altitude before it, on the leg before or in a holding (HA), or change its altitude";
    match kind {
        Some(LegKind::Pattern(Pattern::Contour { level_step_m: Some(_), .. })) => {
            format!("make its `levelStep` smaller, or {before}")
        }
        Some(LegKind::Scan(_) | LegKind::Orbit { .. } | LegKind::Pattern(_)) => before.into(),
        Some(LegKind::Hf(_) | LegKind::Hm { .. }) => {
            format!("make it a hold to altitude (HA), or {before}")
        }
        Some(LegKind::Ha(_)) => format!("lengthen its straight legs (`length` or `time`), or {before}"),
        Some(LegKind::Rf { .. }) => format!("widen its radius, or {before}"),
        _ => "change its altitude, lengthen this leg or hold to altitude (HA)".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The remedies that exist where "lengthen this leg" is none.
    #[test]
    fn what_has_no_length_of_its_own_is_not_to_be_lengthened() {
        let legs = r#"<scan id="scan" spacing="300"><area fix="A" radius="900"/></scan>
            <creepingLine id="line" spacing="300"><area fix="A" radius="900"/></creepingLine>
            <spiral id="spiral" outerRadius="900" spacing="200" turn="left"><centre fix="A"/></spiral>
            <expandingSquare id="square" spacing="300" radius="900" turn="left"><centre fix="A"/></expandingSquare>
            <sector id="sector" radius="900" turn="left"><centre fix="A"/></sector>
            <corridor id="corridor" width="900" spacing="300"><route><point fix="A"/><point fix="B"/></route></corridor>
            <contour id="contour" spacing="200" loops="2" levelStep="20" turn="left"><area fix="A" radius="900"/></contour>
            <figureEight id="eight" radius="300" turn="left"><centre fix="A"/></figureEight>
            <orbit id="orbit" radius="300" turn="left"><centre fix="A"/></orbit>
            <HF id="hf" fix="A" turn="left" length="900"/><HA id="ha" fix="A" turn="left" length="900"/><HM id="hm" fix="A" turn="left" length="900" maxLaps="2"/>"#;
        let document = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="x" aircraft="trainer"><mainPlan><stage id="s" type="mission">{legs}</stage></mainPlan></flightPlan>"#
        );
        let reading = flight_plan::read(&document);
        assert_eq!(reading.problems, []);
        let legs = reading.plan.all_legs();
        assert_eq!(legs.len(), 12);
        for context in legs {
            let kind = Some(&context.leg.kind);
            let advised = format!("{} {}", room_to_turn(kind), room_to_climb(kind));
            assert!(!advised.contains("lengthen this leg"), "{}: {advised}", context.leg.id);
        }
        let contour =
            reading.plan.leg(&"contour".into()).map(|context| room_to_climb(Some(&context.leg.kind)));
        assert!(contour.is_some_and(|advice| advice.contains("`levelStep`")));
        assert!(room_to_turn(None).starts_with("lengthen this leg"));
    }
}
