//! How answers look: tables and paragraphs for people, JSON and CSV for programs, plots for both.

pub(crate) mod bench;
pub(crate) mod columns;
pub(crate) mod compared;
pub(crate) mod csv;
pub(crate) mod differences;
pub(crate) mod grade;
pub(crate) mod json;
pub(crate) mod number;
pub(crate) mod paint;
pub(crate) mod plot;
pub(crate) mod points;
pub(crate) mod report;
pub(crate) mod table;
pub(crate) mod watch;
pub(crate) mod words;
