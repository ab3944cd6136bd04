//! Data that is compiled in: basemap, terrain, example plans.
