//! The maps and elevations that users bring, and the servers of map tiles that they name: which there are, in which order,
//! and what became of each. They are opened on threads of their own.

mod at_hand;
mod lazy;
mod open;
mod rasters;

pub use open::tiles_in;

use crate::jobs::Jobs;
use crate::tiles::{About, Folder, Health, Reader, Template};
use at_hand::AtHand;
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use terrain::{Stack, Terrain};

/// So many are taken.
const MOST: usize = 50;

/// What is asked of the layers.
#[derive(Debug, Clone)]
pub enum LayerCommand {
    /// Add a file, a folder or a server, above all others.
    Add(Source),
    /// Ask for a file, or for a folder.
    Ask {
        /// A folder of elevation tiles.
        folder: bool,
    },
    /// Forget one; its file stays.
    Remove(u64),
    /// Use it, or leave it out.
    Show(u64, bool),
    /// How opaque a map is, 0..=1.
    Opacity(u64, f32),
    /// Put it above the one that is above it.
    Raise(u64),
    /// Show where it is.
    GoTo(u64),
}

/// A map, or elevations.
#[derive(Debug)]
pub struct Layer {
    /// Its number in this window.
    pub id: u64,
    /// What is remembered of it.
    pub kept: Kept,
    /// What became of it.
    pub state: State,
    /// The work of opening it.
    job: u64,
}

/// Where a layer comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Source {
    /// A file or folder.
    File(PathBuf),
    /// A server of map tiles.
    Online(Server),
}

impl Source {
    /// What people call it: the file's or the server's name.
    fn name(&self) -> String {
        match self {
            Self::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
            Self::Online(server) => Template::new(&server.url)
                .map_or_else(|_| server.url.clone(), |template| template.host().to_owned()),
        }
    }
}

/// A server of map tiles.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Server {
    /// The address of a tile, with `{z}`, `{x}` and `{y}` for its numbers.
    pub url: String,
    /// Whom the map has to name.
    pub attribution: String,
}

impl Server {
    /// The one that anybody may use who names it, keeps what it gave and asks for no more than is looked at.
    pub fn openstreetmap() -> Self {
        Self {
            url: "https://tile.openstreetmap.org/{z}/{x}/{y}.png".into(),
            attribution: "© OpenStreetMap contributors".into(),
        }
    }
}

/// What is remembered of a layer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    /// Where it comes from.
    pub source: Source,
    /// It is in use.
    pub shown: bool,
    /// How opaque a map is, 0..=1.
    pub opacity: f32,
}

/// What became of a layer.
pub enum State {
    /// It is being opened.
    Opening,
    /// Tiles of a map.
    Map(About, Arc<Health>),
    /// Elevations, and what there is to say of them.
    Ground {
        /// The elevations.
        terrain: Arc<dyn Terrain>,
        /// South-west and north-east corner.
        bounds: Option<(LatLon, LatLon)>,
        /// In a few words.
        detail: String,
    },
    /// Nothing can be made of it: why, and what to do.
    Failed(String),
}

impl std::fmt::Debug for State {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Opening => "Opening",
            Self::Map(..) => "Map",
            Self::Ground { .. } => "Ground",
            Self::Failed(_) => "Failed",
        })
    }
}

impl Layer {
    /// What it is called.
    pub fn name(&self) -> String {
        self.kept.source.name()
    }

    /// All of where it comes from.
    pub fn origin(&self) -> String {
        match &self.kept.source {
            Source::File(path) => path.display().to_string(),
            Source::Online(server) => server.url.clone(),
        }
    }

    /// South-west and north-east corner, where they are known.
    pub fn bounds(&self) -> Option<(LatLon, LatLon)> {
        match &self.state {
            State::Map(about, _) => about.bounds,
            State::Ground { bounds, .. } => *bounds,
            State::Opening | State::Failed(_) => None,
        }
    }
}

/// A file that begins like this is a map or elevations.
pub fn is_map(path: &Path, head: &[u8]) -> bool {
    open::kind(path, head).is_some()
}

/// What a file or server turned out to be.
enum Content {
    Map { readers: Vec<Box<dyn Reader>>, about: About, health: Arc<Health> },
    Ground { terrain: Arc<dyn Terrain>, bounds: Option<(LatLon, LatLon)>, detail: String },
}

/// A map whose tiles can be read from now on.
pub struct Opened {
    /// Which layer.
    pub id: u64,
    /// Read its tiles.
    pub readers: Vec<Box<dyn Reader>>,
    /// What it says of itself.
    pub about: About,
    /// How it does.
    pub health: Arc<Health>,
}

/// All layers, the uppermost first.
pub struct Layers {
    list: Vec<Layer>,
    next: u64,
    /// Below all of them.
    shipped: Arc<dyn Terrain>,
    elevations: Arc<dyn Terrain>,
    ground: Arc<dyn Terrain>,
    ground_changed: bool,
    jobs: Jobs,
    outbox: Sender<(u64, Result<Content, String>)>,
    inbox: Receiver<(u64, Result<Content, String>)>,
    wake: Arc<dyn Fn() + Send + Sync>,
    tiles: Folder,
}

impl std::fmt::Debug for Layers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(&self.list).finish()
    }
}

impl Layers {
    /// The layers of an earlier window, over the shipped elevations; `wake` is called when something was opened.
    pub fn new(shipped: Arc<dyn Terrain>, kept: Vec<Kept>, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let (outbox, inbox) = channel();
        let elevations = shipped.clone();
        let ground = Arc::new(AtHand::of(shipped.clone(), wake.clone()));
        let mut layers = Self {
            list: Vec::new(),
            next: 0,
            shipped,
            elevations,
            ground,
            ground_changed: false,
            jobs: Jobs::default(),
            outbox,
            inbox,
            wake,
            tiles: Folder::default(),
        };
        for kept in kept.into_iter().take(MOST).rev() {
            layers.put(kept);
        }
        layers
    }

    /// Wakes the window, for whoever does work in the background with what is here.
    pub fn wake(&self) -> Arc<dyn Fn() + Send + Sync> {
        self.wake.clone()
    }

    /// Keeps the tiles of servers in this folder from now on.
    pub fn keep_tiles_in(&self, folder: &Path) {
        // the first one stays
        let _ = self.tiles.set(folder.to_owned());
    }

    /// The uppermost first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Layer> {
        self.list.iter()
    }

    /// What there is to remember, the uppermost first.
    pub fn kept(&self) -> Vec<Kept> {
        self.list.iter().map(|layer| layer.kept.clone()).collect()
    }

    /// The elevations in use, what users brought, the uppermost first, then what is shipped: for the window's own thread, which can't
    /// wait. What has to be read from a disk first is unknown until then, and the window is woken.
    pub fn ground(&self) -> &Arc<dyn Terrain> {
        &self.ground
    }

    /// The same for other threads: who asks may have to wait for a disk.
    pub fn elevations(&self) -> &Arc<dyn Terrain> {
        &self.elevations
    }

    /// True once after the elevations in use have changed.
    pub fn take_ground_changed(&mut self) -> bool {
        std::mem::take(&mut self.ground_changed)
    }

    /// Whom the map has to name, and whether that server can't be reached.
    pub fn attributions(&self) -> impl Iterator<Item = String> {
        let shown = self.list.iter().filter(|layer| layer.kept.shown);
        shown.filter_map(|layer| match &layer.state {
            State::Map(about, health) if !about.attribution.is_empty() => {
                let offline = if health.is_offline() { " (offline)" } else { "" };
                Some(format!("{}{offline}", about.attribution))
            }
            _ => None,
        })
    }

    /// Adds a file, folder or server above all others; one that is there already is opened again.
    ///
    /// # Errors
    /// There are too many.
    pub fn add(&mut self, source: Source) -> Result<(), String> {
        let source = match source {
            // a relative path means something else in the next run
            Source::File(path) => Source::File(std::path::absolute(&path).unwrap_or(path)),
            Source::Online(server) => Source::Online(server),
        };
        let same = self.list.iter().position(|layer| layer.kept.source == source);
        let kept = same.map(|at| self.list.remove(at).kept);
        if self.list.len() >= MOST {
            return Err(format!("There are {MOST} maps already: remove one first."));
        }
        self.put(Kept { shown: true, ..kept.unwrap_or(Kept { source, shown: true, opacity: 1.0 }) });
        self.renew_ground();
        Ok(())
    }

    fn put(&mut self, kept: Kept) {
        self.next += 1;
        let (id, source, tiles) = (self.next, kept.source.clone(), self.tiles.clone());
        let running = self.jobs.begin(format!("Loading {}", kept.source.name()));
        self.list.insert(0, Layer { id, kept, state: State::Opening, job: running.id() });
        let (outbox, wake) = (self.outbox.clone(), self.wake.clone());
        let work = move || {
            // the window may be gone by then
            let _ = outbox.send((id, open::open(&source, tiles, running.progress())));
            wake();
        };
        if let Err(error) = std::thread::Builder::new().name("maps".into()).spawn(work) {
            tracing::warn!(%error, "no thread to open a map");
        }
    }

    /// What is being opened.
    pub fn jobs(&self) -> &Jobs {
        &self.jobs
    }

    /// Forgets work that has ended. True: something is still being opened.
    pub fn tend(&mut self, now_s: f64) -> bool {
        self.jobs.tend(now_s)
    }

    /// What is opened by this work is not wanted.
    pub fn cancel(&mut self, job: u64) {
        self.jobs.cancel(job);
        self.list.retain(|layer| layer.job != job || !matches!(layer.state, State::Opening));
    }

    /// A change that needs nothing but the list.
    pub fn change(&mut self, command: &LayerCommand) {
        let at = |id: &u64| self.list.iter().position(|layer| layer.id == *id);
        match command {
            LayerCommand::Remove(id) => drop(at(id).map(|at| self.list.remove(at))),
            LayerCommand::Raise(id) => {
                if let Some(at) = at(id).filter(|at| *at > 0) {
                    self.list.swap(at, at - 1);
                }
            }
            LayerCommand::Show(id, shown) => self.with(*id, |kept| kept.shown = *shown),
            LayerCommand::Opacity(id, opacity) => self.with(*id, |kept| kept.opacity = *opacity),
            LayerCommand::Add(_) | LayerCommand::Ask { .. } | LayerCommand::GoTo(_) => return,
        }
        if !matches!(command, LayerCommand::Opacity(..)) {
            self.renew_ground();
        }
    }

    fn with(&mut self, id: u64, change: impl FnOnce(&mut Kept)) {
        if let Some(layer) = self.list.iter_mut().find(|layer| layer.id == id) {
            change(&mut layer.kept);
        }
    }

    /// What was opened since: maps whose tiles are to be shown, or a sentence about one that can't be.
    pub fn opened(&mut self) -> Option<Result<Opened, String>> {
        loop {
            let (id, content) = self.inbox.try_recv().ok()?;
            // it may have been removed meanwhile
            let Some(layer) = self.list.iter_mut().find(|layer| layer.id == id) else { continue };
            match content {
                Ok(Content::Map { readers, about, health }) => {
                    layer.state = State::Map(about.clone(), health.clone());
                    return Some(Ok(Opened { id, readers, about, health }));
                }
                Ok(Content::Ground { terrain, bounds, detail }) => {
                    layer.state = State::Ground { terrain, bounds, detail };
                    self.renew_ground();
                }
                Err(why) => {
                    let sentence = format!("{} is not used: {why}.", layer.origin());
                    layer.state = State::Failed(why);
                    return Some(Err(sentence));
                }
            }
        }
    }

    fn renew_ground(&mut self) {
        let shown = self.list.iter().filter(|layer| layer.kept.shown);
        let mut grounds: Vec<Arc<dyn Terrain>> = shown
            .filter_map(|layer| match &layer.state {
                State::Ground { terrain, .. } => Some(terrain.clone()),
                _ => None,
            })
            .collect();
        grounds.push(self.shipped.clone());
        let elevations: Arc<dyn Terrain> =
            if grounds.len() == 1 { self.shipped.clone() } else { Arc::new(Stack(grounds)) };
        // without elevations of the user's the shipped ones stay what they are
        if !Arc::ptr_eq(&elevations, &self.elevations) {
            self.ground = Arc::new(AtHand::of(elevations.clone(), self.wake.clone()));
            self.elevations = elevations;
            self.ground_changed = true;
        }
    }
}
