//! Items of fence and rally lists: they fly nothing, and become zones and rally points.

use super::{Entry, Item, Mission, RallyPoint, commands as cmd};
use crate::note::Notes;
use flight_plan::{Id, Zone, ZoneKind, ZoneShape};
use geometry::LatLon;

/// Takes them out of the mission's entries.
pub fn take(mission: &mut Mission, notes: &mut Notes) {
    let is_fence = |entry: &Entry| matches!(entry, Entry::Item(item) if cmd::FENCES.contains(&item.command));
    let is_rally = |entry: &Entry| matches!(entry, Entry::Item(item) if item.command == cmd::RALLY_POINT);
    let (fences, others): (Vec<_>, Vec<_>) = mission.entries.drain(..).partition(is_fence);
    let (rally, others): (Vec<_>, Vec<_>) = others.into_iter().partition(is_rally);
    mission.entries = others;
    mission.zones.extend(zones(&items(fences), notes));
    for item in items(rally) {
        match item.position() {
            Some(position) => {
                let height_m = height_m(&item, mission.home_amsl_m, notes);
                let place = item.place;
                mission.rally.push(RallyPoint { place, position, height_m, landing_deg: None });
            }
            None => {
                let message = "this rally point is left out: it has no good position";
                notes.push("no-position", item.place, message);
            }
        }
    }
}

fn items(entries: Vec<Entry>) -> Vec<Item> {
    entries.into_iter().filter_map(|e| if let Entry::Item(item) = e { Some(item) } else { None }).collect()
}

/// Above home, as rally points count.
fn height_m(item: &Item, home_amsl_m: Option<f64>, notes: &mut Notes) -> Option<f64> {
    let metres = Some(item.param(7)).filter(|m| m.is_finite()).map(|m| m.clamp(-1e5, 1e5))?;
    match item.frame {
        cmd::FRAME_GLOBAL | cmd::FRAME_GLOBAL_INT if home_amsl_m.is_none() => {
            let message =
                "the altitude of this rally point is left out: the file doesn't say how high home is";
            notes.again("no-home", &item.place, message);
            None
        }
        cmd::FRAME_GLOBAL | cmd::FRAME_GLOBAL_INT => home_amsl_m.map(|home_m| metres - home_m),
        _ => Some(metres),
    }
}

/// A polygon's corners follow each other, and each says how many there are.
fn zones(items: &[Item], notes: &mut Notes) -> Vec<Zone> {
    let mut zones = Vec::new();
    let mut rest = items;
    while let Some((first, others)) = rest.split_first() {
        let shape = match first.command {
            cmd::FENCE_INCLUSION | cmd::FENCE_EXCLUSION => {
                let same = |item: &&Item| item.command == first.command && item.param(1) == first.param(1);
                let most = usize::try_from(crate::saturated(first.param(1))).unwrap_or(0);
                let count = rest.iter().take_while(same).take(most).count().max(1);
                let (corners, behind) = rest.split_at(count);
                rest = behind;
                polygon(corners, first, notes)
            }
            _ => {
                rest = others;
                circle(first, notes)
            }
        };
        let inside = matches!(first.command, cmd::FENCE_INCLUSION | cmd::FENCE_CIRCLE_INCLUSION);
        zones.extend(shape.map(|shape| of(inside, shape)));
    }
    zones
}

fn polygon(items: &[Item], first: &Item, notes: &mut Notes) -> Option<ZoneShape> {
    let corners: Vec<LatLon> = items.iter().filter_map(Item::position).collect();
    if corners.len() != items.len() || corners.len() < 3 || corners.len() as f64 != first.param(1) {
        let message =
            format!("this fence is left out: {} of its {} corners are there", corners.len(), first.param(1));
        notes.push("bad-fence", &first.place, message);
        return None;
    }
    Some(ZoneShape::Polygon(corners))
}

fn circle(item: &Item, notes: &mut Notes) -> Option<ZoneShape> {
    if item.command == cmd::FENCE_RETURN {
        let message = "the return point of the fence is left out: name an emergency plan instead";
        notes.push("breach-return", &item.place, message);
        return None;
    }
    let radius_m = Some(item.param(1)).filter(|metres| *metres > 0.0);
    let shape =
        item.position().zip(radius_m).map(|(centre, radius_m)| ZoneShape::Circle { centre, radius_m });
    if shape.is_none() {
        let message = "this fence is left out: it has no good centre and radius";
        notes.push("bad-fence", &item.place, message);
    }
    shape
}

/// A fence as a zone; its identifier is a proposal.
pub fn of(inside: bool, shape: ZoneShape) -> Zone {
    let (kind, name) = if inside { (ZoneKind::KeepIn, "keep-in") } else { (ZoneKind::KeepOut, "keep-out") };
    let (floor, ceiling) = (None, None);
    Zone { id: Id::new(name), name: String::new(), kind, shape, floor, ceiling, active: Vec::new() }
}
