//! Saving keeps what was not edited as the user wrote it.
#![cfg(test)]

mod random;

use flight_plan::xml::{MAX_DEPTH, patch};
use flight_plan::*;
use geometry::LatLon;
use proptest::prelude::*;
use std::sync::Arc;

/// As a person writes it.
const WRITTEN: &str = r#"<?xml version="1.0"?>
<!-- The ridge, 2026. -->
<flightPlan xmlns="urn:legwork:flight-plan:1"
            aircraft='trainer' name="Ridge">
	<fixes> <!-- from the survey of May -->
		<fix id="A" lon="-84.20" lat="36.30"/>
		<fix id="B" lat="36.31" lon="-84.19" name="Big tree"/>   <!-- mind the tree -->
	</fixes>
	<runways><runway id="R" lat="36.29" lon="-84.2" elevation="300" heading="0" length="600"/></runways>
	<mainPlan>
		<!-- up -->
		<stage id="up" type="take-off" runway="R" altitude="100" altitudeReference="home"/>
		<stage id="s" type="en-route" altitude="500.0" altitudeReference="amsl">

			<!-- first the tree -->
			<TF id="one" at="36.30 -84.20" />
			<TF id="two"
			    fix="B"
			    speed="24"/>

			<iterative id="loop" form="forward" count="2">
				<TF id="three" fix="A"/> <!-- and again -->
			</iterative>
		</stage>
	</mainPlan>
</flightPlan>
<!-- the end -->
"#;

fn edited(text: &str, edit: impl FnOnce(&mut FlightPlan)) -> (FlightPlan, String) {
    let reading = read(text);
    assert_eq!(reading.problems, []);
    let mut plan = reading.plan;
    edit(&mut plan);
    let patched = patch(text, &plan);
    assert_eq!(read(&patched).plan, plan, "{patched}");
    (plan, patched)
}

fn leg(id: &str) -> Arc<Leg> {
    let text = format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan><stage id="s" type="en-route"><TF id="{id}" fix="A"/></stage></mainPlan></flightPlan>"#
    );
    read(text).plan.stages[0].legs[0].clone()
}

/// The lines that went, and those that came.
fn difference<'t>(before: &'t str, after: &'t str) -> (Vec<&'t str>, Vec<&'t str>) {
    let (mut old, mut new): (Vec<&str>, Vec<&str>) = (before.lines().collect(), after.lines().collect());
    let same = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    (old, new) = (old.split_off(same), new.split_off(same));
    let same = old.iter().rev().zip(new.iter().rev()).take_while(|(a, b)| a == b).count();
    old.truncate(old.len() - same);
    new.truncate(new.len() - same);
    (old, new)
}

#[test]
fn plan_that_was_not_edited_is_saved_as_it_was_even_if_it_is_broken() {
    assert_eq!(edited(WRITTEN, |_| {}).1, WRITTEN);
    for broken in ["", "<flightPlan", "<a><b></a>", "\u{feff}<flightPlan><fixes><fix/></fixes></flightPlan>"]
    {
        assert_eq!(patch(broken, &read(broken).plan), broken);
    }
}

#[test]
fn changed_altitude_is_one_changed_line() {
    let (_, text) =
        edited(WRITTEN, |plan| plan.stages[1].altitude.as_mut().unwrap().metres = Value::Constant(530.0));
    assert_eq!(text, WRITTEN.replace("500.0", "530"));
}

#[test]
fn attributes_come_and_go_in_the_style_of_their_element() {
    let (_, text) = edited(WRITTEN, |plan| {
        let leg = Arc::make_mut(&mut plan.stages[1].legs[1]);
        leg.name = "The \"tree\"".into();
        leg.speed_mps = None;
        plan.aircraft = "it's".into();
    });
    let (old, new) = difference(WRITTEN, &text);
    assert_eq!(old.first(), Some(&"            aircraft='trainer' name=\"Ridge\">"));
    assert_eq!(new.first(), Some(&"            aircraft='it&apos;s' name=\"Ridge\">"));
    assert!(
        text.contains("<TF id=\"two\"\n\t\t\t    name=\"The &quot;tree&quot;\"\n\t\t\t    fix=\"B\"/>"),
        "{text}"
    );
}

#[test]
fn place_that_was_said_in_another_way_is_said_once() {
    let (_, text) = edited(WRITTEN, |plan| {
        let to = PlanWaypoint {
            place: Place::Position(Value::Constant(LatLon::new(36.3, -84.3))),
            fly_over: false,
        };
        Arc::make_mut(&mut plan.stages[1].legs[0]).kind = LegKind::Tf(to);
    });
    assert_eq!(text, WRITTEN.replace(r#" at="36.30 -84.20""#, r#" lat="36.3" lon="-84.3""#));
}

#[test]
fn new_leg_is_indented_as_its_neighbours_and_a_deleted_one_goes_with_its_line() {
    let (_, text) = edited(WRITTEN, |plan| plan.stages[1].legs.insert(1, leg("new")));
    assert_eq!(difference(WRITTEN, &text), (vec![], vec!["\t\t\t<TF id=\"new\" fix=\"A\"/>"]));
    let (_, text) = edited(WRITTEN, |plan| drop(plan.stages[1].legs.remove(1)));
    assert_eq!(difference(WRITTEN, &text).1, Vec::<&str>::new());
    let (_, text) = edited(WRITTEN, |plan| plan.stages[0].legs.push(leg("new")));
    let up = "altitudeReference=\"home\"";
    let filled = format!("{up}>\n\t\t\t<TF id=\"new\" fix=\"A\"/>\n\t\t</stage>");
    assert_eq!(text, WRITTEN.replacen(&format!("{up}/>"), &filled, 1));
}

#[test]
fn moved_leg_takes_its_words_along() {
    let (_, text) = edited(WRITTEN, |plan| {
        let first = plan.stages[1].legs.remove(0);
        let LegKind::Iterative { body, .. } = &mut Arc::make_mut(&mut plan.stages[1].legs[1]).kind else {
            panic!()
        };
        body.push(first);
    });
    let lines =
        "\t\t\t\t<!-- first the tree -->\n\t\t\t\t<TF id=\"one\" at=\"36.30 -84.20\" />\n\t\t\t</iterative>";
    assert!(text.contains(&format!("<!-- and again -->\n{lines}")), "{text}");
    assert_eq!(text.matches("first the tree").count(), 1);
}

#[test]
fn loop_around_legs_keeps_them_as_they_are() {
    let (_, text) = edited(WRITTEN, |plan| {
        let mut around = plan.stages[1].legs[2].as_ref().clone();
        around.id = "around".into();
        let LegKind::Iterative { body, .. } = &mut around.kind else { panic!() };
        *body = std::mem::take(&mut plan.stages[1].legs);
        plan.stages[1].legs.push(Arc::new(around));
    });
    for kept in [
        "\t\t\t\t<!-- first the tree -->",
        "\t\t\t\t\t<TF id=\"three\" fix=\"A\"/>",
        "at=\"36.30 -84.20\" />",
    ] {
        assert!(text.contains(kept), "{kept} in {text}");
    }
}

#[test]
fn renamed_leg_and_one_of_another_kind_stay_where_they_are() {
    let (_, text) = edited(WRITTEN, |plan| {
        Arc::make_mut(&mut plan.stages[1].legs[0]).id = "uno".into();
        let to = PlanWaypoint { place: Place::Fix("B".into()), fly_over: false };
        Arc::make_mut(&mut plan.stages[1].legs[1]).kind = LegKind::Df { to, turn: None };
    });
    assert_eq!(text, WRITTEN.replace("\"one\"", "\"uno\"").replace("<TF id=\"two\"", "<DF id=\"two\""));
}

#[test]
fn emptied_list_keeps_its_comments_and_an_empty_one_is_used() {
    let (_, text) = edited(WRITTEN, |plan| plan.fixes.clear());
    assert!(text.contains("from the survey") && text.contains("mind the tree"), "{text}");
    let (_, back) = edited(&text, |plan| plan.fixes = read(WRITTEN).plan.fixes);
    assert!(back.contains("from the survey") && back.matches("<fixes>").count() == 1, "{back}");
}

#[test]
fn text_in_one_line_stays_in_one_line() {
    let line = read(WRITTEN).plan;
    let line: String = write(&line).lines().map(str::trim).collect();
    let (_, text) = edited(&line, |plan| plan.stages[1].legs.insert(1, leg("new")));
    assert_eq!(text.lines().count(), 1);
    assert!(text.contains(r#"<TF id="new" fix="A"/><TF id="two""#), "{text}");
}

#[test]
fn windows_line_ends_stay() {
    let text = WRITTEN.replace('\n', "\r\n");
    let (_, text) = edited(&text, |plan| plan.stages[1].legs.insert(1, leg("new")));
    assert_eq!(text.matches('\n').count(), text.matches("\r\n").count());
}

#[test]
fn what_cannot_be_carried_over_is_written_anew() {
    let twice =
        WRITTEN.replacen("\t<fixes>", "\t<fixes><fix id=\"Z\" lat=\"1\" lon=\"1\"/></fixes>\n\t<fixes>", 1);
    let mut plan = read(&twice).plan;
    plan.fixes.iter_mut().for_each(|fix| fix.name = "moved".into());
    assert_eq!(read(patch(&twice, &plan)).plan, plan);
    assert_eq!(patch("not XML", &plan), write(&plan));
    let deep = "<a>".repeat(MAX_DEPTH + 1);
    assert_eq!(patch(&deep, &plan), write(&plan));
}

#[test]
fn large_plan_with_every_leg_turned_around_keeps_all_comments() {
    let legs: String = (0..20_000).map(|i| format!("<TF id=\"l{i}\" fix=\"A\"/><!-- {i} -->\n")).collect();
    let text = WRITTEN.replacen("\t\t\t<TF id=\"one\"", &format!("{legs}\t\t\t<TF id=\"one\""), 1);
    let (_, text) = edited(&text, |plan| plan.stages[1].legs.reverse());
    assert_eq!(text.matches("<!--").count(), 20_000 + WRITTEN.matches("<!--").count());
}

/// Numbers that look random, for what needs no shrinking.
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % end.max(1)
    }

    fn pick<'t>(&mut self, of: &[&'t str]) -> &'t str {
        of[self.below(of.len())]
    }
}

/// A canonical document as people write: attributes in any order and quotes, comments, spaces, line ends.
fn untidy(canonical: &str, dice: &mut Dice) -> String {
    const BETWEEN: [&str; 9] = [
        "\n",
        "\n    ",
        "",
        " ",
        "\n\n\t",
        " <!-- here -->\n",
        "\n<!-- > it's <a> -->\n  ",
        "\r\n",
        "<!-- -->",
    ];
    let mut out = String::new();
    for line in canonical.lines().map(str::trim) {
        out.push_str(&if line.starts_with("<?") { line.to_owned() } else { untidy_tag(line, dice) });
        out.push_str(dice.pick(&BETWEEN));
    }
    out
}

fn untidy_tag(tag: &str, dice: &mut Dice) -> String {
    let end = if tag.ends_with("/>") { "/>" } else { ">" };
    let mut parts = tag.trim_end_matches(end).split_inclusive('"');
    let text: Vec<&str> = parts.by_ref().collect();
    let Some((name, _)) = text[0].split_once(' ') else { return tag.into() };
    let mut attributes: Vec<(&str, &str)> = text
        .chunks(2)
        .filter(|pair| pair.len() == 2)
        .map(|pair| {
            (pair[0].trim_start_matches(name).trim().trim_end_matches("=\""), pair[1].trim_end_matches('"'))
        })
        .collect();
    (1..attributes.len()).for_each(|i| attributes.swap(i, dice.below(i + 1)));
    let mut out = name.to_owned();
    for (name, value) in attributes {
        let quote = if value.contains('\'') { "\"" } else { dice.pick(&["\"", "'"]) };
        let space = dice.pick(&[" ", "  ", "\n\t", " "]);
        out += &format!("{space}{name}{}={quote}{value}{quote}", dice.pick(&["", " "]));
    }
    out + dice.pick(&["", " "]) + end
}

/// An edit that takes nothing away.
fn edit(plan: &mut FlightPlan, dice: &mut Dice) {
    plan.name.push('!');
    let count = plan.stages.len();
    let Some(stage) = (count > 0).then(|| &mut plan.stages[dice.below(count)]) else { return };
    let at = dice.below(stage.legs.len());
    match dice.below(7) {
        0 => {
            stage.altitude =
                Some(Altitude { metres: Value::Constant(77.0), reference: AltitudeReference::Agl })
        }
        1 => stage.legs.insert(at, leg("brand-new-leg")),
        2 => stage.legs.reverse(),
        3 if !stage.legs.is_empty() => {
            let leg = Arc::make_mut(&mut stage.legs[at]);
            leg.speed_mps = Some(Value::Expression("a < b".into()));
        }
        4 if !stage.legs.is_empty() => Arc::make_mut(&mut stage.legs[at]).id = "another-id-for-it".into(),
        5 => {
            let body = std::mem::take(&mut stage.legs);
            let around = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="t"><mainPlan><stage id="s" type="en-route"><iterative id="all-around-it" form="forward"/></stage></mainPlan></flightPlan>"#;
            let mut around = read(around).plan.stages[0].legs[0].as_ref().clone();
            let LegKind::Iterative { body: inside, .. } = &mut around.kind else { panic!() };
            *inside = body;
            stage.legs.push(Arc::new(around));
        }
        _ => {
            let moved = stage.legs.pop();
            let to = dice.below(count);
            plan.stages[to].legs.splice(0..0, moved);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_text_with_any_edit_reads_to_the_edited_plan_and_keeps_its_comments(plan in random::plan(), seed: u64) {
        let mut dice = Dice(seed);
        let text = untidy(&write(&plan), &mut dice);
        prop_assert_eq!(read(&text).problems, []);
        prop_assert_eq!(&read(&text).plan, &plan);
        prop_assert_eq!(&patch(&text, &plan), &text);
        let mut new = plan.clone();
        edit(&mut new, &mut dice);
        let patched = patch(&text, &new);
        prop_assert_eq!(read(&patched).problems, []);
        prop_assert_eq!(&read(&patched).plan, &new);
        // of two parts with one id, in the text or in the new plan, nobody can tell which one a comment belongs to
        if !random::has_duplicates(&plan) && !random::has_duplicates(&new) {
            prop_assert_eq!(patched.matches("<!--").count(), text.matches("<!--").count(), "{}\n\n{}", text, patched);
        }
    }

    #[test]
    fn text_of_one_plan_becomes_any_other(a in random::plan(), b in random::plan(), seed: u64) {
        let text = untidy(&write(&a), &mut Dice(seed));
        let patched = patch(&text, &b);
        prop_assert_eq!(read(&patched).problems, []);
        prop_assert_eq!(read(&patched).plan, b);
    }

    #[test]
    fn changed_number_changes_its_line_only(plan in random::plan(), seed: u64) {
        let mut plan = plan;
        let text = untidy(&write(&plan), &mut Dice(seed));
        prop_assume!(!plan.runways.is_empty());
        plan.runways[0].elevation_amsl_m = 1234.5;
        let patched = patch(&text, &plan);
        let (old, new) = difference(&text, &patched);
        prop_assert!(old.len() == 1 && new.len() == 1, "{:?} {:?}", old, new);
    }

    #[test]
    fn any_bytes_are_patched_without_a_panic(text in "[<>/a-z\"'= !?\\-\\[&;\\n]{0,60}", cut in 0..2000_usize) {
        let plan = read(WRITTEN).plan;
        patch(&text, &plan);
        let broken = WRITTEN.get(..cut).unwrap_or("").to_owned() + &text;
        patch(&broken, &plan);
        let mut other = read(&broken).plan;
        other.name.push('x');
        patch(&broken, &other);
    }
}
