//! The FP Manager as a whole.

mod kills;
