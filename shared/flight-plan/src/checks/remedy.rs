//! Edits that several rules offer.

use super::Inspection;
use crate::{Altitude, AltitudeReference, Edit, Id, Leg, LegKind, Value};

/// The leg with another kind. Not for loops: their bodies may be large.
pub(super) fn with_kind(leg: &Leg, kind: LegKind) -> Edit {
    let with = Box::new(Leg { kind, ..leg.clone() });
    Edit::ReplaceLeg { leg: leg.id.clone(), with }
}

/// The leg with its kind changed in place; `None` if `change` has nothing to change. Not for loops.
pub(super) fn changed(leg: &Leg, change: impl FnOnce(&mut LegKind) -> Option<()>) -> Option<Edit> {
    let mut kind = leg.kind.clone();
    change(&mut kind)?;
    Some(with_kind(leg, kind))
}

/// Flying a leg at a lower speed, where the aircraft can: to tenths of m/s below `speed_mps`.
pub(super) fn slower(view: &Inspection, of: &Id, speed_mps: f64) -> Option<Edit> {
    let slow = slow_mps(view, speed_mps)?;
    Some(Edit::SetSpeed { of: of.clone(), speed_mps: Some(Value::Constant(slow)) })
}

/// The advice to fly at a lower speed behind another one, where the aircraft can; else nothing.
pub(super) fn or_slower(view: &Inspection, speed_mps: f64) -> String {
    let said = |mps| format!(", or fly no faster than {mps:.1} m/s");
    slow_mps(view, speed_mps).map_or_else(String::new, said)
}

/// The advice to fly at a lower speed, where the aircraft can, before another one that no edit is offered for.
pub(super) fn slower_or(view: &Inspection, speed_mps: f64, other: String) -> String {
    let first = |mps| format!("fly no faster than {mps:.1} m/s, or {other}");
    slow_mps(view, speed_mps).map_or_else(|| other.clone(), first)
}

/// A speed rounded down to tenths of m/s; `None`: the aircraft can't fly so slowly.
pub(super) fn slow_mps(view: &Inspection, speed_mps: f64) -> Option<f64> {
    let tenths_mps = (speed_mps * 10.0).floor() / 10.0;
    (tenths_mps >= view.profile.min_airspeed_mps).then_some(tenths_mps)
}

/// The greatest speed at which the aircraft turns within a radius, m/s.
pub(super) fn speed_for_radius_mps(view: &Inspection, radius_m: f64) -> f64 {
    let per_speed = view.turn_radius_m(1.0);
    (radius_m / per_speed).max(0.0).sqrt()
}

/// Another altitude for a leg or stage: the one that is written, `by_m` higher, in whole metres of what it counts from; where
/// none is written, above mean sea level. `is_amsl_m`: where that leads.
pub(super) fn relevelled(
    view: &Inspection,
    of: &Id,
    written: Option<&Altitude>,
    is_amsl_m: f64,
    by_m: f64,
) -> Option<Edit> {
    let (metres, reference) = counted(view, written, is_amsl_m)?;
    Some(Edit::relevel(of, metres, reference, by_m))
}

/// The same, higher by at least `by_m`, in tens of metres.
pub(super) fn raise(
    view: &Inspection,
    of: &Id,
    written: Option<&Altitude>,
    is_amsl_m: f64,
    by_m: f64,
) -> Option<Edit> {
    let (metres, reference) = counted(view, written, is_amsl_m)?;
    Some(Edit::raise(of, metres, reference, by_m))
}

/// An altitude as it is written, metres, and what it counts from.
fn counted(
    view: &Inspection,
    written: Option<&Altitude>,
    is_amsl_m: f64,
) -> Option<(f64, AltitudeReference)> {
    match written {
        Some(written) => Some((view.number(&written.metres)?, written.reference)),
        None => Some((is_amsl_m, AltitudeReference::Amsl)),
    }
}

/// A direction as degrees true in 0..360; `None` if it is no number.
pub(super) fn normal_deg(direction_deg: f64) -> Option<f64> {
    direction_deg.is_finite().then(|| geometry::geodesy::normalise_360(direction_deg))
}
