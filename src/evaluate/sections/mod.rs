//! The parts of the report: what is measured becomes words, tables, plots and pictures.

pub(super) mod claims;
pub(super) mod error;
pub(super) mod gradient;
pub(super) mod property;
pub(super) mod space;
pub(super) mod time;
