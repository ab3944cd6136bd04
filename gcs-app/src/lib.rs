//! Shell: the ground station: window, headless commands and the demo.
//!
//! `app` is the window: its `logic` drains what the workers found out, its `ui` draws. Panels and
//! map borrow the state and ask for changes through `command`. Nothing on the UI thread waits.

pub mod assets;
pub mod demo;
pub mod headless;
pub mod report;
