//! The words of other programs: who types one finds what it is called here. It is shown under the name that it has here.

use super::fuzzy::{self, Score};
use flight_plan::create::{LegChoice, Shape};

/// Words that mean the same elsewhere, and what they mean here.
struct Alias {
    words: &'static [&'static str],
    /// Actions by their identifiers; one that says of what it is (`…: Scan the area`) without that.
    actions: &'static [&'static str],
    /// Rows of the plan's tree by their tags.
    tags: &'static [&'static str],
}

const fn alias(
    words: &'static [&'static str],
    actions: &'static [&'static str],
    tags: &'static [&'static str],
) -> Alias {
    Alias { words, actions, tags }
}

/// All of them.
#[rustfmt::skip]
const TABLE: &[Alias] = &[
    alias(&["RTL", "return to launch", "return home", "go home", "failsafe"], &["emergency", "abort", "tool-emergency"], &["ALT"]),
    alias(&["rally point", "safe point", "alternate landing"], &["tool-emergency"], &["ALT"]),
    alias(&["home", "home position", "launch point", "airstrip"], &["tool-runway"], &["RWY"]),
    alias(&["geofence", "fence", "no-fly zone", "exclusion", "inclusion"], &["tool-zone"], &["IN", "OUT"]),
    alias(&["polygon", "shape"], &["tool-area", "tool-zone"], &[]),
    alias(&["inner polygon", "cutout", "leave out", "gap"], &["tool-hole"], &[]),
    alias(&["waypoint", "WP", "mission item", "add point"], &["tool-track"], &["IF", "TF", "DF", "RF", "CF"]),
    alias(&["survey grid", "survey", "lawnmower", "photogrammetry", "mapping", "transect"], &["tool-area"], &["SCAN"]),
    alias(&["corridor scan", "polyline", "route"], &["tool-line"], &["CORR", "TRACK"]),
    alias(&["camera", "overlap", "photo", "picture", "trigger", "shutter"], &["tool-area", "Edit Take pictures along it", "Edit Take no pictures along it"], &["SCAN"]),
    alias(&["orbit", "point of interest", "POI", "ROI"], &["tool-circle"], &["ORB"]),
    alias(&["loiter", "hover", "brake", "pause mission"], &["hold", "tool-track", "tool-circle"], &["HF", "HA", "HM", "ORB"]),
    alias(&["marker", "placemark", "pin"], &["tool-fix"], &["FIX"]),
    alias(&["macro", "template", "block"], &["tool-procedure"], &["PROC", "CALL"]),
    alias(&["ruler", "distance"], &["tool-measure"], &[]),
    alias(&["upload", "write mission", "write waypoints", "send mission"], &["push"], &[]),
    alias(&["download", "read mission", "read waypoints"], &["take-aboard"], &[]),
    alias(&["takeoff", "arm", "launch", "start mission"], &["start"], &["T/O"]),
    alias(&["go around", "missed approach", "next waypoint"], &["skip-leg"], &[]),
    alias(&["continue mission", "unpause"], &["resume"], &[]),
    alias(&["restart mission"], &["rewind"], &[]),
    alias(&["simulate", "simulation", "dry run"], &["play"], &[]),
    alias(&["KML", "KMZ", "GPX", "GeoJSON", "QGroundControl", "Mission Planner", "shapefile"], &["import"], &[]),
    alias(&["Google Earth"], &["import", "export-kml", "export-kmz"], &[]),
    alias(&["satellite", "imagery", "basemap", "DEM", "terrain data"], &["maps"], &[]),
    alias(&["clear mission", "new mission"], &["new"], &[]),
    alias(&["step back", "revert", "take back"], &["undo"], &[]),
    alias(&["step forward", "repeat"], &["redo"], &[]),
    alias(&["scale", "interface", "text size", "font size", "zoom the window"], &["larger", "smaller", "normal-size"], &[]),
    alias(&["jump to", "centre map", "home view"], &["fit"], &[]),
];

/// Tools that draw legs, and as what: whoever types the kind of a leg finds the tool for it.
const DRAWN: [(&str, Shape); 4] = [
    ("tool-track", Shape::Place),
    ("tool-line", Shape::Line),
    ("tool-area", Shape::Area),
    ("tool-circle", Shape::Circle),
];

/// How well the words of others for an action, or the kinds of legs that it draws, answer a query: only side by side, and less than
/// its own words would.
pub fn score(query: &str, action: &str) -> Option<Score> {
    let is_it =
        |known: &&str| action.strip_prefix(*known).is_some_and(|of| of.is_empty() || of.starts_with(": "));
    let of = TABLE.iter().filter(|alias| alias.actions.iter().any(&is_it));
    let words = of.flat_map(|alias| alias.words).filter_map(|word| fuzzy::words(query, word));
    let drawn = DRAWN.iter().filter(|(tool, _)| *tool == action);
    let kinds = drawn.flat_map(|(_, shape)| LegChoice::drawn_as(*shape));
    let kinds = kinds.filter_map(|kind| fuzzy::words(query, &kind.name()));
    words.chain(kinds).max().map(Score::of_another)
}

/// What is sought, in lower case, is another word for rows with this tag.
pub fn means(sought: &str, tag: &str) -> bool {
    let of = TABLE.iter().filter(|alias| alias.tags.contains(&tag));
    of.flat_map(|alias| alias.words).any(|word| word.to_lowercase() == sought)
}

/// Every tag that a word means.
#[cfg(test)]
pub fn tags() -> impl Iterator<Item = &'static str> {
    TABLE.iter().flat_map(|alias| alias.tags).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actions::{Group, table};
    use crate::map::tools::Toolbox;
    use crate::panels::tree::menu;
    use std::collections::BTreeSet;

    #[test]
    fn every_word_means_something_that_is_there() {
        let toolbox = Toolbox::default();
        let tools = toolbox.cards().map(|(card, _)| format!("tool-{}", card.id));
        let pictures = menu::PICTURES.map(|name| format!("{} {name}", Group::Edit.name()));
        let there: BTreeSet<String> =
            table::ENTRIES.iter().map(|entry| entry.id.to_owned()).chain(tools).chain(pictures).collect();
        for alias in TABLE {
            assert!(!alias.words.is_empty() && !alias.actions.is_empty(), "{:?}", alias.words);
            for action in alias.actions {
                assert!(there.contains(*action), "{:?}: there is no action {action}", alias.words);
            }
        }
    }

    #[test]
    fn every_kind_of_leg_leads_to_the_tool_that_draws_it() {
        let toolbox = Toolbox::default();
        for (tool, shape) in DRAWN {
            assert!(toolbox.cards().any(|(card, _)| tool == format!("tool-{}", card.id)), "{tool}");
            for kind in LegChoice::drawn_as(shape) {
                assert!(score(&kind.name(), tool).is_some(), "{kind:?}");
            }
        }
        for word in ["figure", "sector", "spiral"] {
            assert!(score(word, "tool-circle").is_some(), "{word}");
        }
        assert!(score("HM", "tool-track").is_some() && score("HM", "tool-area").is_none());
    }

    #[test]
    fn no_word_is_there_twice_for_the_same_action() {
        let mut seen = BTreeSet::new();
        for alias in TABLE {
            for word in alias.words {
                for action in alias.actions {
                    assert!(seen.insert((word.to_lowercase(), action)), "{word}: {action}");
                }
            }
        }
    }

    #[test]
    fn words_of_others_are_found_whole_and_by_their_beginnings() {
        for (query, action) in [("rtl", "emergency"), ("return to la", "abort"), ("Upload", "push")] {
            assert!(score(query, action).is_some(), "{query}");
        }
        for word in ["camera", "overlap", "photo"] {
            assert!(score(word, "Edit Take pictures along it: Scan the area").is_some(), "{word}");
            assert!(score(word, "tool-area").is_some() && means(word, "SCAN"), "{word}");
        }
        for (query, action) in [("rl", "emergency"), ("upload", "save"), ("uload", "push")] {
            assert!(score(query, action).is_none(), "{query}");
        }
        assert!(means("geofence", "OUT") && !means("geo", "OUT") && !means("geofence", "TF"));
    }
}
