//! Pure: MAVLink frames from bytes and to bytes. Garbage is counted and skipped, never a reason to stop.
//!
//! The decoder gives frames as they are on the wire. Whoever needs the message asks for it: a value that
//! the dialect does not know loses the message and not the frame, so that even it can be answered.
// the bytes come from a link
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAV_STX, MAV_STX_V2, MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message, calculate_crc};

/// The longest frame, bytes: header 10, payload 255, checksum 2, signature 13.
pub const LONGEST: usize = 280;
/// No dialect has a message beyond this.
const HIGHEST_ID: u32 = 0xFFFF;
pub(crate) const SIGNED: u8 = 0x01;
pub(crate) const SIGNATURE_BYTES: usize = 13;
pub(crate) const CHECKSUM_BYTES: usize = 2;

/// Who sent a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sender {
    /// System id.
    pub system: u8,
    /// Component id.
    pub component: u8,
}

/// A frame whose checksum is right, as it is on the wire; or one of a message that the dialect does not know.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    version: MavlinkVersion,
    /// Who sent it.
    pub sender: Sender,
    /// Its number: the sender counts up by one on each link, and from 255 to 0.
    pub sequence: u8,
    /// Message id.
    pub id: u32,
    /// Payload; MAVLink 2 cuts trailing zeros.
    pub payload: &'a [u8],
    /// Its checksum.
    pub checksum: u16,
    /// The whole frame.
    pub bytes: &'a [u8],
}

impl Frame<'_> {
    /// What stands behind the checksum of a signed frame.
    pub(crate) fn signature(&self) -> Option<&[u8; SIGNATURE_BYTES]> {
        let signed = self.version == MavlinkVersion::V2 && self.bytes.get(2) == Some(&SIGNED);
        if signed { self.bytes.last_chunk() } else { None }
    }

    /// The message; `None` if the dialect does not know it, or a value of it.
    pub fn message(&self) -> Option<MavMessage> {
        MavMessage::parse(self.version, self.id, self.payload).ok()
    }
}

/// Cuts bytes that come in pieces into frames. Keeps at most one unfinished frame, once all whole ones were
/// taken.
#[derive(Debug, Clone, Default)]
pub struct Decoder {
    pending: Vec<u8>,
    /// Bytes of `pending` that are done with.
    done: usize,
    /// The pending bytes end with the end of a datagram.
    datagram: bool,
    /// Bytes that belonged to no good frame.
    pub ignored_bytes: u64,
    /// What looked like a frame and had another checksum: it is damaged.
    pub bad_frames: u64,
}

/// What stands at the beginning of some bytes.
enum Cut {
    NeedMore,
    /// So many bytes belong to no frame.
    Skip(usize),
    /// It begins as a frame does, and its checksum is wrong.
    Bad,
    Frame(Shape),
}

/// Where the parts of a frame are.
#[derive(Clone, Copy)]
struct Shape {
    version: MavlinkVersion,
    header: usize,
    payload: usize,
    total: usize,
}

impl Decoder {
    /// Takes in a piece of a stream; take the frames by [`Self::next_frame`] before the next piece.
    pub fn push(&mut self, bytes: &[u8]) {
        self.pending.drain(..self.done.min(self.pending.len()));
        self.done = 0;
        self.datagram = false;
        self.pending.extend_from_slice(bytes);
    }

    /// Takes in a datagram: what is left over at its end is garbage, and not the start of the next one.
    pub fn push_datagram(&mut self, bytes: &[u8]) {
        self.push(bytes);
        self.datagram = true;
    }

    /// Forgets an unfinished frame: another stream begins.
    pub fn restart(&mut self) {
        self.pending.clear();
        self.done = 0;
    }

    /// The next whole frame; `None`: more bytes are needed.
    pub fn next_frame(&mut self) -> Option<Frame<'_>> {
        let shape = loop {
            let rest = self.pending.get(self.done..).unwrap_or_default();
            match cut(rest, self.datagram) {
                Cut::Frame(shape) => break shape,
                Cut::Skip(bytes) => self.skip(bytes),
                Cut::Bad => {
                    self.bad_frames += 1;
                    self.skip(1);
                }
                Cut::NeedMore if self.datagram => self.skip(rest.len()),
                Cut::NeedMore => return None,
            }
            if self.done >= self.pending.len() {
                return None;
            }
        };
        let start = self.done;
        self.done += shape.total;
        parse(shape, self.pending.get(start..self.done)?)
    }

    fn skip(&mut self, bytes: usize) {
        self.ignored_bytes += bytes as u64;
        self.done += bytes;
    }
}

/// A frame at the very beginning of these bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beginning {
    /// There is one, so many bytes long.
    Frame(usize),
    /// There may be one, with more bytes.
    NeedMore,
    /// There is none.
    Nothing,
}

/// Whether these bytes begin with a frame.
pub fn begins(bytes: &[u8]) -> Beginning {
    match cut(bytes, false) {
        Cut::Frame(shape) => Beginning::Frame(shape.total),
        Cut::NeedMore => Beginning::NeedMore,
        Cut::Skip(_) | Cut::Bad => Beginning::Nothing,
    }
}

/// Looks at the beginning of the bytes. `ends`: nothing that belongs to them follows.
fn cut(bytes: &[u8], ends: bool) -> Cut {
    let Some(start) = bytes.iter().position(|b| matches!(*b, MAV_STX | MAV_STX_V2)) else {
        return if bytes.is_empty() { Cut::NeedMore } else { Cut::Skip(bytes.len()) };
    };
    if start > 0 {
        return Cut::Skip(start);
    }
    let (version, header) = match bytes.first() {
        Some(&MAV_STX_V2) => (MavlinkVersion::V2, 10),
        _ => (MavlinkVersion::V1, 6),
    };
    let (Some(&length), Some(&flags)) = (bytes.get(1), bytes.get(2)) else { return Cut::NeedMore };
    let flags = if version == MavlinkVersion::V2 { flags } else { 0 };
    // other incompatible flags than the signature: not for us
    if flags & !SIGNED != 0 {
        return Cut::Skip(1);
    }
    let payload = usize::from(length);
    let signature = if flags == SIGNED { SIGNATURE_BYTES } else { 0 };
    let shape = Shape { version, header, payload, total: header + payload + CHECKSUM_BYTES + signature };
    match bytes.get(..shape.total) {
        None => Cut::NeedMore,
        Some(frame) if is_intact(shape, frame) => Cut::Frame(shape),
        Some(frame) if is_unknown(shape, frame) => match bytes.get(shape.total) {
            Some(&(MAV_STX | MAV_STX_V2)) => Cut::Frame(shape),
            None if ends => Cut::Frame(shape),
            None => Cut::NeedMore,
            Some(_) => Cut::Bad,
        },
        Some(_) => Cut::Bad,
    }
}

/// It is of a message that the dialect does not know: nothing tells whether its checksum is right, but what follows it.
fn is_unknown(shape: Shape, frame: &[u8]) -> bool {
    let id = message_id(shape.version, frame).filter(|id| *id <= HIGHEST_ID);
    shape.version == MavlinkVersion::V2
        && id.is_some_and(|id| MavMessage::default_message_from_id(id).is_none())
}

fn is_intact(shape: Shape, frame: &[u8]) -> bool {
    let end = shape.header + shape.payload;
    let (Some(covered), Some(&[low, high])) = (frame.get(1..end), frame.get(end..end + CHECKSUM_BYTES))
    else {
        return false;
    };
    let id = message_id(shape.version, frame).unwrap_or(0);
    calculate_crc(covered, MavMessage::extra_crc(id)) == u16::from_le_bytes([low, high])
}

pub(crate) fn message_id(version: MavlinkVersion, frame: &[u8]) -> Option<u32> {
    match version {
        MavlinkVersion::V2 => Some(u32::from_le_bytes([*frame.get(7)?, *frame.get(8)?, *frame.get(9)?, 0])),
        MavlinkVersion::V1 => frame.get(5).map(|id| u32::from(*id)),
    }
}

fn parse(shape: Shape, frame: &[u8]) -> Option<Frame<'_>> {
    // number, system and component id stand before the message id
    let at = if shape.version == MavlinkVersion::V2 { 4 } else { 2 };
    let end = shape.header + shape.payload;
    Some(Frame {
        version: shape.version,
        sender: Sender { system: *frame.get(at + 1)?, component: *frame.get(at + 2)? },
        sequence: *frame.get(at)?,
        id: message_id(shape.version, frame)?,
        payload: frame.get(shape.header..end)?,
        checksum: u16::from_le_bytes([*frame.get(end)?, *frame.get(end + 1)?]),
        bytes: frame,
    })
}

/// Appends a message's MAVLink 2 frame to `out`.
pub fn encode_into(sender: Sender, sequence: u8, message: &MavMessage, out: &mut Vec<u8>) {
    let header = MavHeader { system_id: sender.system.into(), component_id: sender.component, sequence };
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message(header, message);
    out.extend_from_slice(raw.raw_bytes());
}

/// Its checksum, over all but the first byte of a frame without one.
pub(crate) fn checksum(frame: &[u8], id: u32) -> [u8; CHECKSUM_BYTES] {
    calculate_crc(frame.get(1..).unwrap_or_default(), MavMessage::extra_crc(id)).to_le_bytes()
}

/// A message's MAVLink 2 frame.
pub fn encode(sender: Sender, sequence: u8, message: &MavMessage) -> Vec<u8> {
    let mut bytes = vec![];
    encode_into(sender, sequence, message, &mut bytes);
    bytes
}

/// A MAVLink 2 frame around a payload made by hand; what is beyond 255 bytes is cut off.
pub fn encode_payload(sender: Sender, sequence: u8, id: u32, payload: &[u8]) -> Vec<u8> {
    let length = u8::try_from(payload.len()).unwrap_or(u8::MAX);
    let payload = payload.get(..length.into()).unwrap_or(payload);
    let [id0, id1, id2, _] = id.to_le_bytes();
    let Sender { system, component } = sender;
    let mut bytes = vec![MAV_STX_V2, length, 0, 0, sequence, system, component, id0, id1, id2];
    bytes.extend_from_slice(payload);
    let checksum = checksum(&bytes, id);
    bytes.extend_from_slice(&checksum);
    bytes
}

#[cfg(test)]
mod tests;
