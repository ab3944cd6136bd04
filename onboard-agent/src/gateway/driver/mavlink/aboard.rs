//! The autopilot's list as it is known to be.

use super::mission::{Entry, Outcome};

/// The list. See the module's text.
#[derive(Debug, Clone, Default)]
pub struct Aboard {
    entries: Vec<Entry>,
    /// What it will be when what is being written is verified.
    written: Option<Vec<Entry>>,
}

impl Aboard {
    /// The whole list, as it was last verified or read.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// These are being written in its place.
    pub fn replace(&mut self, entries: &[Entry]) {
        self.written = Some(entries.to_vec());
    }

    /// These are being written over those of the same numbers.
    pub fn overwrite(&mut self, entries: &[Entry]) {
        let mut written = self.entries.clone();
        for entry in entries {
            let (at, end) = (usize::from(entry.seq), written.len());
            match written.get_mut(at) {
                Some(there) => *there = entry.clone(),
                None if at == end => written.push(entry.clone()),
                // the list was never read as a whole
                None => {}
            }
        }
        self.written = Some(written);
    }

    /// What was being done ended.
    pub fn ended(&mut self, outcome: &Outcome) {
        let written = self.written.take();
        match outcome {
            Outcome::Verified => self.entries = written.unwrap_or_default(),
            Outcome::List(entries) => self.entries.clone_from(entries),
            Outcome::Failed(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(seqs: std::ops::Range<u16>, z: f32) -> Vec<Entry> {
        seqs.map(|seq| Entry { seq, z, ..Entry::DEFAULT }).collect()
    }

    #[test]
    fn only_what_was_verified_is_aboard() {
        let mut aboard = Aboard::default();
        aboard.replace(&entries(0..4, 1.0));
        assert_eq!(aboard.entries(), []);
        aboard.ended(&Outcome::Verified);
        assert_eq!(aboard.entries(), entries(0..4, 1.0));
        aboard.overwrite(&entries(2..4, 9.0));
        aboard.ended(&Outcome::Failed("no answer".into()));
        assert_eq!(aboard.entries(), entries(0..4, 1.0));
        aboard.overwrite(&entries(3..5, 2.0));
        aboard.ended(&Outcome::Verified);
        assert_eq!(aboard.entries(), [entries(0..3, 1.0), entries(3..5, 2.0)].concat());
        aboard.ended(&Outcome::List(entries(0..1, 5.0)));
        assert_eq!(aboard.entries(), entries(0..1, 5.0));
    }
}
