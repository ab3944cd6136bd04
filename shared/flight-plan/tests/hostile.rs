//! Malformed and hostile documents give problems, and never a panic, a hang or unbounded memory.
#![cfg(test)]

use aircraft::Profile;
use flight_plan::xml::{MAX_BYTES, MAX_ELEMENTS, MAX_PROBLEMS};
use flight_plan::{Severity, check, compile_document, read, write};
use proptest::prelude::*;
use terrain::Flat;

const LANGUAGE: &str = include_str!("data/language.xml");
const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

fn codes(document: impl AsRef<[u8]>) -> Vec<&'static str> {
    read(document).problems.iter().map(|p| p.code).collect()
}

fn plan_of(inside: &str) -> String {
    format!(r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer">{inside}</flightPlan>"#)
}

#[test]
fn a_document_of_64_mib_and_a_byte_is_refused_at_once() {
    assert_eq!(codes(vec![b' '; MAX_BYTES + 1]), ["too-large"]);
}

#[test]
fn nothing_and_garbage_are_no_plan() {
    assert_eq!(codes(""), ["not-a-plan"]);
    assert_eq!(codes("hello"), ["unexpected-text", "not-a-plan"]);
    assert_eq!(codes([0_u8; 1000]), ["bad-character", "unexpected-text", "not-a-plan"]);
    assert_eq!(codes([0xff_u8, 0xfe, 0x00]), ["not-utf8", "unexpected-text", "not-a-plan"]);
}

#[test]
fn an_entity_bomb_is_not_expanded() {
    let levels = (1..20).map(|i| format!(r#"<!ENTITY e{i} "{}">"#, format!("&e{};", i - 1).repeat(10)));
    let bomb = format!(r#"<!DOCTYPE x [<!ENTITY e0 "boom">{}]>"#, levels.collect::<String>());
    assert_eq!(codes(bomb + &plan_of("&e19;")), ["doctype", "not-a-plan"]);
    assert_eq!(codes(plan_of("&e19;")), ["entity"]);
    assert_eq!(codes(plan_of(r#"<fixes note="&e19;"/>"#)), ["entity"]);
}

#[test]
fn a_reference_to_a_forbidden_character() {
    for reference in ["&#0;", "&#1;", "&#xFFFE;", "&#x110000;"] {
        let found = codes(plan_of(&format!(r#"<fixes note="{reference}"/>"#)));
        assert!(matches!(found[..], ["bad-character" | "entity"]), "{reference}: {found:?}");
    }
}

/// `until="battery < 0.3"`: the schema's validator sees no XML there.
#[test]
fn a_bracket_in_an_attribute_is_no_xml_and_has_its_place() {
    let plan = plan_of("\n<fixes>\n  <fix id=\"A\" name=\"a < b\" lat=\"1\" lon=\"2\"/></fixes>");
    let problems = read(plan).problems;
    let [problem] = problems.as_slice() else { panic!("{problems:?}") };
    assert_eq!((problem.code, problem.location.unwrap().to_string()), ("not-xml", "3:23".to_owned()));
    assert!(problem.message.contains("`&lt;`"), "{problem}");
    assert_eq!(codes(plan_of("<fixes><fix id=\"A\" name=\"a > b\" lat=\"1\" lon=\"2\"/></fixes>")), [""; 0]);
}

#[test]
fn a_million_nested_elements() {
    assert_eq!(
        codes(plan_of(&"<mainPlan>".repeat(1_000_000))),
        [vec!["unknown-element"], vec!["too-deep"]].concat()
    );
}

#[test]
fn a_million_attributes() {
    let attributes: String = (0..50_000).map(|i| format!(" a{i}=''")).collect();
    let found = codes(plan_of(&format!("<fixes{attributes}/>")));
    assert_eq!(found.first(), Some(&"too-many-attributes"));
    assert!(found.len() <= MAX_PROBLEMS);
}

#[test]
fn a_tag_of_two_megabytes() {
    assert_eq!(codes(plan_of(&format!("<fixes note='{}'/>", "x".repeat(2 << 20)))), ["too-large"]);
}

#[test]
fn more_elements_than_a_plan_may_have() {
    let fixes = r#"<fix id="a" lat="1" lon="1"/>"#.repeat(MAX_ELEMENTS + 1);
    let reading = read(plan_of(&format!("<fixes>{fixes}</fixes>")));
    assert_eq!(reading.problems.iter().map(|p| p.code).collect::<Vec<_>>(), ["too-large"]);
    assert!(reading.plan.fixes.len() < MAX_ELEMENTS);
}

#[test]
fn more_faults_than_anyone_would_read() {
    let found = codes(plan_of(&format!("<fixes>{}</fixes>", "<fix/>".repeat(100_000))));
    assert_eq!(found.len(), MAX_PROBLEMS);
    assert_eq!(found.last(), Some(&"too-many-problems"));
}

#[test]
fn places_are_those_of_the_text() {
    let document = plan_of("\n<fixes>\n  <!-- é漢 --> <fix id=\"A\" lat=\"x\"\n  lon=\"1\"/>\n</fixes>");
    let problem = &read(&document).problems[0];
    assert_eq!((problem.code, problem.location.unwrap().to_string().as_str()), ("bad-value", "3:27"));
}

#[test]
fn a_byte_order_mark_is_no_problem() {
    let document = [b"\xef\xbb\xbf", FIRE_WATCH.as_bytes()].concat();
    assert_eq!(read(document).plan, read(FIRE_WATCH).plan);
}

fn stage_of(legs: &str) -> String {
    plan_of(&format!(r#"<mainPlan><stage id="s" type="mission">{legs}</stage></mainPlan>"#))
}

#[test]
fn a_spacing_said_twice_is_told_as_that() {
    let scan = r#"<scan id="p" fieldOfView="60" spacing="10"><area fix="A" radius="100"/></scan>"#;
    let document = stage_of(scan);
    let [problem] = &read(&document).problems[..] else { panic!("one problem was expected") };
    assert!(problem.message.contains("exactly one way"), "{problem}");
    let column = document.find("spacing").unwrap() + 1;
    assert_eq!(problem.location.unwrap().column as usize, column);
}

#[test]
fn what_is_missing_or_too_much_is_named() {
    let action = r#"<TF id="t" fix="A"><action on="start"><photo/><photo/></action></TF>"#;
    let circle = r#"<zones><keepOut id="z" lat="1" lon="1"/></zones>"#;
    for (document, said) in [
        (stage_of(action), "exactly one act"),
        (plan_of(circle), "give <keepOut> the attribute `radius`"),
        (plan_of("").replace(r#" aircraft="trainer""#, ""), "give <flightPlan> the attribute `aircraft`"),
    ] {
        let [problem] = &read(&document).problems[..] else { panic!("one problem was expected: {document}") };
        assert!(problem.message.contains(said), "{problem}");
    }
}

/// Faults of the newer elements: each a problem of its own, at its place.
#[test]
fn each_element_says_what_is_wrong_with_it() {
    let in_leg = |inside: &str| stage_of(&format!(r#"<TF id="t" fix="A">{inside}</TF>"#));
    let scan =
        |attributes: &str, area: &str| stage_of(&format!(r#"<scan id="p" {attributes}>{area}</scan>"#));
    let zone = |attributes: &str, inside: &str| {
        plan_of(&format!(r#"<zones><keepOut id="z" {attributes}>{inside}</keepOut></zones>"#))
    };
    let circle = r#"<area fix="A" radius="100"/>"#;
    let cases: [(String, &[&str]); 31] = [
        (in_leg(r#"<action on="start"><photo/></action>"#), &[]),
        (in_leg(r#"<action on="start"/>"#), &["missing-element"]),
        (in_leg(r#"<action on="start"><photo/><photo/></action>"#), &["unknown-element"]),
        (in_leg(r#"<action on="start"><explode/></action>"#), &["unknown-element", "missing-element"]),
        (in_leg(r#"<action><photo/></action>"#), &["missing-attribute"]),
        (in_leg(r#"<action on="start" every="5"><photo/></action>"#), &["missing-attribute"]),
        (in_leg(r#"<action on="never"><photo/></action>"#), &["bad-value"]),
        (in_leg(r#"<action on="abeam"><photo/></action>"#), &["missing-attribute"]),
        (in_leg(r#"<action on="start"><set variable="x" to="1"/></action>"#), &["bad-value"]),
        (in_leg(r#"<action on="start"><wait/></action>"#), &["missing-attribute"]),
        (in_leg(r#"<action on="start"><invoke service="a"/></action>"#), &["missing-attribute"]),
        (stage_of(r#"<CF id="t" fix="A"/>"#), &["missing-attribute"]),
        (stage_of(r#"<HM id="t" fix="A" turn="left"/>"#), &["missing-attribute"]),
        (stage_of(r#"<call id="t"/>"#), &["missing-attribute"]),
        (stage_of(r#"<call id="t" procedure="p" fix="A" lat="1" lon="1"/>"#), &["missing-attribute"]),
        (stage_of(r#"<call id="t" procedure="p"><argument name="x" value="1"/></call>"#), &["bad-value"]),
        (scan(r#"spacing="10""#, circle), &[]),
        (scan("", circle), &["missing-attribute"]),
        (scan(r#"spacing="10" fieldOfView="60""#, circle), &["unknown-attribute"]),
        (scan(r#"spacing="10""#, ""), &["missing-element"]),
        (scan(r#"spacing="10""#, &circle.repeat(2)), &["unknown-element"]),
        (scan(r#"spacing="10" entry="middle""#, circle), &["bad-value"]),
        (scan(r#"spacing="10""#, r#"<area polygon="field"/>"#), &["bad-value"]),
        (stage_of(r#"<corridor id="p" width="5" spacing="1"/>"#), &["missing-element"]),
        (stage_of(r#"<sector id="p" radius="5" turn="up"><centre fix="A"/></sector>"#), &["bad-value"]),
        (zone(r#"lat="1" lon="1" radius="5""#, r#"<corner lat="1" lon="1"/>"#), &["unknown-element"]),
        (zone(r#"lat="1" lon="1""#, ""), &["missing-attribute"]),
        (zone(r#"floor="5""#, ""), &["missing-attribute"]),
        (zone(r#"ceilingReference="agl""#, ""), &["missing-attribute"]),
        (zone("", r#"<active from="today" until="2026-06-01T06:00:00Z"/>"#), &["bad-value"]),
        (
            plan_of(r#"<procedures><procedure id="p"><parameter/></procedure></procedures>"#),
            &["missing-attribute"],
        ),
    ];
    for (document, expected) in cases {
        assert_eq!(codes(&document), expected, "{document}");
        let reading = read(&document);
        assert!(reading.problems.iter().all(|p| p.location.is_some()), "{document}");
        // and what was made out can be checked and written
        check(&reading.plan, &Profile::default(), &Flat(200.0));
        write(&reading.plan);
    }
}

/// What an attacker or a broken disk puts into a document.
#[derive(Debug, Clone)]
enum Fault {
    Flip(prop::sample::Index, u8),
    Cut(prop::sample::Index, prop::sample::Index),
    Repeat(prop::sample::Index, prop::sample::Index),
    Insert(prop::sample::Index, &'static str),
    /// The value of the attribute nearest after a place.
    Value(prop::sample::Index, &'static str),
    Truncate(prop::sample::Index),
}

fn fault() -> impl Strategy<Value = Fault> {
    let snippets = prop::sample::select(vec![
        "<",
        ">",
        "\"",
        "&",
        "\0",
        "<!--",
        "<![CDATA[",
        "<?",
        "<!DOCTYPE x>",
        "&lt;",
        "</stage>",
        "<iterative>",
        "\u{feff}",
        "]]>",
    ]);
    let values = prop::sample::select(vec![
        "",
        "NaN",
        "inf",
        "-inf",
        "1e308",
        "-1e308",
        "1e-308",
        "-0",
        "0",
        "-1",
        "90",
        "-180",
        "99999999999999999999",
        "= 1.0 / 0.0",
        "= (",
        "= fire_radius * 1e308",
        "= offset(fire_centre, 1e300, 1e300)",
        "= position",
        "= -----1",
        "= a.b.c[1]",
        "= [1].map(x, x)",
        "= 'a' + 'b'",
        "= \\u0000",
        "patrol",
        "sweep",
        "p1",
        "0s",
        "1e308m",
        "x y",
        "90 180",
        "= fire_out ? 1 : 2",
    ]);
    let index = any::<prop::sample::Index>;
    prop_oneof![
        2 => (index(), any::<u8>()).prop_map(|(at, byte)| Fault::Flip(at, byte)),
        1 => (index(), index()).prop_map(|(a, b)| Fault::Cut(a, b)),
        1 => (index(), index()).prop_map(|(a, b)| Fault::Repeat(a, b)),
        3 => (index(), snippets).prop_map(|(at, text)| Fault::Insert(at, text)),
        12 => (index(), values).prop_map(|(at, value)| Fault::Value(at, value)),
        1 => index().prop_map(Fault::Truncate),
    ]
}

/// Ranges that faults take or repeat, bytes.
const RANGE: usize = 400;

fn apply(document: &mut Vec<u8>, fault: &Fault) {
    let at = |index: &prop::sample::Index| {
        index.index(document.len().max(1)).min(document.len().saturating_sub(1))
    };
    match fault {
        _ if document.is_empty() => {}
        Fault::Flip(index, byte) => {
            let at = at(index);
            document[at] = *byte;
        }
        Fault::Cut(index, length) => {
            let from = at(index);
            let to = (from + length.index(RANGE)).min(document.len());
            document.drain(from..to);
        }
        Fault::Repeat(index, length) => {
            let from = at(index);
            let to = (from + length.index(RANGE)).min(document.len());
            let piece = document[from..to].to_vec();
            document.splice(to..to, piece);
        }
        Fault::Insert(index, text) => {
            let at = at(index);
            document.splice(at..at, text.bytes());
        }
        Fault::Value(index, value) => {
            let after = at(index);
            let Some(from) = document[after..].windows(2).position(|w| w == b"=\"").map(|i| after + i + 2)
            else {
                return;
            };
            let to = document[from..].iter().position(|b| *b == b'"').map_or(document.len(), |i| from + i);
            document.splice(from..to, value.bytes());
        }
        Fault::Truncate(index) => document.truncate(at(index)),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_mutated_document_never_panics_and_its_plan_can_be_written(
        original in prop::sample::select(vec![FIRE_WATCH, LANGUAGE]),
        faults in prop::collection::vec(fault(), 1..6),
    ) {
        let mut document = original.as_bytes().to_vec();
        faults.iter().for_each(|fault| apply(&mut document, fault));
        let reading = read(&document);
        prop_assert!(reading.problems.len() <= MAX_PROBLEMS);
        let problems = check(&reading.plan, &Profile::default(), &Flat(200.0));
        let good = !reading.has_errors() && problems.iter().all(|p| p.severity < Severity::Error);
        prop_assert_eq!(compile_document(&document, &Profile::default(), &Flat(200.0)).is_ok(), good);
        if good {
            prop_assert_eq!(read(write(&reading.plan)).plan, reading.plan);
        }
    }
}

/// What somebody may write who wants to mislead the reader, or has lost control of a number.
fn outrageous() -> impl Strategy<Value = String> {
    let names = [
        "pole\u{202e}dnah",
        "\u{200b}",
        "a\u{85}b",
        "x&#10;error: all is well",
        "\u{feff}",
        "12345678901234567890",
    ];
    let numbers =
        ["1e300", "-1e308", "593320254080585800000", "1e-300", "89.9999", "90", "-89.00001", "NaN", "0.1"];
    prop_oneof![
        prop::sample::select(names.to_vec()).prop_map(str::to_owned),
        prop::sample::select(numbers.to_vec()).prop_map(str::to_owned),
        any::<f64>().prop_map(|x| x.to_string()),
        "[a-z]{1,3}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn no_message_shows_what_can_not_be_read(words in prop::collection::vec(outrageous(), 1..6), places in prop::collection::vec(0..300_usize, 6)) {
        let mut parts: Vec<String> = include_str!("data/language.xml").split('"').map(str::to_owned).collect();
        let values = (parts.len() - 1) / 2;
        for (word, place) in words.iter().zip(places) {
            parts[2 * (place % values) + 1] = word.clone();
        }
        let reading = read(parts.join("\""));
        let found = check(&reading.plan, &Profile::default(), &Flat(300.0));
        for problem in reading.problems.iter().chain(&found) {
            let shown = problem.to_string();
            prop_assert!(!shown.chars().any(flight_plan::legible::is_unseen), "{shown:?}");
            prop_assert!(flight_plan::legible(&shown) == shown, "{shown:?}");
        }
    }
}

/// The leg that a place far away makes wrong is named as long as a number that somebody wrote for its name.
#[test]
fn a_far_place_names_what_follows_from_it_legibly() {
    let number = "-0.000000010124337449341684";
    let plan = include_str!("data/language.xml").to_owned();
    let mut parts: Vec<&str> = plan.split('"').collect();
    let values = (parts.len() - 1) / 2;
    for (word, place) in [("0", 130), (number, 129)] {
        parts[2 * (place % values) + 1] = word;
    }
    let found = check(&read(parts.join("\"")).plan, &Profile::default(), &Flat(300.0));
    let far = found.iter().find(|problem| problem.code == "far-away").unwrap().to_string();
    assert!(far.contains("If it is right, see to") && flight_plan::legible(&far) == far, "{far}");
}

#[test]
fn nothing_is_flown_at_a_pole_whatever_it_is() {
    const P: &str = r#"<variables><variable name="p" type="position" initial="88.9 10"/></variables>"#;
    let legs = [
        r#"<TF id="l" lat="90" lon="0"/>"#,
        r#"<HM id="l" lat="89.999" lon="0" course="0" turn="left" length="1000"/>"#,
        r#"<orbit id="l" radius="300" turns="1" turn="left"><centre lat="-89.5" lon="7"/></orbit>"#,
        r#"<scan id="l" spacing="100" heading="0"><area><corner lat="90" lon="0"/><corner lat="89.9" lon="1"/><corner lat="89.9" lon="90"/></area></scan>"#,
        r#"<orbit id="l" radius="150000" turns="1" turn="left"><centre lat="88.5" lon="7"/></orbit>"#,
        r#"<spiral id="l" outerRadius="150000" spacing="5000" turn="left"><centre lat="-88.5" lon="7"/></spiral>"#,
        r#"<DF id="l" at="= offset(p, 0.0, 60000.0)"/>"#,
    ];
    for leg in legs {
        let stage =
            format!(r#"<stage id="s" type="en-route" altitude="500" altitudeReference="amsl">{leg}</stage>"#);
        let plan = read(plan_of(&format!("{P}<mainPlan>{stage}</mainPlan>"))).plan;
        let found = check(&plan, &Profile::default(), &Flat(300.0));
        let of_leg: Vec<_> =
            found.iter().filter(|p| p.subject.as_ref().is_some_and(|id| id.as_str() == "l")).collect();
        assert!(of_leg.iter().any(|p| p.code == "near-pole"), "{leg}: {found:?}");
    }
}
