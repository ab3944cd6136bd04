//! The walk over a leg's values, once for readers and once for writers.

use crate::{
    Act, Area, Call, Holding, HoldingLength, Leg, LegAction, LegKind, Pattern, Place, Scan, Spacing, Trigger,
    Use, Value,
};
use geometry::LatLon;
use std::sync::Arc;

/// The same walk over `&Leg` and over `&mut Leg`: only the kind of reference differs.
macro_rules! walk {
    ($module:ident, $slot:ident, $iter:ident $(, $mutable:tt)?) => {
        /// A value, with the name of its attribute where it has one of its own.
        pub(crate) enum $slot<'a> {
            /// A number.
            Number(&'static str, &'a $($mutable)? Value<f64>),
            /// A number that may be left out.
            Optional(&'static str, &'a $($mutable)? Option<Value<f64>>),
            /// A position.
            Place(&'a $($mutable)? Place),
            /// A position that can only be a constant.
            Corner(&'a $($mutable)? LatLon),
            /// An expression that can't be a constant, with what it is used as.
            #[allow(dead_code, reason = "who writes an expression need not ask what it is for")]
            Source(&'a $($mutable)? Arc<str>, Use),
        }

        pub(super) mod $module {
            use super::*;
            use super::$slot as Slot;

            type Visitor<'v, 'a> = dyn FnMut(Slot<'a>) + 'v;

            /// Everything that has a value in a leg (not in the legs inside it).
            pub fn leg<'a>(leg: &'a $($mutable)? Leg, visit: &mut Visitor<'_, 'a>) {
                let Leg { altitude, speed_mps, kind, actions, .. } = leg;
                level(altitude, speed_mps, visit);
                of_kind(kind, visit);
                actions.$iter().for_each(|a| action(a, visit));
            }

            /// The same without its actions.
            pub fn geometry<'a>(leg: &'a $($mutable)? Leg, visit: &mut Visitor<'_, 'a>) {
                let Leg { altitude, speed_mps, kind, .. } = leg;
                level(altitude, speed_mps, visit);
                of_kind(kind, visit);
            }

            fn level<'a>(
                altitude: &'a $($mutable)? Option<crate::Altitude>,
                speed_mps: &'a $($mutable)? Option<Value<f64>>,
                visit: &mut Visitor<'_, 'a>,
            ) {
                altitude.$iter().for_each(|a| visit(Slot::Number("altitude", & $($mutable)? a.metres)));
                visit(Slot::Optional("speed", speed_mps));
            }

            fn of_kind<'a>(kind: &'a $($mutable)? LegKind, visit: &mut Visitor<'_, 'a>) {
                match kind {
                    LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } => {
                        visit(Slot::Place(& $($mutable)? to.place))
                    }
                    LegKind::Rf { to, centre, .. } => {
                        visit(Slot::Place(& $($mutable)? to.place));
                        visit(Slot::Corner(centre));
                    }
                    LegKind::Cf { to, course_deg } | LegKind::Fa { from: to, course_deg } => {
                        visit(Slot::Place(& $($mutable)? to.place));
                        visit(Slot::Number("course", course_deg));
                    }
                    LegKind::Hf(h) | LegKind::Ha(h) => holding(h, visit),
                    LegKind::Hm { holding: h, until, max_laps } => {
                        holding(h, visit);
                        until.$iter().for_each(|source| visit(Slot::Source(source, Use::Condition)));
                        visit(Slot::Optional("maxLaps", max_laps));
                    }
                    LegKind::Iterative { count, until, .. } => {
                        visit(Slot::Optional("count", count));
                        until.$iter().for_each(|source| visit(Slot::Source(source, Use::Condition)));
                    }
                    LegKind::Intersection { branches, .. } => {
                        let conditions = branches.$iter().flat_map(|b| b.when.$iter());
                        conditions.for_each(|source| visit(Slot::Source(source, Use::Condition)));
                    }
                    LegKind::Scan(s) => scan(s, visit),
                    LegKind::Pattern(p) => pattern(p, visit),
                    LegKind::Call(c) => call(c, visit),
                    LegKind::Orbit { centre, radius_m, turns, .. } => {
                        visit(Slot::Place(centre));
                        visit(Slot::Number("radius", radius_m));
                        visit(Slot::Number("turns", turns));
                    }
                }
            }

            fn holding<'a>(holding: &'a $($mutable)? Holding, visit: &mut Visitor<'_, 'a>) {
                visit(Slot::Place(& $($mutable)? holding.fix.place));
                visit(Slot::Optional("course", & $($mutable)? holding.inbound_course_deg));
                match & $($mutable)? holding.leg {
                    HoldingLength::Distance(metres) => visit(Slot::Number("length", metres)),
                    HoldingLength::Time(seconds) => visit(Slot::Number("time", seconds)),
                }
            }

            fn scan<'a>(scan: &'a $($mutable)? Scan, visit: &mut Visitor<'_, 'a>) {
                area(& $($mutable)? scan.area, visit);
                spacing(& $($mutable)? scan.spacing, visit);
                visit(Slot::Optional("heading", & $($mutable)? scan.heading_deg));
                visit(Slot::Number("overshoot", & $($mutable)? scan.overshoot_m));
            }

            fn pattern<'a>(pattern: &'a $($mutable)? Pattern, visit: &mut Visitor<'_, 'a>) {
                match pattern {
                    Pattern::Spiral { centre, inner_radius_m, outer_radius_m, spacing: s, .. } => {
                        visit(Slot::Place(centre));
                        visit(Slot::Number("innerRadius", inner_radius_m));
                        visit(Slot::Number("outerRadius", outer_radius_m));
                        spacing(s, visit);
                    }
                    Pattern::ExpandingSquare { centre, spacing: s, heading_deg, radius_m, .. } => {
                        visit(Slot::Place(centre));
                        spacing(s, visit);
                        visit(Slot::Number("heading", heading_deg));
                        visit(Slot::Number("radius", radius_m));
                    }
                    Pattern::Sector { centre, radius_m, sectors, heading_deg, passes, .. } => {
                        visit(Slot::Place(centre));
                        visit(Slot::Number("radius", radius_m));
                        visit(Slot::Number("sectors", sectors));
                        visit(Slot::Number("heading", heading_deg));
                        visit(Slot::Number("passes", passes));
                    }
                    Pattern::TrackLine { route, spacing: s, .. } => {
                        route.$iter().for_each(|place| visit(Slot::Place(place)));
                        spacing(s, visit);
                    }
                    Pattern::Corridor { route, width_m, spacing: s } => {
                        route.$iter().for_each(|place| visit(Slot::Place(place)));
                        visit(Slot::Number("width", width_m));
                        spacing(s, visit);
                    }
                    Pattern::Contour { area: a, spacing: s, loops, levels, level_step_m, .. } => {
                        area(a, visit);
                        spacing(s, visit);
                        visit(Slot::Optional("loops", loops));
                        visit(Slot::Optional("levels", levels));
                        visit(Slot::Optional("levelStep", level_step_m));
                    }
                    Pattern::FigureEight { centre, radius_m, heading_deg, turns, .. } => {
                        visit(Slot::Place(centre));
                        visit(Slot::Number("radius", radius_m));
                        visit(Slot::Number("heading", heading_deg));
                        visit(Slot::Number("turns", turns));
                    }
                }
            }

            fn call<'a>(call: &'a $($mutable)? Call, visit: &mut Visitor<'_, 'a>) {
                for (_, source) in & $($mutable)? call.arguments {
                    visit(Slot::Source(source, Use::Any));
                }
                call.anchor.$iter().for_each(|place| visit(Slot::Place(place)));
                visit(Slot::Optional("bearing", & $($mutable)? call.bearing_deg));
            }

            fn action<'a>(action: &'a $($mutable)? LegAction, visit: &mut Visitor<'_, 'a>) {
                match & $($mutable)? action.trigger {
                    Trigger::Distance(x) => visit(Slot::Number("afterDistance", x)),
                    Trigger::Every(x) => visit(Slot::Number("every", x)),
                    Trigger::Time(x) => visit(Slot::Number("afterTime", x)),
                    Trigger::Abeam(place) => visit(Slot::Place(place)),
                    Trigger::Start | Trigger::End => {}
                }
                match & $($mutable)? action.act {
                    Act::PhotoSeries { every_m } => visit(Slot::Number("every", every_m)),
                    Act::Set { to, .. } => visit(Slot::Source(to, Use::Any)),
                    Act::Wait { seconds } => visit(Slot::Number("seconds", seconds)),
                    Act::Photo | Act::PhotoStop | Act::VideoStart | Act::VideoStop | Act::Invoke { .. } => {}
                }
            }

            fn area<'a>(area: &'a $($mutable)? Area, visit: &mut Visitor<'_, 'a>) {
                match area {
                    Area::Circle { centre, radius_m } => {
                        visit(Slot::Place(centre));
                        visit(Slot::Number("radius", radius_m));
                    }
                    Area::Expression(source) => visit(Slot::Source(source, Use::Polygon)),
                    Area::Polygon { corners, holes } => {
                        corners.$iter().for_each(|corner| visit(Slot::Corner(corner)));
                        for hole in holes {
                            hole.$iter().for_each(|corner| visit(Slot::Corner(corner)));
                        }
                    }
                }
            }

            fn spacing<'a>(spacing: &'a $($mutable)? Spacing, visit: &mut Visitor<'_, 'a>) {
                match spacing {
                    Spacing::Metres(metres) => visit(Slot::Number("spacing", metres)),
                    Spacing::Camera { field_of_view_deg, overlap, height_m } => {
                        visit(Slot::Number("fieldOfView", field_of_view_deg));
                        visit(Slot::Number("overlap", overlap));
                        visit(Slot::Optional("height", height_m));
                    }
                }
            }
        }
    };
}

walk!(shared, Slot, iter);
walk!(exclusive, SlotMut, iter_mut, mut);
