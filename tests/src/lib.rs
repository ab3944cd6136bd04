//! System tests over the real binaries.
