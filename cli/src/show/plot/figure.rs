//! What is to be seen: figures as data, before anybody draws them.

/// What is to be seen: panels above each other, which share the time axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figure {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    pub(crate) panels: Vec<Panel>,
    /// What the bands are, as `phase`.
    pub(crate) bands_name: String,
    /// Spans of time that are told apart, as the phases of a motion.
    pub(crate) bands: Vec<Band>,
    /// Rows of coloured spans above the panels, as the regions of points.
    pub(crate) strips: Vec<Strip>,
}

/// What kind of thing goes on when, in colours.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strip {
    pub(crate) name: String,
    pub(crate) spans: Vec<Span>,
}

/// A span of time [s] in a strip, with one letter or two.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) label: &'static str,
    pub(crate) ink: Ink,
}

/// One quantity over time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) unit: String,
    pub(crate) baseline: Baseline,
    pub(crate) series: Vec<Series>,
    pub(crate) limits: Vec<Limit>,
    /// Single points, over the curves.
    pub(crate) marks: Vec<Marks>,
}

/// Points of one kind.
#[derive(Clone, Debug)]
pub(crate) struct Marks {
    pub(crate) name: String,
    pub(crate) ink: Ink,
    pub(crate) mark: Mark,
    /// Time [s] and value.
    pub(crate) points: Vec<(f64, f64)>,
}

/// How a point is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    /// Small and full.
    Dot,
    /// Around a dot, for what is remarkable.
    Ring,
    /// Two strokes, for where something happens on a curve.
    Cross,
}

/// What the values of a panel are seen against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Baseline {
    /// Rates and errors.
    #[default]
    Zero,
    /// Positions are where they are.
    Themselves,
}

/// One curve.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) ink: Ink,
    pub(crate) stroke: Stroke,
    /// Time [s] and value, in order of time; a step is two points at one time.
    pub(crate) points: Vec<(f64, f64)>,
}

/// A value that is not to be passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) value: f64,
    pub(crate) ink: Ink,
}

/// A span of time [s].
#[derive(Clone, Debug)]
pub(crate) struct Band {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) label: String,
}

/// Which colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ink {
    /// For what belongs to no curve.
    Grey,
    /// Of the palette, from 0 on; after its end it begins again, with curves in dashes.
    Number(usize),
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// A curve by itself.
    Plain,
    /// Wide and pale, for another curve to lie upon.
    Under,
    /// Thin, to lie upon another.
    Over,
}
