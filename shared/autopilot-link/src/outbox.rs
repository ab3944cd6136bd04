//! Frames that wait to be sent, one behind the other in one buffer.

/// Frames to be sent, each over one of the links. The buffer is used again, so that a frame costs no allocation.
#[derive(Debug, Clone, Default)]
pub struct Outbox {
    bytes: Vec<u8>,
    /// Where each ends, and the link's number.
    ends: Vec<(usize, usize)>,
}

impl Outbox {
    /// Adds a frame for the first link: `write` appends its bytes, and nothing else may be done to the buffer.
    pub fn push(&mut self, write: impl FnOnce(&mut Vec<u8>)) {
        self.push_over(0, write);
    }

    /// Adds a frame for a link, by its number.
    pub fn push_over(&mut self, link: usize, write: impl FnOnce(&mut Vec<u8>)) {
        write(&mut self.bytes);
        self.ends.push((self.bytes.len(), link));
    }

    /// The frames, first to last, whatever their link.
    pub fn frames(&self) -> impl Iterator<Item = &[u8]> {
        self.with_links().map(|(_, frame)| frame)
    }

    /// The frames for a link, first to last.
    pub fn frames_over(&self, link: usize) -> impl Iterator<Item = &[u8]> {
        self.with_links().filter(move |(over, _)| *over == link).map(|(_, frame)| frame)
    }

    fn with_links(&self) -> impl Iterator<Item = (usize, &[u8])> {
        let starts = std::iter::once(0).chain(self.ends.iter().map(|(end, _)| *end));
        starts.zip(&self.ends).filter_map(|(start, (end, link))| Some((*link, self.bytes.get(start..*end)?)))
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

    #[test]
    fn each_link_gets_its_own_frames() {
        let mut outbox = Outbox::default();
        for (link, frame) in [(0, 1_u8), (2, 2), (0, 3), (1, 4)] {
            outbox.push_over(link, |bytes| bytes.push(frame));
        }
        let over = |link| outbox.frames_over(link).flatten().copied().collect::<Vec<u8>>();
        assert_eq!([over(0), over(1), over(2), over(3)], [vec![1, 3], vec![4], vec![2], vec![]]);
    }
}
