//! No code: its manifest makes the features of shared dependencies agree, whichever package is built.
