//! Shell: the ground station: window, headless commands and the demo.
//!
//! `app` is the window: its `logic` drains what the workers found out, its `ui` draws. Panels and
//! map borrow the state and ask for changes through `command`. Nothing on the UI thread waits.

#[macro_use]
mod say;

pub mod actions;
pub mod airfields;
pub mod app;
pub mod assets;
pub mod chart;
pub mod command;
pub mod connections;
pub mod coordinates;
pub mod demo;
pub mod derived;
mod desktop;
pub mod dock;
pub mod document;
pub mod export;
pub mod files;
pub mod forecast;
pub mod formats;
pub mod guide;
pub mod headless;
pub mod help;
pub mod jobs;
pub mod layers;
pub mod link;
pub mod map;
pub mod panels;
pub mod recent;
pub mod recovery;
pub mod report;
mod runways;
pub mod shelf;
pub mod state;
pub mod story;
pub mod theme;
pub mod tiles;
pub mod units;
