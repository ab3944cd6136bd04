//! What is wrong with a file.

use std::fmt;

/// Something wrong, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Bytes from the beginning of the file: of the record that is to blame.
    pub offset: u64,
    /// What.
    pub damage: Damage,
}

/// What can be wrong with a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Damage {
    /// It doesn't begin as an MCAP file.
    Foreign,
    /// It ends in the middle of a record.
    Torn {
        /// Bytes behind the last whole record.
        bytes: u64,
    },
    /// It ends between two records, without the summary that a finished file has.
    Unfinished,
    /// A record that says it is longer than any that is read.
    TooLong {
        /// As it says, bytes.
        bytes: u64,
    },
    /// A record of no known kind where only zeros or garbage can be.
    NoRecord {
        /// Its first byte.
        opcode: u8,
    },
    /// A record whose content doesn't fit its length.
    Malformed {
        /// Of what kind.
        what: &'static str,
    },
    /// A checksum that isn't right.
    Checksum {
        /// Of what.
        what: &'static str,
    },
    /// A chunk that is compressed.
    Compressed {
        /// With what.
        with: String,
    },
    /// A message on a channel, or a channel with a schema, that was not introduced before.
    Unknown {
        /// Channel or schema.
        what: &'static str,
        /// Its number.
        id: u16,
    },
    /// A channel or schema that was introduced before, as another one.
    Redefined {
        /// Channel or schema.
        what: &'static str,
        /// Its number.
        id: u16,
    },
    /// Statistics at the end that tell another number of messages.
    Count {
        /// As they say.
        told: u64,
        /// As were read.
        read: u64,
    },
    /// Bytes behind the end.
    Behind,
    /// More of them than are kept in memory.
    TooMany {
        /// Of what.
        what: &'static str,
    },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "byte {}: {}", self.offset, self.damage)
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign => f.write_str("this is no MCAP file: it does not begin as one"),
            Self::Torn { bytes } => {
                write!(
                    f,
                    "the file ends in the middle of a record: {bytes} bytes can't be used; all before them was read"
                )
            }
            Self::Unfinished => {
                f.write_str("the file has no end: its writer died or is still writing; all of it was read")
            }
            Self::TooLong { bytes } => {
                write!(f, "a record of {bytes} bytes is longer than any that is read: left out")
            }
            Self::NoRecord { opcode } => {
                write!(f, "no record begins with byte {opcode:#04x}: nothing from here on was read")
            }
            Self::Malformed { what } => write!(f, "a {what} whose content does not fit its length: left out"),
            Self::Checksum { what } => write!(f, "the checksum of the {what} is wrong"),
            Self::Compressed { with } => write!(
                f,
                "a chunk is compressed ({with:?}) and was left out: decompress the file first (`mcap decompress`)"
            ),
            Self::Unknown { what, id } => write!(f, "{what} {id} was not introduced: left out"),
            Self::Redefined { what, id } => {
                write!(f, "{what} {id} is introduced again, as another one: left out")
            }
            Self::Count { told, read } => write!(f, "its summary counts {told} messages, {read} were read"),
            Self::Behind => f.write_str("there are bytes behind the end: left out"),
            Self::TooMany { what } => write!(f, "more {what} than are read: left out"),
        }
    }
}
