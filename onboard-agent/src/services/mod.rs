//! Services beside gateway and FP Manager: a folder each.

pub mod storage;
