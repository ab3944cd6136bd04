//! Legs to their elements.

use super::write::{Tag, Writer, fallback};
use super::{actions, patterns};
use crate::{Branch, DecideBefore, Holding, HoldingLength, IterativeForm, Leg, LegKind};

/// A leg with everything in it.
pub(super) fn leg(out: &mut Writer, l: &Leg) {
    write(out, l, |out| match &l.kind {
        LegKind::Iterative { body, .. } => body.iter().for_each(|inner| leg(out, inner)),
        kind => kind_children(out, kind),
    });
}

/// A leg without the legs inside it.
pub(super) fn alone(out: &mut Writer, leg: &Leg) {
    write(out, leg, |out| kind_children(out, &leg.kind));
}

fn write(out: &mut Writer, leg: &Leg, children: impl FnOnce(&mut Writer)) {
    let tag = Tag::new(leg.kind_name()).with("id", &leg.id).text("name", &leg.name);
    let tag = fallback(kind_attributes(tag, &leg.kind), &leg.emergency)
        .altitude(leg.altitude.as_ref())
        .maybe_value("speed", leg.speed_mps.as_ref())
        .maybe("next", leg.next.as_ref());
    out.element(tag, |out| {
        out.emergencies(&leg.emergency);
        leg.actions.iter().for_each(|a| actions::write(out, a));
        children(out);
    });
}

fn kind_attributes(tag: Tag, kind: &LegKind) -> Tag {
    match kind {
        LegKind::If(to) | LegKind::Tf(to) => tag.waypoint(to),
        LegKind::Df { to, turn } => match turn {
            Some(turn) => tag.waypoint(to).turn(*turn),
            None => tag.waypoint(to),
        },
        LegKind::Rf { to, centre, turn } => {
            tag.waypoint(to).with("centreLat", centre.lat_deg).with("centreLon", centre.lon_deg).turn(*turn)
        }
        LegKind::Cf { to, course_deg } => tag.waypoint(to).value("course", course_deg),
        LegKind::Fa { from, course_deg } => tag.waypoint(from).value("course", course_deg),
        LegKind::Hf(h) | LegKind::Ha(h) => holding(tag, h),
        LegKind::Hm { holding: h, until, max_laps } => {
            holding(tag, h).maybe("until", until.as_ref()).maybe_value("maxLaps", max_laps.as_ref())
        }
        LegKind::Iterative { form, count, until, turn, .. } => {
            let form = if *form == IterativeForm::Reverse { "reverse" } else { "forward" };
            tag.with("form", form)
                .maybe_value("count", count.as_ref())
                .maybe("until", until.as_ref())
                .turn(*turn)
        }
        LegKind::Intersection { default, decide_before, .. } => {
            let tag = tag.maybe("default", default.as_ref());
            match decide_before {
                DecideBefore::Time(s) => tag.with("decideBefore", format_args!("{s}s")),
                DecideBefore::Distance(m) => tag.with("decideBefore", format_args!("{m}m")),
            }
        }
        LegKind::Scan(scan) => patterns::scan_attributes(tag, scan),
        LegKind::Pattern(pattern) => patterns::attributes(tag, pattern),
        LegKind::Call(call) => {
            let tag = tag.with("procedure", &call.procedure);
            let tag = call.anchor.iter().fold(tag, |tag, anchor| tag.place(anchor, "at"));
            tag.maybe_value("bearing", call.bearing_deg.as_ref())
        }
        LegKind::Orbit { radius_m, turns, turn, .. } => {
            tag.value("radius", radius_m).value("turns", turns).turn(*turn)
        }
    }
}

fn holding(tag: Tag, holding: &Holding) -> Tag {
    let tag = tag
        .waypoint(&holding.fix)
        .maybe_value("course", holding.inbound_course_deg.as_ref())
        .turn(holding.turn);
    match &holding.leg {
        HoldingLength::Distance(metres) => tag.value("length", metres),
        HoldingLength::Time(seconds) => tag.value("time", seconds),
    }
}

fn kind_children(out: &mut Writer, kind: &LegKind) {
    match kind {
        LegKind::Intersection { branches, .. } => branches.iter().for_each(|b| branch(out, b)),
        LegKind::Scan(scan) => patterns::area(out, &scan.area),
        LegKind::Pattern(pattern) => patterns::children(out, pattern),
        LegKind::Call(call) => {
            for (name, source) in &call.arguments {
                out.leaf(Tag::new("argument").with("name", name).source("value", source));
            }
        }
        LegKind::Orbit { centre, .. } => out.leaf(Tag::new("centre").place(centre, "at")),
        // the legs of a loop are not its own
        LegKind::Iterative { .. }
        | LegKind::If(_)
        | LegKind::Tf(_)
        | LegKind::Df { .. }
        | LegKind::Rf { .. }
        | LegKind::Cf { .. }
        | LegKind::Fa { .. }
        | LegKind::Hf(_)
        | LegKind::Ha(_)
        | LegKind::Hm { .. } => {}
    }
}

fn branch(out: &mut Writer, branch: &Branch) {
    let tag = Tag::new("branch").with("id", &branch.id).text("label", &branch.label);
    out.leaf(tag.maybe("next", branch.next.as_ref()).maybe("when", branch.when.as_ref()));
}
