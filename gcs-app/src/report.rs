//! The report of a flight.
