//! Shell: the ground station: window, headless commands and the demo.
