//! Shell: FCS Gateway, FP Manager and their supervisor.

pub mod gateway;
