//! The files that were open last.

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// So many are remembered.
const MOST: usize = 10;

/// The files that were open last, the newest first.
#[derive(Debug, Default, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Recent(Vec<PathBuf>);

impl Recent {
    /// A file was opened or saved.
    pub fn add(&mut self, path: &Path) {
        // a relative path means something else in the next run
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.0.retain(|other| *other != path);
        self.0.insert(0, path);
        self.0.truncate(MOST);
    }

    /// The newest first.
    pub fn paths(&self) -> &[PathBuf] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newest_ten_are_kept_each_once() {
        let mut recent = Recent::default();
        for n in (0..12).chain([5]) {
            recent.add(Path::new(&format!("/plans/{n}.xml")));
        }
        let first = Path::new("/plans/5.xml");
        assert_eq!(recent.paths().len(), MOST);
        assert_eq!(recent.paths().first().map(PathBuf::as_path), Some(first));
        assert_eq!(recent.paths().iter().filter(|p| *p == first).count(), 1);
    }
}
