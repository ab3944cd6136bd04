//! Pure: the configuration file. It is TOML, with the options' names and `_` for `-`; JSON is read as well. Every mistake is
//! told, with its line and column.

use super::{Options, settings};
use std::fmt;
use std::ops::Range;
use toml::de::{DeTable, DeValue, Deserializer};
use toml::{Spanned, de};

/// More mistakes are counted, not told.
const TOLD_MAX: usize = 20;
/// Names that are at least so much alike are offered.
const ALIKE: f64 = 0.75;

/// Something that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistake {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong, and what to do.
    pub what: String,
}

/// All that is wrong with a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistakes {
    /// The file's name, for people.
    pub name: String,
    /// Sorted by their place.
    pub mistakes: Vec<Mistake>,
}

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, Mistake { line, column, what }) in self.mistakes.iter().take(TOLD_MAX).enumerate() {
            let end = if at == 0 { "" } else { "\n" };
            write!(f, "{end}{}:{line}:{column}: {what}", self.name)?;
        }
        match self.mistakes.len().saturating_sub(TOLD_MAX) {
            0 => Ok(()),
            more => write!(f, "\nand {more} more"),
        }
    }
}

impl std::error::Error for Mistakes {}

/// The options that a TOML file sets.
///
/// # Errors
/// It is no TOML, sets what is unknown, or to what can't be.
pub fn parse(name: &str, text: &str) -> Result<Options, Mistakes> {
    File::read(name, text).map(|file| file.options)
}

/// As [`parse`]; then the mistakes that `check` finds in the options together. It tells one at a time, which begins with the
/// option's name (`--aircraft`); that option is left out, and the rest is looked at again.
///
/// # Errors
/// As [`parse`], and what `check` finds.
pub fn parse_and_check(
    name: &str,
    text: &str,
    check: impl Fn(&Options) -> anyhow::Result<()>,
) -> Result<Options, Mistakes> {
    let mut file = File::read(name, text)?;
    let (whole, mut mistakes) = (file.options.clone(), vec![]);
    while let Err(error) = check(&file.options) {
        let what = format!("{error:#}");
        let culprit = culprit(&what);
        let span = culprit.as_deref().and_then(|key| file.leave_out(key));
        let found = span.is_some();
        mistakes.push(mistake(text, span.unwrap_or(0..0), what));
        if !found {
            break;
        }
    }
    told(name, mistakes).map(|()| whole)
}

struct File<'t> {
    table: DeTable<'t>,
    options: Options,
}

impl<'t> File<'t> {
    fn read(name: &str, text: &'t str) -> Result<Self, Mistakes> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let table = table.into_inner();
        let mut mistakes: Vec<Mistake> = errors.iter().map(|error| wrong(text, error, 0..0)).collect();
        for (key, value) in &table {
            let what = if settings().any(|known| known == **key.get_ref()) {
                set(key, value).err().map(|error| wrong(text, &error, value.span()))
            } else {
                Some(mistake(text, key.span(), unknown(key.get_ref())))
            };
            mistakes.extend(what);
        }
        told(name, mistakes)?;
        let options = all(&table)
            .map_err(|error| Mistakes { name: name.to_owned(), mistakes: vec![wrong(text, &error, 0..0)] })?;
        Ok(Self { table, options })
    }

    /// Where an option stands that now is as if it had not been set.
    fn leave_out(&mut self, key: &str) -> Option<Range<usize>> {
        let value = self.table.remove(key)?;
        self.options = all(&self.table).ok()?;
        Some(value.span())
    }
}

fn all(table: &DeTable<'_>) -> Result<Options, de::Error> {
    serde::Deserialize::deserialize(Deserializer::from(Spanned::new(0..0, table.clone())))
}

/// One by itself, so that each mistake is found.
fn set<'t>(key: &Spanned<de::DeString<'t>>, value: &Spanned<DeValue<'t>>) -> Result<Options, de::Error> {
    all(&DeTable::from_iter([(key.clone(), value.clone())]))
}

fn unknown(key: &str) -> String {
    let alike = |known: &String| strsim::jaro_winkler(known, &key.replace('-', "_").to_lowercase());
    let best = settings().max_by(|a, b| alike(a).total_cmp(&alike(b))).filter(|best| alike(best) >= ALIKE);
    match best {
        Some(best) => format!("`{key}` is unknown; is `{best}` meant?"),
        None => format!("`{key}` is unknown; `onboard-agent run --help` lists the options"),
    }
}

/// `--state-dir nowhere: …` is about `state_dir`.
fn culprit(what: &str) -> Option<String> {
    let name = what.strip_prefix("--")?.split([' ', ':']).next()?;
    Some(name.replace('-', "_"))
}

fn wrong(text: &str, error: &de::Error, otherwise: Range<usize>) -> Mistake {
    mistake(
        text,
        error.span().filter(|span| !span.is_empty()).unwrap_or(otherwise),
        error.message().to_owned(),
    )
}

fn mistake(text: &str, span: Range<usize>, what: String) -> Mistake {
    let before = text.get(..span.start).unwrap_or(text);
    let line_begins = before.rfind('\n').map_or(0, |at| at + 1);
    let line = before.matches('\n').count() + 1;
    let column = before.get(line_begins..).unwrap_or_default().chars().count() + 1;
    Mistake { line, column, what }
}

fn told(name: &str, mut mistakes: Vec<Mistake>) -> Result<(), Mistakes> {
    mistakes.sort_by_key(|mistake| (mistake.line, mistake.column));
    if mistakes.is_empty() { Ok(()) } else { Err(Mistakes { name: name.to_owned(), mistakes }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn options_are_read_with_their_comments_left_out() {
        let text = "# ours\nvehicle = \"v\" # its name\nterrain = ['a.hgt', 'b.hgt']\nrecord_quota_mib = 9\nsimulated = true\n";
        let options = parse("agent.toml", text).unwrap();
        assert_eq!(options.vehicle.as_deref(), Some("v"));
        assert_eq!(options.terrain, [Path::new("a.hgt"), Path::new("b.hgt")]);
        assert_eq!((options.record_quota_mib, options.simulated), (Some(9), Some(true)));
        assert_eq!(parse("agent.toml", "").unwrap(), Options::default());
    }

    #[test]
    fn every_mistake_is_told_with_its_line_and_column_and_near_names() {
        let text = "vehikle = 'v'\nlisten = 7447\n  state-dir = 'x'\nrecord_quota_mib = 'much'\nwhatever = 1\nautopilot = 'udp:127.0.0.1:1'\n";
        let told = parse("agent.toml", text).unwrap_err().to_string();
        let lines: Vec<&str> = told.lines().collect();
        for (line, begins, says) in [
            (0, "agent.toml:1:1: ", "`vehicle`"),
            (1, "agent.toml:2:10: ", "string"),
            (2, "agent.toml:3:3: ", "`state_dir`"),
            (3, "agent.toml:4:20: ", "u64"),
            (4, "agent.toml:5:1: ", "--help"),
        ] {
            assert!(lines[line].starts_with(begins) && lines[line].contains(says), "{told}");
        }
        assert_eq!(lines.len(), 5, "{told}");
    }

    #[test]
    fn what_is_no_toml_is_told_with_its_place_and_never_without_end() {
        for (text, begins) in [
            ("vehicle = \"v\nlisten = 'x'\n", "agent.toml:1:"),
            ("vehicle = 'a'\nvehicle = 'b'\n", "agent.toml:2:1: "),
            ("{\"vehicle\": \"v\"}", "agent.toml:1:1: "),
            ("[gateway]\nlisten = 'x'\n", "agent.toml:1:"),
        ] {
            let told = parse("agent.toml", text).unwrap_err().to_string();
            assert!(told.starts_with(begins), "{text}: {told}");
        }
        let many: String = (0..1000).map(|n| format!("x{n} = 1\n")).collect();
        let told = parse("agent.toml", &many).unwrap_err().to_string();
        assert!(told.ends_with("and 980 more"), "{told}");
        let _ = parse("agent.toml", &"[".repeat(100_000));
    }

    #[test]
    fn values_that_cannot_be_used_are_all_found_at_their_places() {
        let text = "aircraft = 'zeppelin'\nvehicle = 'v'\ndriver = 'pigeon'\n";
        let check = |options: &Options| {
            let wrong = [("--aircraft", &options.aircraft), ("--driver", &options.driver)];
            match wrong.into_iter().find_map(|(name, value)| Some((name, value.as_ref()?))) {
                Some((name, value)) => Err(anyhow::anyhow!("{name} {value}: can't be")),
                None => Ok(()),
            }
        };
        let told = parse_and_check("agent.toml", text, check).unwrap_err().to_string();
        assert_eq!(
            told,
            "agent.toml:1:12: --aircraft zeppelin: can't be\nagent.toml:3:10: --driver pigeon: can't be"
        );
        let vague = parse_and_check("agent.toml", text, |_| Err(anyhow::anyhow!("no"))).unwrap_err();
        assert_eq!(vague.to_string(), "agent.toml:1:1: no");
        let whole = parse_and_check("agent.toml", text, |_| Ok(())).unwrap();
        assert_eq!(whole.aircraft.as_deref(), Some("zeppelin"));
    }
}
