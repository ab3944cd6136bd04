//! Shell: FCS Gateway, FP Manager and their supervisor.
