//! A place that is typed into the card: a position, or a name; where several places have it, they are offered.

use crate::assets;
use crate::assets::places::{Group, Place};
use crate::command::{Queue, ViewCommand};
use crate::coordinates::{self, Known, world};
use crate::guide::{Guide, Named, Search};
use crate::panels::field;
use crate::theme;
use crate::units::{self, Units};
use egui::{Button, Id, Label, Rect, RichText, Ui};
use geometry::LatLon;

/// So many places are offered.
const OFFERED: usize = 8;

/// Its field, and below that what a name may mean. The place that was typed or chosen; what is none stays in the field.
pub fn ask(
    ui: &mut Ui,
    name: &'static str,
    at: Option<LatLon>,
    guide: &mut Guide,
    u: Units,
    queue: &mut Queue,
) -> Option<LatLon> {
    let search = guide.search.as_ref().filter(|search| search.field == name);
    let place = at.map(units::position).unwrap_or_default();
    let shown = search.map_or(place.as_str(), |search| search.typed.as_str());
    let mut found = None;
    let (draft, typed) = field::row(ui, name, |ui| {
        (field::draft(ui, name), field::text_of_width(ui, name, shown, HINT, width(ui)))
    });
    let suggested = draft.as_deref().map_or_else(Vec::new, |draft| suggested(ui, draft, u));
    let is_typing = draft.is_some() && typed.is_none();
    if let Some(typed) = typed {
        guide.search = None;
        // a press on what is offered leaves the field, too
        let is_chosen = !suggested.is_empty() && is_pressed(ui, name);
        match if is_chosen { Err((suggested.clone(), String::new())) } else { read(&typed, u) } {
            Ok(at) => found = Some(at),
            Err((named, why)) => {
                if named.is_empty() {
                    queue.view(ViewCommand::Notice(why));
                }
                guide.search = Some(Search { field: name, typed, named });
            }
        }
    }
    let search = guide.search.as_ref().filter(|search| search.field == name);
    let named = if is_typing { &suggested[..] } else { search.map_or(&[][..], |search| &search.named[..]) };
    let offers = ui.scope(|ui| {
        let chosen = choose(ui, named);
        let p = theme::of(ui);
        match (named.is_empty(), is_typing) {
            (true, _) => {}
            (_, true) => drop(ui.label(RichText::new("Choose one, or type on").size(11.0).color(p.weak))),
            (_, false) => drop(ui.label(RichText::new(AMBIGUOUS).size(12.0).color(p.caution))),
        }
        chosen
    });
    ui.data_mut(|data| data.insert_temp(offers_id(name), offers.response.rect));
    if let Some(chosen) = offers.inner {
        found = Some(chosen);
    }
    if found.is_some() {
        guide.search = None;
    }
    found
}

/// Of the field: a position is seen whole in the narrowest card, too.
fn width(ui: &Ui) -> f32 {
    ui.available_width() - 20.0
}

/// What was typed is the name of several places.
const AMBIGUOUS: &str = "Choose which of them is meant";

/// In the field, as long as nothing else is.
const HINT: &str = "town or 46.5, 9.9";

fn offers_id(name: &str) -> Id {
    Id::unique("places offered for").with(name)
}

/// The pointer is pressed on what was offered in the last frame.
fn is_pressed(ui: &Ui, name: &str) -> bool {
    let offers = ui.data(|data| data.get_temp::<Rect>(offers_id(name)));
    let at = ui.input(|input| input.pointer.press_origin());
    offers.zip(at).is_some_and(|(offers, at)| offers.contains(at))
}

/// What the beginning of a name may mean; looked for once for each text.
fn suggested(ui: &Ui, draft: &str, u: Units) -> Vec<Named> {
    let id = Id::unique("places that begin so");
    if let Some((_, known)) =
        ui.data(|data| data.get_temp::<(String, Vec<Named>)>(id)).filter(|(of, _)| of == draft)
    {
        return known;
    }
    let found = beginning_with(draft, u);
    ui.data_mut(|data| data.insert_temp(id, (draft.to_owned(), found.clone())));
    found
}

fn beginning_with(draft: &str, u: Units) -> Vec<Named> {
    if coordinates::read(draft, &Known::default()).is_ok() {
        return Vec::new();
    }
    assets::places()
        .map_or_else(|_| Vec::new(), |world| offered(&world::like(draft, world, OFFERED), world, u))
}

fn choose(ui: &mut Ui, named: &[Named]) -> Option<LatLon> {
    let mut chosen = None;
    let weak = theme::of(ui).weak;
    ui.spacing_mut().item_spacing.y = 2.0;
    for place in named {
        let response = ui.add(Button::new(&place.name).truncate()).on_hover_text(units::position(place.at));
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &place.name));
        ui.add(Label::new(RichText::new(&place.region).size(11.0).color(weak)).truncate());
        if response.clicked() {
            chosen = Some(place.at);
        }
    }
    chosen
}

/// A position, or the name of a city or an airport; else what the name may mean, and what is wrong with it.
fn read(typed: &str, u: Units) -> Result<LatLon, (Vec<Named>, String)> {
    let world = assets::places().ok();
    let known = |world| coordinates::read(typed, &Known { world, ..Known::default() });
    let Some(places) = world else { return known(None).map_err(|why| (Vec::new(), why)) };
    if let Ok(at) = known(None) {
        return Ok(at);
    }
    let exact = world::exact(typed, places);
    let meant = if exact.is_empty() { world::like(typed, places, OFFERED) } else { exact };
    match (known(Some(places)), meant.as_slice()) {
        (Ok(at), [] | [_]) => Ok(at),
        // who typed the beginning of the only one means that
        (Err(_), [only]) => Ok(only.position()),
        (Ok(_), _) => Err((offered(&meant, places, u), String::new())),
        (Err(why), _) => Err((offered(&meant, places, u), why)),
    }
}

fn offered(places: &[Place<'_>], world: &[Group<'_>], u: Units) -> Vec<Named> {
    let offer = |place: &Place<'_>| Named {
        name: place.name.to_owned(),
        region: region(place, world, u),
        at: place.position(),
    };
    places.iter().take(OFFERED).map(offer).collect()
}

/// How far it is from the nearest large city.
fn region(place: &Place<'_>, world: &[Group<'_>], u: Units) -> String {
    let at = place.position();
    let cities = world.first().into_iter().flat_map(Group::iter);
    let nearest =
        cities.map(|city| (at.distance_m(city.position()), city)).min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map_or_else(String::new, |(metres, city)| {
        if city == place {
            "city".into()
        } else {
            format!("{} from {}", u.distance().show(metres), city.name)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_several_places_offers_them_with_what_is_near() {
        let (named, _) = read("springfield", Units::Si).unwrap_err();
        assert!((2..=OFFERED).contains(&named.len()), "{named:?}");
        assert!(
            named.iter().all(|place| place.name.contains("Springfield") && place.region.contains(" from "))
        );
        let places: std::collections::BTreeSet<_> = named.iter().map(|place| &place.region).collect();
        assert!(places.len() > 1, "they can be told apart: {named:?}");
    }

    #[test]
    fn places_are_offered_while_a_name_is_typed() {
        let offered = |draft: &str| beginning_with(draft, Units::Si);
        assert!(offered("innsb").iter().any(|place| place.name.contains("Innsbruck")));
        for draft in ["", "i", "47.1, 8.2"] {
            assert!(offered(draft).is_empty(), "{draft}");
        }
    }

    #[test]
    fn what_is_clear_is_not_asked_about() {
        for typed in ["47.1, 8.2", "lowi", "Paris", "090° 5 km from LOWI"] {
            assert!(read(typed, Units::Si).is_ok(), "{typed}");
        }
        assert_eq!(read("oban", Units::Si).unwrap_err().0[0].name, "EGEO Oban", "not Obando");
        assert!(read("nowhere at all", Units::Si).unwrap_err().0.is_empty());
    }
}
