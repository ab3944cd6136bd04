//! A plan from a file, with its aircraft and terrain.

use super::foreign::Foreign;
use super::output::DASH;
use super::tiles;
use aircraft::Profile;
use anyhow::Context;
use flight_exec::{Conditions, bring_within_glide, leave_zones_out, put_remedies, review, review_extremes};
use flight_plan::suggest::did_you_mean;
use flight_plan::{FlightPlan, Problem, Program, Reading};
use interchange::Note;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use terrain::Terrain;

/// Where a plan and its surroundings come from.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Source {
    /// The plan: ours (XML), or one of another program; `-` reads standard input.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Elevation tiles instead of the bundled one: an SRTM .hgt, named after its corner, or a folder of them; may be given several
    /// times.
    #[arg(long, value_name = "HGT|DIR")]
    pub terrain: Vec<PathBuf>,
    /// Aircraft instead of the one the plan names: one of ours by name (foam-wing, trainer, long-range-wing, fast-wing,
    /// vtol-wing), or a performance profile (JSON).
    #[arg(long, value_name = "NAME|JSON")]
    pub aircraft: Option<PathBuf>,
    /// How other formats are read.
    #[command(flatten, next_help_heading = "Reading other formats")]
    pub foreign: Foreign,
}

/// A plan that was read; it may have errors.
pub struct Loaded {
    /// The plan and what is wrong with its document.
    pub reading: Reading,
    /// What was assumed or left out, if it came from another program's format.
    pub notes: Vec<Note>,
    /// It came from another program's format: places in the document mean nothing to its author.
    pub converted: bool,
    /// It came from there, and nothing of the file became part of the plan.
    pub is_empty: bool,
    /// The aircraft, or why there is none.
    pub profile: Result<Profile, String>,
    /// The ground.
    pub terrain: Arc<dyn Terrain>,
    /// What the check of the plan gave, once it was asked for.
    checked: OnceLock<Result<Arc<Program>, Vec<Problem>>>,
}

impl Source {
    /// Reads the files.
    ///
    /// # Errors
    /// A file can't be read, or is not an elevation tile or profile.
    pub fn load(&self) -> anyhow::Result<Loaded> {
        // one byte more than is allowed: the reader then says that it is too long
        let bytes = read_at_most(&self.file, flight_plan::xml::MAX_BYTES as u64 + 1)?;
        match self.foreign.import(&self.file, &bytes, self.named_aircraft())? {
            None => self.surround(&bytes),
            Some(import) => {
                let document = flight_plan::write(&import.plan);
                let is_empty = import.is_empty();
                Ok(Loaded {
                    notes: import.notes,
                    converted: true,
                    is_empty,
                    ..self.surround(document.as_bytes())?
                })
            }
        }
    }

    /// A document that is here already, with the surroundings of this source.
    ///
    /// # Errors
    /// An elevation tile or profile can't be read or is invalid.
    pub fn surround(&self, document: &[u8]) -> anyhow::Result<Loaded> {
        let reading = flight_plan::read(document);
        let profile = match &self.aircraft {
            Some(path) => Ok(profile(path)?),
            None => Profile::by_name(&reading.plan.aircraft).map_err(|e| e.to_string()),
        };
        Ok(Loaded {
            reading,
            notes: Vec::new(),
            converted: false,
            is_empty: false,
            profile,
            terrain: tiles::load(&self.terrain)?,
            checked: OnceLock::new(),
        })
    }

    /// The aircraft that is given by the name of one of ours.
    fn named_aircraft(&self) -> Option<&str> {
        self.aircraft.as_deref().and_then(Path::to_str).filter(|name| Profile::by_name(name).is_ok())
    }
}

impl Loaded {
    /// A plan that is here already, over a ground; the aircraft is the one it names.
    pub fn of(plan: &FlightPlan, terrain: Arc<dyn Terrain>) -> Self {
        let reading = flight_plan::read(flight_plan::write(plan));
        let profile = Profile::by_name(&reading.plan.aircraft).map_err(|error| error.to_string());
        let checked = OnceLock::new();
        Self { reading, notes: Vec::new(), converted: true, is_empty: false, profile, terrain, checked }
    }

    /// The plan, to change it.
    pub fn plan_mut(&mut self) -> &mut FlightPlan {
        self.checked = OnceLock::new();
        &mut self.reading.plan
    }

    /// Everything that is wrong: document, plan, aircraft.
    pub fn problems(&self) -> Vec<Problem> {
        let mut problems = self.reading.problems.clone();
        match (self.checked(), &self.profile) {
            // the document's own problems already report that it names none
            (None, Err(_)) if self.reading.plan.aircraft.is_empty() && self.reading.has_errors() => {}
            (None, Err(reason)) => {
                let meant = did_you_mean(&self.reading.plan.aircraft, Profile::names().into_iter());
                let message =
                    format!("{reason}: correct the plan's `aircraft`, or give the profile itself{meant}");
                problems.push(Problem::error("unknown-aircraft", message));
            }
            (None, Ok(profile)) => problems.extend(self.located(self.found_among_holes(profile))),
            (Some(checked), _) => {
                let found = checked.as_ref().map_or_else(Vec::as_slice, |program| &program.warnings);
                problems.extend(self.located(found.to_vec()));
            }
        }
        if self.converted {
            problems.iter_mut().for_each(|p| p.location = None);
        }
        problems
    }

    fn located(&self, mut found: Vec<Problem>) -> Vec<Problem> {
        self.reading.places.locate(&mut found);
        found
    }

    /// Errors in what could be read of a broken document, so that all can be mended at once. A number that could not be read is one of
    /// those that are told already.
    fn found_among_holes(&self, profile: &Profile) -> Vec<Problem> {
        let mut found = flight_plan::check(&self.reading.plan, profile, self.terrain.as_ref());
        found.retain(|problem| problem.is_error() && problem.code != "bad-value");
        found
    }

    /// The program, or what forbids it. `None`: a broken document gives a plan full of holes, and without an aircraft nothing is
    /// checked.
    fn checked(&self) -> Option<&Result<Arc<Program>, Vec<Problem>>> {
        let profile = self.profile.as_ref().ok().filter(|_| !self.reading.has_errors())?;
        let check = || {
            let plan = self.reading.plan.clone();
            flight_plan::compile(plan, profile, self.terrain.as_ref()).map(Arc::new)
        };
        Some(self.checked.get_or_init(check))
    }

    /// What is wrong with the path that would be flown; nothing if the plan has errors already.
    pub fn review(&self, conditions: Conditions) -> Vec<Problem> {
        self.with_program(|program, profile| review(program, profile, &self.terrain, conditions))
    }

    /// As [`Loaded::review`], with the remedies that have to be tried, and the problems at other values of variables; `progress`
    /// gets the number of flights done, and of all flights with other values.
    pub fn review_changes(
        &self,
        conditions: Conditions,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Vec<Problem> {
        let mut report_progress = |done, all| {
            progress(done, all);
            true
        };
        self.with_program(|program, profile| {
            let mut found = review(program, profile, &self.terrain, conditions);
            let remedied = leave_zones_out(program, profile, &self.terrain, conditions, &found, &mut || true);
            put_remedies(&mut found, remedied);
            let remedied =
                bring_within_glide(program, profile, &self.terrain, conditions, &found, &mut || true);
            put_remedies(&mut found, remedied);
            let more =
                review_extremes(program, profile, &self.terrain, conditions, &found, &mut report_progress);
            found.extend(more);
            found
        })
    }

    fn with_program(&self, find: impl FnOnce(&Arc<Program>, &Profile) -> Vec<Problem>) -> Vec<Problem> {
        let Ok((program, profile)) = self.compile() else { return Vec::new() };
        let mut found = find(&program, profile);
        if !self.converted {
            self.reading.places.locate(&mut found);
        }
        found
    }

    /// The errors that forbid flying the path.
    pub fn forbidden(&self, conditions: Conditions) -> Vec<Problem> {
        let mut found = self.review(conditions);
        found.retain(Problem::is_error);
        found
    }

    /// The plan ready to be flown, and its aircraft.
    ///
    /// # Errors
    /// All problems, if one of them forbids flying.
    pub fn compile(&self) -> Result<(Arc<Program>, &Profile), Vec<Problem>> {
        match (self.checked(), &self.profile) {
            (Some(Ok(program)), Ok(profile)) => Ok((program.clone(), profile)),
            _ => Err(self.problems()),
        }
    }
}

/// One of ours by its name, or that of a file.
fn profile(path: &Path) -> anyhow::Result<Profile> {
    let ours = path.to_str().and_then(|name| Profile::by_name(name).ok());
    ours.map_or_else(|| profile_from(path).with_context(|| not_ours(path)), Ok)
}

/// What else an aircraft can be that is no file.
fn not_ours(path: &Path) -> String {
    let (name, names) = (path.display().to_string(), Profile::names());
    let meant = did_you_mean(&name, names.iter().copied());
    format!("`{name}` is none of our aircraft ({}) and no profile{meant}", names.join(", "))
}

fn profile_from(path: &Path) -> anyhow::Result<Profile> {
    let json = String::from_utf8(read_at_most(path, 1_000_000)?)
        .context("the aircraft profile is not UTF-8 text")?;
    Profile::from_json(&json).with_context(|| path.display().to_string())
}

/// The first `limit` bytes at most, of a file or of standard input.
pub(super) fn read_at_most(path: &Path, limit: u64) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = match path.as_os_str() == DASH {
        true => std::io::stdin().lock().take(limit).read_to_end(&mut bytes),
        false => File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes)),
    };
    read.with_context(|| format!("can't read {}", path.display()))?;
    Ok(bytes)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A source that is a file of this text.
    pub(crate) fn source(text: &[u8]) -> (tempfile::NamedTempFile, Source) {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let source = Source { file: file.path().to_owned(), ..Source::default() };
        (file, source)
    }

    #[test]
    fn files_that_are_not_there_or_not_what_they_should_be() {
        let missing = Source { file: "no/such/plan.xml".into(), ..Source::default() };
        let error = missing.load().map(|_| ()).unwrap_err();
        assert!(format!("{error:#}").contains("no/such/plan.xml"), "{error:#}");

        let (file, good) = source(b"<flightPlan/>");
        let bad_tile = Source { terrain: vec![file.path().to_owned()], ..good.clone() };
        assert!(bad_tile.load().is_err(), "a plan is no elevation tile");
        let bad_aircraft = Source { aircraft: Some(file.path().to_owned()), ..good };
        assert!(bad_aircraft.load().is_err(), "a plan is no profile");
    }

    /// One was told, and the others when that was mended.
    #[test]
    fn all_that_is_wrong_with_a_broken_document_is_told_at_once() {
        let square = include_str!("../../../assets/plans/square.xml");
        let broken = square.replacen(r#"fix="B""#, r#"fix="BB""#, 1).replacen("\"110\"", "\"11O\"", 1);
        let (_file, source) = source(broken.as_bytes());
        let problems = source.load().unwrap().problems();
        let codes: Vec<_> = problems.iter().filter(|p| p.is_error()).map(|p| p.code).collect();
        assert_eq!(codes, ["bad-value", "unknown-fix"], "{problems:?}");
        assert!(problems.iter().all(|problem| problem.location.is_some()));
    }

    #[test]
    fn garbage_is_a_problem_and_never_compiles() {
        for garbage in
            [&b""[..], b"\xff\xfe\0\0", b"<a", b"<!DOCTYPE x [<!ENTITY a \"b\">]><x>&a;</x>", b"[]"]
        {
            let (_file, source) = source(garbage);
            let loaded = source.load().unwrap();
            assert!(loaded.problems().iter().any(Problem::is_error), "{garbage:?}");
            assert!(loaded.compile().is_err(), "{garbage:?}");
        }
        // what another program's file seems to be, and isn't, can't be read
        for garbage in
            [&b"{}"[..], b"{\"fileType\": \"Plan\"", b"QGC WPL 1\n", b"PK\x03\x04", b"<kml>", b"<gpx"]
        {
            let (_file, source) = source(garbage);
            assert!(source.load().is_err(), "{garbage:?}");
        }
    }

    #[test]
    fn a_missing_aircraft_is_told_once() {
        let codes = |text: &str| {
            let (_file, source) = source(text.as_bytes());
            source.load().unwrap().problems().iter().map(|p| p.code).collect::<Vec<_>>()
        };
        let plan = |aircraft: &str| {
            format!("<flightPlan xmlns=\"urn:legwork:flight-plan:1\" {aircraft}><mainPlan/></flightPlan>")
        };
        assert_eq!(codes(""), ["not-a-plan"]);
        assert_eq!(codes("<oops/>"), ["not-a-plan"]);
        assert_eq!(codes(&plan("")), ["missing-attribute"]);
        assert_eq!(codes(&plan("aircraft=\"zeppelin\"")), ["unknown-aircraft"]);
    }

    #[test]
    fn an_aircraft_is_chosen_by_name_and_a_misspelt_one_asked_for() {
        let plan =
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainr"><mainPlan/></flightPlan>"#;
        let (_file, source) = source(plan.as_bytes());
        let said = source.load().unwrap().problems().remove(0).message;
        assert!(said.ends_with("; did you mean `trainer`?"), "{said}");
        let with = |name: &str| Source { aircraft: Some(name.into()), ..source.clone() };
        assert_eq!(with("foam-wing").load().unwrap().profile.unwrap().name, "foam-wing");
        let error = with("foam-wnig").load().map(|_| ()).unwrap_err();
        assert!(format!("{error:#}").contains("did you mean `foam-wing`?"), "{error:#}");
    }

    #[test]
    fn a_file_of_another_program_is_read_for_the_aircraft_that_is_named() {
        let (_file, square) = source(b"QGC WPL 110\n1 0 3 16 0 0 0 0 36.3 -84.1 100 1\n");
        let loaded = Source { aircraft: Some("fast-wing".into()), ..square.clone() }.load().unwrap();
        assert_eq!(loaded.reading.plan.aircraft, "fast-wing");
        assert!(loaded.notes.iter().all(|note| note.code != "aircraft-assumed"), "{:?}", loaded.notes);
        let assumed = square.load().unwrap();
        let note = assumed.notes.iter().find(|note| note.code == "aircraft-assumed").unwrap();
        for name in Profile::names() {
            assert!(note.message.contains(name), "{note}");
        }
    }

    #[test]
    fn a_plan_of_another_program_has_notes_and_no_places() {
        let (_file, source) =
            source(b"QGC WPL 110\n1 0 3 16 0 0 0 0 36.3 -84.1 100 1\n2 0 3 211 0 0 0 0 0 0 0 1\n");
        let loaded = source.load().unwrap();
        assert!(
            loaded.notes.iter().any(|n| n.code == "command-not-carried" && n.place == "line 3"),
            "{:?}",
            loaded.notes
        );
        let problems = loaded.problems();
        assert!(!problems.is_empty() && problems.iter().all(|p| p.location.is_none()), "{problems:?}");
    }
}
