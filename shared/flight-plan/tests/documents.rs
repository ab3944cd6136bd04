//! The language's documents say what is so: their examples are pieces of valid plans, their pictures are there, no leg
//! and no problem code is left out.
#![cfg(test)]

use aircraft::Profile;
use flight_plan::{Problem, Reading, check, compile_document, read};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use terrain::Tiles;

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

/// The files of a folder of the assets with an extension, in order.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(assets().join(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = paths.filter(|p| p.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    assert!(!files.is_empty(), "no .{extension} in {folder}");
    files
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn page(name: &str) -> String {
    text(&assets().join("docs").join(name))
}

/// What is wrong with a document, where no terrain is known.
fn problems(document: &str) -> Vec<Problem> {
    let ground = Tiles::new();
    let Reading { plan, mut problems, places, .. } = read(document);
    if !problems.iter().any(Problem::is_error) {
        problems.extend(check(&plan, &Profile::default(), &ground));
    }
    places.locate(&mut problems);
    problems
}

/// The fenced blocks of a page that have this language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let opening = format!("```{language}");
    let mut blocks = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if line.trim() == opening {
            blocks.push(lines.by_ref().take_while(|l| l.trim() != "```").collect::<Vec<_>>().join("\n"));
        }
    }
    blocks
}

/// The lines that say something, without their indentation.
fn bare(text: &str) -> Vec<&str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect()
}

fn is_excerpt(block: &str, document: &str) -> bool {
    let (block, document) = (bare(block), bare(document));
    !block.is_empty() && document.windows(block.len()).any(|lines| lines == block)
}

#[test]
fn fragments_have_no_problems_and_compile() {
    let mut found = Vec::new();
    for path in files("docs/fragments", "xml") {
        let document = text(&path);
        let name = path.file_name().unwrap().to_str().unwrap();
        found.extend(problems(&document).iter().map(|problem| format!("{name}:{problem}")));
        let compiled = compile_document(document.as_bytes(), &Profile::default(), &Tiles::new());
        found.extend(compiled.err().map(|_| format!("{name}: can't be compiled")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn every_example_is_a_piece_of_a_plan_that_is_tested() {
    let folders = ["docs/fragments", "docs/tutorial", "plans"];
    let plans: Vec<String> = folders.iter().flat_map(|f| files(f, "xml")).map(|path| text(&path)).collect();
    for path in files("docs", "md") {
        for block in blocks(&text(&path), "xml") {
            let found = plans.iter().any(|plan| is_excerpt(&block, plan));
            assert!(found, "{}: in no plan:\n{block}", path.display());
        }
    }
}

/// What stands in brackets behind `](`.
fn links(page: &str) -> Vec<&str> {
    page.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect()
}

#[test]
fn every_link_of_a_page_leads_somewhere() {
    for path in files("docs", "md") {
        let page = text(&path);
        for link in links(&page).into_iter().filter(|link| !link.starts_with("http")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            assert!(target.exists(), "{}: no {link}", path.display());
            let anchor = |line: &str| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
            let found = heading.is_empty()
                || text(&target)
                    .lines()
                    .any(|l| l.starts_with('#') && anchor(l).replace(['`', ',', ':', '='], "") == heading);
            assert!(found, "{}: no heading for {link}", path.display());
        }
    }
}

/// Every element that is a leg, as the schema has them.
fn legs() -> Vec<String> {
    let schema = text(&assets().join("schema/flight-plan-1.xsd"));
    let group = schema.split("<xs:group name=\"leg\">").nth(1).unwrap().split("</xs:group>").next().unwrap();
    let names =
        group.split("<xs:element name=\"").skip(1).map(|rest| rest.split('"').next().unwrap().to_owned());
    names.collect()
}

#[test]
fn every_leg_has_a_section_with_an_example_and_a_picture() {
    let reference = page("plan-language.md");
    let legs = legs();
    assert!(legs.len() > 20, "{legs:?}");
    for leg in legs {
        let section = reference.split("\n### ").find(|s| {
            let heading = s.lines().next().unwrap_or_default();
            heading.split(['`', ' ', ',']).any(|word| word == leg)
        });
        let section = section.unwrap_or_else(|| panic!("no section for {leg}"));
        let opening = format!("<{leg} ");
        assert!(blocks(section, "xml").iter().any(|b| b.contains(&opening)), "no example of {leg}");
        assert!(section.contains("](pictures/"), "no picture of {leg}");
    }
}

/// What a source text says before its tests, and those.
fn shipped_and_tests(source: &str) -> (&str, &str) {
    source.split_at(source.find("#[cfg(test)]").unwrap_or(source.len()))
}

/// The text literals of a source text that are codes by their form.
fn literals(source: &str) -> impl Iterator<Item = &str> {
    let lines = source.lines().filter(|l| !l.trim_start().starts_with("#["));
    lines.flat_map(|l| l.split('"').skip(1).step_by(2)).filter(|word| is_code(word))
}

/// The codes that a source text gives to problems: the text literals that stand first in `Problem::error(` and
/// `Problem::warning(`, those that the header of a rule names (`code-of-words`: what it means) and, where a code is chosen
/// before its problem is made, whatever is a code by its form.
fn codes_of(source: &str) -> BTreeSet<String> {
    let (shipped, _) = shipped_and_tests(source);
    let header: String = shipped.lines().map_while(|l| l.strip_prefix("//!")).collect();
    let named = header.split('`').skip(1).step_by(2).filter(|word| is_code(word));
    let calls =
        || ["Problem::error(", "Problem::warning("].iter().flat_map(|call| shipped.split(call).skip(1));
    let direct = calls().filter_map(|rest| rest.trim_start().strip_prefix('"')?.split('"').next());
    let chosen =
        calls().any(|rest| !rest.trim_start().starts_with('"')) || shipped.contains("-> ExpressionError");
    // the name of an encoding, not of a problem
    let chosen = literals(shipped).filter(|word| chosen && *word != "us-ascii");
    direct.chain(named).chain(chosen).map(str::to_owned).collect()
}

/// Words with hyphens between them.
fn is_code(word: &str) -> bool {
    word.contains('-') && word.split('-').all(|w| !w.is_empty() && w.bytes().all(|b| b.is_ascii_lowercase()))
}

/// Calls `look` with each source text of a folder, and whether it is nothing but tests.
fn for_each_source(folder: &Path, look: &mut dyn FnMut(&str, bool)) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            for_each_source(&path, look);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let tests = path.ends_with("tests.rs") || path.components().any(|c| c.as_os_str() == "tests");
            look(&text(&path), tests);
        }
    }
}

/// Every code that the sources of checks and review give to problems, and every one that their tests name.
fn codes_given_and_tested() -> (BTreeSet<String>, BTreeSet<String>) {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (mut given, mut tested) = (BTreeSet::new(), BTreeSet::new());
    for folder in ["flight-plan/src", "flight-plan/tests", "flight-exec/src", "flight-exec/tests"] {
        for_each_source(&shared.join(folder), &mut |source, tests| {
            let its_tests = if tests { source } else { shipped_and_tests(source).1 };
            tested.extend(literals(its_tests).map(str::to_owned));
            given.extend(if tests { BTreeSet::new() } else { codes_of(source) });
        });
    }
    assert!(given.len() > 90, "{given:?}");
    (given, tested)
}

/// The codes that the seeded faulty plans are named by.
fn seeded() -> BTreeSet<String> {
    let plans =
        ["plans/bad", "plans/bad/path", "plans/bad/path/wind"].map(|folder| files(folder, "xml")).concat();
    let names = plans.iter().map(|path| path.file_name().unwrap().to_str().unwrap());
    let codes = names.filter_map(|name| name.strip_prefix("xsd-").unwrap_or(name).split('.').next());
    codes.map(str::to_owned).collect()
}

#[test]
fn every_code_of_a_problem_is_in_the_reference() {
    let codes = &codes_given_and_tested().0 | &seeded();
    let reference = page("plan-language.md");
    let missing: Vec<&String> =
        codes.iter().filter(|code| !reference.contains(&format!("`{code}`"))).collect();
    assert!(missing.is_empty(), "not in the reference: {missing:?}");
}

#[test]
fn the_examples_say_which_codes_have_no_faulty_plan() {
    let (reference, examples) = (page("plan-language.md"), page("examples.md"));
    let (_, tables) = reference.split_once("\n## Problems").unwrap();
    let tables = tables.split("\n## ").next().unwrap();
    let rows = tables.lines().filter(|line| line.starts_with("| `")).filter_map(|row| row.split('|').nth(1));
    let listed: BTreeSet<&str> = rows.flat_map(|codes| codes.split('`').skip(1).step_by(2)).collect();
    let (_, told) = examples.split_once("These have none:").unwrap();
    let told: BTreeSet<&str> = told.split(". ").next().unwrap().split('`').skip(1).step_by(2).collect();
    let seeded = seeded();
    let without: BTreeSet<&str> = listed.into_iter().filter(|code| !seeded.contains(*code)).collect();
    assert_eq!(told, without);
}

/// That each seeded plan has its problem, and the good ones none, is for `examples.rs` and the review's tests to say.
#[test]
fn every_code_of_a_problem_has_a_faulty_plan_or_a_test_that_names_it() {
    let (given, tested) = codes_given_and_tested();
    let caught = &seeded() | &tested;
    let never: Vec<&String> = given.difference(&caught).collect();
    assert!(never.is_empty(), "neither seeded nor tested: {never:?}");
}

#[test]
fn the_tutorial_builds_the_fire_watch() {
    let fire_watch = read(text(&assets().join("plans/fire-watch.xml"))).plan;
    assert!(files("docs/tutorial", "xml").iter().any(|step| read(text(step)).plan == fire_watch));
}
