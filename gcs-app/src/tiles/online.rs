//! Tiles from a server: asked for as they are looked at, kept on the disk, and shown from there without a network.

mod cache;
mod fetch;

use super::picture::{self, MAX_BYTES};
use super::{About, Answer, Health, Reader, TileId, Wanted};
use cache::{Cache, Stored};
use fetch::{Fetched, Fetcher, Trouble};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// So many tiles are asked for at a time: servers that anybody may use ask for no more.
const PARALLEL: usize = 2;
/// Deepest level that is asked for.
const DEEPEST: u8 = 19;
/// Longest address, bytes.
const LONGEST: usize = 2000;
/// The pause after a failure; each further one doubles it.
const PAUSE: Duration = Duration::from_secs(4);
/// The longest pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(300);

/// Where tiles are kept, as soon as it is known.
pub type Folder = Arc<OnceLock<PathBuf>>;

/// The address of a server's tiles, with places for their numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Template(String);

impl Template {
    /// `https://tile.example.org/{z}/{x}/{y}.png`
    ///
    /// # Errors
    /// What is wrong with it, and what to write.
    pub fn new(text: &str) -> Result<Self, String> {
        let template = Self(text.trim().to_owned());
        if template.0.len() > LONGEST {
            return Err("the address is too long".into());
        }
        if let Some(missing) = ["{z}", "{x}", "{y}"].into_iter().find(|place| !template.0.contains(place)) {
            return Err(format!(
                "the address has no {missing}: write it as https://server/{{z}}/{{x}}/{{y}}.png"
            ));
        }
        let url = template.of(TileId { zoom: 0, x: 0, y: 0 });
        if url.contains(['{', '}']) {
            return Err("the address may have {z}, {x} and {y} only: write one server's name in it".into());
        }
        fetch::check(&url).map(|()| template)
    }

    /// The server's name.
    pub fn host(&self) -> &str {
        let behind = self.0.split_once("://").map_or(self.0.as_str(), |(_, behind)| behind);
        behind.split(['/', '?']).next().unwrap_or(behind)
    }

    fn of(&self, tile: TileId) -> String {
        let numbers = [("{z}", u32::from(tile.zoom)), ("{x}", tile.x), ("{y}", tile.y)];
        numbers
            .into_iter()
            .fold(self.0.clone(), |url, (place, number)| url.replace(place, &number.to_string()))
    }
}

/// Reads tiles of a server, from the disk where they are there.
pub struct Online(Arc<Server>);

struct Server {
    template: Template,
    cache: Cache,
    fetcher: Fetcher,
    pause: Mutex<Pause>,
    health: Arc<Health>,
}

impl Online {
    /// The readers of a server's tiles; nothing is asked for yet.
    ///
    /// # Errors
    /// A sentence: this machine can't do it.
    pub fn open(template: Template, folder: Folder, health: &Arc<Health>) -> Result<Vec<Self>, String> {
        let server = Arc::new(Server {
            fetcher: Fetcher::new(template.host())?,
            cache: Cache::new(folder, &template.0),
            template,
            pause: Mutex::default(),
            health: health.clone(),
        });
        Ok((0..PARALLEL).map(|_| Self(server.clone())).collect())
    }

    /// What such a server is known to have.
    pub fn about(attribution: &str) -> About {
        About { zooms: 0..=DEEPEST, attribution: attribution.to_owned(), ..About::default() }
    }
}

impl Reader for Online {
    fn read(&mut self, wanted: Wanted) -> Answer {
        self.0.read(wanted.tile)
    }
}

impl Server {
    fn read(&self, tile: TileId) -> Answer {
        let now_s = cache::now_s();
        let kept = self.cache.get(tile);
        if let Some(kept) = kept.as_ref().filter(|kept| kept.is_fresh(now_s)) {
            return answer(kept);
        }
        if self.pause().is_on(Instant::now()) {
            return kept.as_ref().map_or(Answer::Later, answer);
        }
        let tag = kept.as_ref().map_or("", |kept| kept.tag.as_str());
        match self.fetcher.fetch(&self.template.of(tile), tag) {
            Ok(fetched) => {
                self.pause().end();
                self.health.set_offline(false);
                self.take(tile, fetched, kept, now_s)
            }
            Err(trouble) => {
                self.pause().begin(Instant::now(), &trouble);
                self.health.set_offline(true);
                tracing::debug!(host = self.template.host(), why = trouble.why, "no tile from the server");
                kept.as_ref().map_or(Answer::Later, answer)
            }
        }
    }

    fn take(&self, tile: TileId, fetched: Fetched, kept: Option<Stored>, now_s: u64) -> Answer {
        let new = match (fetched, kept) {
            (Fetched::Tile { bytes, tag, lifetime_s }, _) => {
                Stored { fetched_s: now_s, lifetime_s, tag, bytes }
            }
            (Fetched::Same { lifetime_s }, Some(kept)) => Stored { fetched_s: now_s, lifetime_s, ..kept },
            (Fetched::Same { .. }, None) => return Answer::Later,
            (Fetched::TooLarge, _) => return Answer::Unreadable,
        };
        let answer = answer(&new);
        if !matches!(answer, Answer::Unreadable) {
            self.cache.put(tile, &new);
        }
        answer
    }

    fn pause(&self) -> std::sync::MutexGuard<'_, Pause> {
        self.pause.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// An empty tile stands for one that the server does not have.
fn answer(stored: &Stored) -> Answer {
    if stored.bytes.is_empty() {
        return Answer::Nothing;
    }
    picture::decode(&stored.bytes).map_or(Answer::Unreadable, Answer::Picture)
}

/// After a failure nothing is asked for a while.
#[derive(Debug, Default)]
struct Pause {
    failures: u32,
    until: Option<Instant>,
}

impl Pause {
    fn is_on(&self, now: Instant) -> bool {
        self.until.is_some_and(|until| now < until)
    }

    fn begin(&mut self, now: Instant, trouble: &Trouble) {
        let doubled = PAUSE.saturating_mul(1 << self.failures.min(10));
        self.until = now.checked_add(doubled.max(trouble.asked).min(LONGEST_PAUSE));
        self.failures = self.failures.saturating_add(1);
    }

    fn end(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests;
