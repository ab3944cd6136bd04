//! System tests over the real binaries: what the tests in `tests/` share.

pub mod plans;
