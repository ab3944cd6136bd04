//! Shell around a pure core: a simulated fixed-wing autopilot that speaks MAVLink 2 as ArduPlane does.
