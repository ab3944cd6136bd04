//! A disk that takes nothing more, and a folder in which nothing may be written: nothing is lost, and it is said what to do.

use super::filing::{name, until_listed, window_on};
use super::recovering::window_in;
use super::{SQUARE, Window};
use egui::Key;
use gcs_app::files::{Disk, Stamp};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// The machine's disk, as long as nothing is wrong with it.
#[derive(Default)]
struct Failing(Mutex<Option<ErrorKind>>);

impl Failing {
    fn set(&self, fault: Option<ErrorKind>) {
        *self.0.lock().unwrap() = fault;
    }
}

struct Machine;
impl Disk for Machine {
    fn length(&self, path: &Path) -> io::Result<Option<u64>> {
        Ok(Some(path.metadata()?.len()))
    }
    fn open(&self, path: &Path) -> io::Result<Box<dyn Read>> {
        Ok(Box::new(File::open(path)?))
    }
}

impl Disk for Failing {
    fn length(&self, path: &Path) -> io::Result<Option<u64>> {
        Machine.length(path)
    }
    fn open(&self, path: &Path) -> io::Result<Box<dyn Read>> {
        Machine.open(path)
    }
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<Option<Stamp>> {
        match *self.0.lock().unwrap() {
            Some(fault) => Err(fault.into()),
            None => Machine.write(path, bytes),
        }
    }
}

/// The square in a file, on a disk that can be told to fail.
fn on_failing_disk(path: &Path) -> (Window, Arc<Failing>) {
    let mut window = window_on(path, SQUARE);
    let disk = Arc::<Failing>::default();
    window.harness.state_mut().use_disk(disk.clone());
    (window, disk)
}

fn says(window: &mut Window, words: &'static str) {
    window.until(words, |app| app.view().notice.as_ref().is_some_and(|why| why.contains(words)));
    assert!(window.shows(words));
}

const FAULTS: [(ErrorKind, &str); 2] = [
    (ErrorKind::StorageFull, "the disk is full. Make room there and save again, or save it elsewhere"),
    (ErrorKind::PermissionDenied, "nothing may be written in this folder. Save it elsewhere"),
];

#[test]
fn a_plan_that_cannot_be_saved_stays_as_it_is_until_it_can() {
    for (fault, words) in FAULTS {
        let (folder, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let path = folder.path().join("plan.xml");
        let (mut window, disk) = on_failing_disk(&path);
        window.keep_copies(home.path());
        window.click("TF side2");
        window.press(Key::Delete);
        disk.set(Some(fault));
        for _ in 0..2 {
            window.press_ctrl(Key::S);
            says(&mut window, words);
        }
        assert!(window.app().document().is_dirty() && window.app().document().path() == Some(&path));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), SQUARE, "the old file");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
        // with room again the same key saves it
        disk.set(None);
        window.press_ctrl(Key::S);
        window.until("saved", |app| !app.document().is_dirty());
        assert!(!window.shows(words) && window.shows("Saved "));
        assert_eq!(flight_plan::read(std::fs::read(&path).unwrap()).plan, window.plan());
    }
}

#[test]
fn a_plan_that_could_not_be_saved_is_recovered_after_a_crash() {
    for (fault, words) in FAULTS {
        let (folder, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let path = folder.path().join("plan.xml");
        let (mut window, disk) = on_failing_disk(&path);
        window.keep_copies(home.path());
        disk.set(Some(fault));
        window.click("TF side2");
        window.press(Key::Delete);
        window.press_ctrl(Key::S);
        says(&mut window, words);
        // an edit after it is kept, too
        window.click("TF side3");
        window.press(Key::Delete);
        window.steps(200);
        let lost = window.plan();
        drop(window);
        let mut next = window_in(home.path(), "");
        assert!(next.shows("ended without saving"));
        next.press(Key::Enter);
        assert_eq!(next.plan(), lost);
    }
}

#[test]
fn a_new_plan_that_cannot_be_saved_there_is_saved_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = super::filing::window(SQUARE);
    let disk = Arc::<Failing>::default();
    window.harness.state_mut().use_disk(disk.clone());
    window.click("TF side2");
    window.press(Key::Delete);
    for (fault, words) in FAULTS {
        disk.set(Some(fault));
        window.press_ctrl(Key::S);
        until_listed(&mut window);
        name(&mut window, &folder.path().join("mine.xml"));
        window.click("Save here");
        says(&mut window, words);
        assert!(window.app().document().path().is_none() && window.app().document().is_dirty());
    }
    disk.set(None);
    window.press_ctrl(Key::S);
    until_listed(&mut window);
    name(&mut window, &folder.path().join("mine.xml"));
    window.click("Save here");
    window.until("saved", |app| app.document().path().is_some() && !app.document().is_dirty());
}
