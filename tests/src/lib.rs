//! System tests over the real binaries: what the tests in `tests/` share.

pub mod binaries;
pub mod foreseen;
pub mod laid;
pub mod logs;
pub mod plans;
pub mod programme;
pub mod quirks;
pub mod rig;
pub mod table;
