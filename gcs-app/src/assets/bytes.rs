//! Reading of varints from bytes that may be damaged.

/// The bytes ended, or a number was too long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Damaged;

/// What is left of some bytes.
pub(super) struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    /// The next `n` bytes.
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], Damaged> {
        let (head, tail) = self.0.split_at_checked(n).ok_or(Damaged)?;
        self.0 = tail;
        Ok(head)
    }

    /// An LEB128 number of at most 32 bits.
    pub fn unsigned(&mut self) -> Result<u32, Damaged> {
        let mut value = 0u64;
        for shift in (0..35).step_by(7) {
            let byte = *self.0.first().ok_or(Damaged)?;
            self.0 = &self.0[1..];
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return u32::try_from(value).map_err(|_| Damaged);
            }
        }
        Err(Damaged)
    }

    /// A zigzag number.
    pub fn signed(&mut self) -> Result<i32, Damaged> {
        let n = self.unsigned()?;
        Ok((n >> 1) as i32 ^ -((n & 1) as i32))
    }

    /// How many things follow; more than could possibly be there is damage, not memory.
    pub fn count(&mut self) -> Result<usize, Damaged> {
        let n = self.unsigned()? as usize;
        if n <= self.0.len() { Ok(n) } else { Err(Damaged) }
    }
}
