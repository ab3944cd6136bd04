//! Frames that wait to be sent, one behind the other in one buffer.

/// Frames to be sent. The buffer is used again, so that a frame costs no allocation.
#[derive(Debug, Clone, Default)]
pub struct Outbox {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Outbox {
    /// Adds a frame: `write` appends its bytes, and nothing else may be done to the buffer.
    pub fn push(&mut self, write: impl FnOnce(&mut Vec<u8>)) {
        write(&mut self.bytes);
        self.ends.push(self.bytes.len());
    }

    /// The frames, first to last.
    pub fn frames(&self) -> impl Iterator<Item = &[u8]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).filter_map(|(start, end)| self.bytes.get(start..*end))
    }

    /// Nothing waits.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Everything was sent.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.ends.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_out_as_they_went_in() {
        let mut outbox = Outbox::default();
        for _ in 0..2 {
            assert!(outbox.is_empty());
            for frame in [&[1_u8, 2][..], &[], &[3]] {
                outbox.push(|bytes| bytes.extend_from_slice(frame));
            }
            assert_eq!(outbox.frames().collect::<Vec<_>>(), [&[1_u8, 2][..], &[], &[3]]);
            outbox.clear();
        }
    }
}
