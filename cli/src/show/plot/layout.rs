//! Lengths of the picture [px].

pub(super) const WIDTH: f64 = 960.0;
pub(super) const LEFT: f64 = 92.0;
pub(super) const RIGHT: f64 = 936.0;
pub(super) const PANEL: f64 = 160.0;
pub(super) const PANEL_GAP: f64 = 20.0;
pub(super) const TOP: f64 = 68.0;
pub(super) const SUBTITLE_LINE: f64 = 18.0;
pub(super) const LEGEND_LINE: f64 = 22.0;
pub(super) const BANDS_LINE: f64 = 20.0;
/// One strip, and what is free below the last.
pub(super) const STRIP: f64 = 16.0;
pub(super) const STRIPS_GAP: f64 = 8.0;
pub(super) const BOTTOM: f64 = 54.0;
/// The backend counts whole numbers: this many of them make a pixel, so that curves are smooth.
pub(super) const FINE: f64 = 20.0;
