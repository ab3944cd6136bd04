//! Pure: Zenoh's batches in a stream of bytes. Each comes after its length: two bytes, the lower one first.

/// Counts whole batches.
#[derive(Debug, Default)]
pub struct Batches {
    whole: u32,
    /// First byte of a length whose second one has not come.
    half_length: Option<u8>,
    /// Bytes of the batch under way that have not come.
    missing: usize,
}

impl Batches {
    /// How many came so far.
    pub fn whole(&self) -> u32 {
        self.whole
    }

    /// More of the stream.
    pub fn take(&mut self, mut bytes: &[u8]) {
        while let Some((first, rest)) = bytes.split_first() {
            if self.missing > 0 {
                let here = self.missing.min(bytes.len());
                bytes = bytes.get(here..).unwrap_or_default();
                self.missing -= here;
                self.whole += u32::from(self.missing == 0);
                continue;
            }
            bytes = rest;
            match self.half_length.take() {
                None => self.half_length = Some(*first),
                Some(low) => {
                    self.missing = usize::from(u16::from_le_bytes([low, *first]));
                    self.whole += u32::from(self.missing == 0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_are_counted_however_the_stream_is_cut() {
        let lengths = [3_u16, 0, 300, 1, 65535];
        let stream: Vec<u8> = lengths
            .iter()
            .flat_map(|n| n.to_le_bytes().into_iter().chain(std::iter::repeat_n(7, usize::from(*n))))
            .collect();
        for size in [1, 2, 3, 7, 1000, stream.len()] {
            let mut batches = Batches::default();
            stream.chunks(size).for_each(|chunk| batches.take(chunk));
            assert_eq!(batches.whole(), 5, "in chunks of {size}");
            batches.take(&[9, 0]);
            assert_eq!(batches.whole(), 5, "a length is no batch");
        }
    }
}
