//! Figures: panels over one time axis, drawn as SVG.
//!
//! [`Figure`] says what is to be seen, `of_plan` and `of_tracking` make one, [`svg`] draws it. Text is left to the
//! viewer's sans-serif, so nothing is embedded.

use planner::{AxisKind, AxisPlan, Plan, Quantity};
use plotters::coord::Shift;
use plotters::prelude::{
    Color as _, DrawingArea, FontDesc, FontFamily, FontTransform, IntoDrawingArea as _, PathElement,
    RGBColor, Rectangle, SVGBackend, ShapeStyle, TextStyle,
};
use plotters::style::FontStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::failure::Failure;
use crate::show::number::{self, plain, unit};
use crate::show::table::{classification, short};

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
}

/// One quantity over time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) unit: String,
    pub(crate) series: Vec<Series>,
    pub(crate) limits: Vec<Limit>,
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
    /// Of the palette, from 0 on; it begins again after its end.
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

impl Ink {
    /// Okabe and Ito (2008): told apart with every kind of colour vision. Ordered so that neighbours differ in
    /// lightness as well.
    const PALETTE: [RGBColor; 7] = [
        RGBColor(0, 114, 178),
        RGBColor(213, 94, 0),
        RGBColor(0, 158, 115),
        RGBColor(204, 121, 167),
        RGBColor(86, 180, 233),
        RGBColor(230, 159, 0),
        RGBColor(40, 40, 40),
    ];

    fn color(self) -> RGBColor {
        match self {
            Self::Grey => QUIET,
            Self::Number(number) => Self::PALETTE[number % Self::PALETTE.len()],
        }
    }
}

const TEXT: RGBColor = RGBColor(31, 41, 55);
const QUIET: RGBColor = RGBColor(107, 114, 128);
const AXIS: RGBColor = RGBColor(156, 163, 175);
const GRID: RGBColor = RGBColor(229, 231, 235);
const BAND: RGBColor = RGBColor(244, 246, 248);
const BAND_EDGE: RGBColor = RGBColor(209, 213, 219);

// Lengths [px].
const WIDTH: f64 = 960.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 936.0;
const PANEL: f64 = 160.0;
const PANEL_GAP: f64 = 20.0;
const TOP: f64 = 68.0;
const LEGEND_LINE: f64 = 22.0;
const BANDS_LINE: f64 = 20.0;
const BOTTOM: f64 = 54.0;
/// The backend counts whole numbers: this many of them make a pixel, so that curves are smooth.
const FINE: f64 = 20.0;

/// Of the range of a panel [1]: what is left free at either end.
const HEADROOM: f64 = 0.12;
/// Of a limit [1]: a curve that gets less near leaves the limit out of the picture.
const NEAR: f64 = 0.25;
/// The most curves that a legend names.
const MOST_NAMED: usize = 12;

/// Position, velocity, acceleration and jerk of a plan, with its limits and phases.
pub(crate) fn of_plan(plan: &Plan) -> Figure {
    let axes: Vec<_> = plan.axes().iter().enumerate().collect();
    let mut panels = Vec::new();
    for kind in [AxisKind::Prismatic, AxisKind::Revolute, AxisKind::Pulses] {
        let of_kind: Vec<_> = axes.iter().copied().filter(|(_, axis)| axis.kind == kind).collect();
        if of_kind.is_empty() {
            continue;
        }
        for (word, (name, quantity)) in QUANTITIES.into_iter().enumerate() {
            let series = of_kind.iter().map(|(index, axis)| Series {
                name: short(&axis.axis),
                ink: Ink::Number(*index),
                stroke: Stroke::Plain,
                points: curve(axis, plan.duration(), word),
            });
            let several = axes.len() > 1;
            let limits = of_kind.iter().flat_map(|(index, axis)| {
                let ink = if several { Ink::Number(*index) } else { Ink::Grey };
                limits(axis, quantity).into_iter().map(move |value| Limit { value, ink })
            });
            panels.push(Panel {
                title: name.to_owned(),
                unit: unit(kind, quantity),
                series: series.collect(),
                limits: distinct(limits),
            });
        }
    }
    let slowest = plan.axes().iter().reduce(|slowest, axis| {
        if axis.profile.duration() > slowest.profile.duration() { axis } else { slowest }
    });
    let (title, bands_name) = match (slowest, plan.axes().len()) {
        (Some(axis), 1) => (
            format!("{}: {}", short(&axis.axis), classification(&axis.classification, axis.kind)),
            "phase".to_owned(),
        ),
        (Some(axis), axes) => {
            let name = short(&axis.axis);
            let shape = classification(&axis.classification, axis.kind);
            (format!("{axes} axes; {name} takes longest: {shape}"), format!("phase of {name}"))
        }
        (None, _) => (String::new(), String::new()),
    };
    let bands = slowest.into_iter().flat_map(|axis| axis.profile.timed_segments()).enumerate();
    let bands = bands.map(|(index, (from, segment))| Band {
        from,
        to: from + segment.duration,
        label: (index + 1).to_string(),
    });
    let (seconds, cycles) = (plain(plan.duration()), plan.cycle_count());
    Figure {
        title,
        subtitle: format!("{seconds} s, {cycles} cycles of {}", number::cycle(plan.cycle_time())),
        panels,
        bands_name,
        bands: bands.collect(),
    }
}

const QUANTITIES: [(&str, Quantity); 4] = [
    ("Position", Quantity::Position),
    ("Velocity", Quantity::Velocity),
    ("Acceleration", Quantity::Acceleration),
    ("Jerk", Quantity::Jerk),
];

/// What an axis was told and what it did, cycle by cycle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracked {
    pub(crate) axis: String,
    pub(crate) unit: String,
    /// [s]
    pub(crate) times: Vec<f64>,
    pub(crate) commanded_position: Vec<f64>,
    pub(crate) measured_position: Vec<f64>,
    pub(crate) commanded_velocity: Vec<f64>,
    pub(crate) measured_velocity: Vec<f64>,
    pub(crate) following_error: Vec<f64>,
}

/// Commanded against measured position and velocity, and the following error, above what `plan` says of acceleration
/// and jerk.
pub(crate) fn of_tracking(plan: &Plan, tracked: &Tracked) -> Figure {
    let Tracked { axis, unit, times, .. } = tracked;
    let pairs =
        |values: &[f64]| -> Vec<(f64, f64)> { times.iter().copied().zip(values.iter().copied()).collect() };
    let told = |values| Series {
        name: "commanded".to_owned(),
        ink: Ink::Number(4),
        stroke: Stroke::Under,
        points: pairs(values),
    };
    let did = |name: &str, values| Series {
        name: name.to_owned(),
        ink: Ink::Number(1),
        stroke: Stroke::Over,
        points: pairs(values),
    };
    let mut figure = of_plan(plan);
    let planned = std::mem::take(&mut figure.panels);
    let limits = |title: &str| {
        planned
            .iter()
            .find(|panel| panel.title == title)
            .map(|panel| panel.limits.clone())
            .unwrap_or_default()
    };
    let panel = |title: &str, unit: String, series| Panel {
        title: title.to_owned(),
        unit,
        series,
        limits: limits(title),
    };
    figure.title = format!("{}: commanded against measured", short(axis));
    figure.panels = vec![
        panel(
            "Position",
            unit.clone(),
            vec![told(&tracked.commanded_position), did("measured", &tracked.measured_position)],
        ),
        panel(
            "Velocity",
            format!("{unit}/s"),
            vec![told(&tracked.commanded_velocity), did("measured", &tracked.measured_velocity)],
        ),
        panel("Following error", unit.clone(), vec![did("measured", &tracked.following_error)]),
    ];
    let rest = planned.into_iter().filter(|panel| matches!(panel.title.as_str(), "Acceleration" | "Jerk"));
    let until = times.last().copied().unwrap_or_default();
    figure.panels.extend(rest.map(|mut panel| {
        for series in &mut panel.series {
            "commanded".clone_into(&mut series.name);
            series.ink = Ink::Number(4);
            // The axis is watched for longer than it moves.
            let held = series.points.last().filter(|last| last.0 < until).map(|last| (until, last.1));
            series.points.extend(held);
        }
        panel
    }));
    figure
}

/// One derivative over time, as far as `until` [s]. Pieces are cubic: enough points to look smooth, and both ends of each.
fn curve(axis: &AxisPlan, until: f64, word: usize) -> Vec<(f64, f64)> {
    /// Over the whole width.
    const POINTS: f64 = 900.0;
    /// In one piece, however short.
    const LEAST: usize = 12;
    let mut points = Vec::new();
    let is_jerk = word == 3;
    if is_jerk {
        points.push((0.0, 0.0));
    }
    let few = axis.profile.segments().len() <= 200;
    for (begin, segment) in axis.profile.timed_segments() {
        let share = (segment.duration / until * POINTS).ceil() as usize;
        let count = match (is_jerk, few) {
            (true, _) => 1,
            (false, true) => share.max(LEAST),
            (false, false) => share.max(1),
        };
        points.extend((0..=count).map(|index| {
            let time = segment.duration * index as f64 / count as f64;
            (begin + time, segment.at(time).words()[word])
        }));
    }
    let held = planner::Setpoint::held(axis.profile.end()).words()[word];
    points.push((axis.profile.duration(), held));
    points.push((until, held));
    decimated(points, until)
}

/// At most four points for each column of the picture: the first, the least, the greatest and the last.
fn decimated(points: Vec<(f64, f64)>, until: f64) -> Vec<(f64, f64)> {
    const COLUMNS: f64 = 2.0 * (RIGHT - LEFT);
    if points.len() <= 4 * COLUMNS as usize {
        return points;
    }
    let column = |point: &(f64, f64)| (point.0 / until * COLUMNS) as i64;
    let mut kept = Vec::new();
    for points in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let ends = [points.first(), points.last()];
        let extremes = [points.iter().min_by(by_value), points.iter().max_by(by_value)];
        let mut column: Vec<(f64, f64)> = ends.into_iter().chain(extremes).flatten().copied().collect();
        column.sort_by(|a, b| a.0.total_cmp(&b.0));
        column.dedup();
        kept.extend(column);
    }
    kept
}

fn limits(axis: &AxisPlan, quantity: Quantity) -> Vec<f64> {
    let limits = &axis.limits;
    let hardest = limits.acceleration().max(limits.deceleration());
    match quantity {
        Quantity::Position => [limits.min_position(), limits.max_position()].into(),
        Quantity::Velocity => [limits.velocity_forward(), -limits.velocity_reverse()].into(),
        Quantity::Acceleration => [hardest, -hardest].into(),
        Quantity::Jerk => [limits.jerk(), -limits.jerk()].into(),
        _ => Vec::new(),
    }
}

/// Each value once; one that several share belongs to none of them.
fn distinct(limits: impl Iterator<Item = Limit>) -> Vec<Limit> {
    let mut kept: Vec<Limit> = Vec::new();
    for limit in limits.filter(|limit| limit.value.is_finite()) {
        match kept.iter_mut().find(|other| other.value.to_bits() == limit.value.to_bits()) {
            Some(other) => other.ink = Ink::Grey,
            None => kept.push(limit),
        }
    }
    kept
}

/// The figure as an SVG document.
pub(crate) fn svg(figure: &Figure) -> Result<String, Failure> {
    let legend = Legend::of(figure);
    let panels_top = TOP + legend.height() + if figure.bands.is_empty() { 0.0 } else { BANDS_LINE };
    let panels = figure.panels.len() as f64;
    let height = panels_top + panels * (PANEL + PANEL_GAP) - PANEL_GAP + BOTTOM;
    let mut text = String::new();
    let size = ((WIDTH * FINE) as u32, (height * FINE) as u32);
    let drawn = {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        let canvas = Canvas { area: &area, time: TimeAxis::of(figure) };
        canvas.figure(figure, &legend, panels_top).and_then(|()| area.present().map_err(internal))
    };
    drawn?;
    let fine = format!("<svg width=\"{}\" height=\"{}\"", size.0, size.1);
    let real = format!("<svg width=\"{WIDTH}\" height=\"{height}\" role=\"img\" stroke-linejoin=\"round\"");
    let text = text.replacen(&fine, &real, 1);
    Ok(match text.split_once(">\n") {
        Some((head, rest)) => format!("{head}>\n<title>{}</title>\n{rest}", escaped(&figure.title)),
        None => text,
    })
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn internal(error: impl std::fmt::Display) -> Failure {
    Failure::Internal(format!("the plot cannot be drawn: {error}"))
}

/// Which curves there are, each once, in rows.
struct Legend<'a> {
    rows: Vec<Vec<(f64, &'a Series)>>,
    more: usize,
}

/// Roughly, of a sans-serif at 13 px [px].
const LETTER: f64 = 7.2;
const SAMPLE: f64 = 26.0;

impl<'a> Legend<'a> {
    fn of(figure: &'a Figure) -> Self {
        let mut entries: Vec<&Series> = Vec::new();
        for series in figure.panels.iter().flat_map(|panel| &panel.series) {
            if !entries.iter().any(|entry| entry.name == series.name) {
                entries.push(series);
            }
        }
        if entries.len() < 2 {
            return Self { rows: Vec::new(), more: 0 };
        }
        let more = entries.len().saturating_sub(MOST_NAMED);
        let mut rows = vec![Vec::new()];
        let mut x = LEFT;
        for entry in entries.into_iter().take(MOST_NAMED) {
            let width = SAMPLE + 8.0 + LETTER * entry.name.chars().count() as f64 + 22.0;
            if x + width > RIGHT && x > LEFT {
                rows.push(Vec::new());
                x = LEFT;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, entry));
            }
            x += width;
        }
        Self { rows, more }
    }

    fn height(&self) -> f64 {
        let lines = self.rows.len() + usize::from(self.more > 0);
        if lines == 0 { 0.0 } else { LEGEND_LINE * lines as f64 + 4.0 }
    }
}

/// Time, from zero to the right edge.
struct TimeAxis {
    until: f64,
    unit: &'static str,
    /// In how many of the unit a second is counted.
    per_second: f64,
}

impl TimeAxis {
    fn of(figure: &Figure) -> Self {
        let times = figure.panels.iter().flat_map(|panel| &panel.series).flat_map(|series| &series.points);
        let last = times.map(|point| point.0).filter(|time| time.is_finite()).fold(0.0, f64::max);
        let until = if last > 0.0 { last } else { 1e-3 };
        let (unit, per_second) = match until {
            t if t < 2e-5 => ("ns", 1e9),
            t if t < 2e-3 => ("µs", 1e6),
            t if t < 0.2 => ("ms", 1e3),
            _ => ("s", 1.0),
        };
        Self { until, unit, per_second }
    }

    fn x(&self, time: f64) -> f64 {
        LEFT + (time / self.until).clamp(0.0, 1.0) * (RIGHT - LEFT)
    }
}

/// Values, from the bottom of a panel to its top.
struct ValueAxis {
    top: f64,
    least: f64,
    greatest: f64,
}

impl ValueAxis {
    fn of(panel: &Panel, top: f64) -> Self {
        let (low, high) = panel.extent();
        let shown = panel.limits.iter().filter(|limit| panel.sees(limit)).map(|limit| limit.value);
        let is_position = panel.title == "Position";
        // Rates are read against zero; positions are where they are.
        let zero = (!is_position).then_some(0.0);
        let (least, greatest) = shown
            .chain(zero)
            .fold((low, high), |(least, greatest), value| (least.min(value), greatest.max(value)));
        let span = greatest - least;
        // A curve that does not vary lies in the middle.
        let room = if span > 1e-12 * greatest.abs().max(least.abs()) {
            HEADROOM * span
        } else {
            (0.5 * greatest.abs()).max(f64::MIN_POSITIVE.sqrt())
        };
        let room = if span == 0.0 && greatest == 0.0 { 1.0 } else { room };
        Self { top, least: least - room, greatest: greatest + room }
    }

    fn y(&self, value: f64) -> f64 {
        self.top + PANEL * (1.0 - (value - self.least) / (self.greatest - self.least))
    }
}

impl Panel {
    fn extent(&self) -> (f64, f64) {
        let values = self.series.iter().flat_map(|series| &series.points).map(|point| point.1);
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low <= high { (low, high) } else { (0.0, 0.0) }
    }

    /// Does a curve come near enough to this limit for both to be in the picture?
    fn sees(&self, limit: &Limit) -> bool {
        let (low, high) = self.extent();
        if self.title == "Position" {
            let span = (high - low).max(f64::MIN_POSITIVE);
            return limit.value >= low - span && limit.value <= high + span;
        }
        let towards = if limit.value < 0.0 { -low } else { high };
        towards >= NEAR * limit.value.abs() && towards > 0.0
    }

    /// The limits that no curve comes near, though it goes that way.
    fn unseen(&self) -> Vec<f64> {
        let (low, high) = self.extent();
        // A ripple about zero does not go anywhere.
        let some = 0.05 * (high - low);
        let heads_for =
            |value: f64| self.title == "Position" || if value < 0.0 { -low > some } else { high > some };
        let away = |limit: &&Limit| !self.sees(limit) && heads_for(limit.value);
        self.limits.iter().filter(away).map(|limit| limit.value).collect()
    }
}

struct Canvas<'a, 'b> {
    area: &'a DrawingArea<SVGBackend<'b>, Shift>,
    time: TimeAxis,
}

impl Canvas<'_, '_> {
    fn figure(&self, figure: &Figure, legend: &Legend<'_>, panels_top: f64) -> Result<(), Failure> {
        self.area.fill(&RGBColor(255, 255, 255)).map_err(internal)?;
        self.text(&figure.title, (LEFT, 20.0), &bold(label(17.0, TEXT, HPos::Left)))?;
        self.text(&figure.subtitle, (LEFT, 44.0), &label(13.0, QUIET, HPos::Left))?;
        self.legend(legend)?;
        let bottom = panels_top + figure.panels.len() as f64 * (PANEL + PANEL_GAP) - PANEL_GAP;
        self.bands(figure, panels_top)?;
        let ticks = Ticks::of(0.0, self.time.until * self.time.per_second, 9);
        for (index, panel) in figure.panels.iter().enumerate() {
            let top = panels_top + index as f64 * (PANEL + PANEL_GAP);
            for (value, _) in ticks.labels() {
                let x = self.time.x(value / self.time.per_second);
                self.line(&[(x, top), (x, top + PANEL)], GRID, 1.0)?;
            }
            self.panel(panel, top)?;
        }
        for (value, text) in ticks.labels() {
            let x = self.time.x(value / self.time.per_second);
            self.line(&[(x, bottom), (x, bottom + 5.0)], AXIS, 1.0)?;
            self.text(&text, (x, bottom + 15.0), &label(12.0, QUIET, HPos::Center))?;
        }
        let title = format!("Time [{}]", self.time.unit);
        self.text(&title, (0.5 * (LEFT + RIGHT), bottom + 38.0), &label(13.0, TEXT, HPos::Center))
    }

    fn legend(&self, legend: &Legend<'_>) -> Result<(), Failure> {
        let mut y = TOP + 4.0;
        for row in &legend.rows {
            for (x, series) in row {
                self.stroke(&[(*x, y), (x + SAMPLE, y)], series)?;
                self.text(&series.name, (x + SAMPLE + 8.0, y), &label(13.0, TEXT, HPos::Left))?;
            }
            y += LEGEND_LINE;
        }
        if legend.more > 0 {
            let text = format!("and {} more", legend.more);
            self.text(&text, (LEFT, y), &label(13.0, QUIET, HPos::Left))?;
        }
        Ok(())
    }

    /// Every other phase is shaded, each has its number at the top where there is room, and an edge in every panel.
    fn bands(&self, figure: &Figure, panels_top: f64) -> Result<(), Failure> {
        const ROOM: f64 = 5.0;
        let labels_y = panels_top - 0.5 * BANDS_LINE;
        let tops: Vec<f64> =
            (0..figure.panels.len()).map(|index| panels_top + index as f64 * (PANEL + PANEL_GAP)).collect();
        // More than this is a texture, not a help.
        let shaded = figure.bands.len() <= 60;
        for (index, band) in figure.bands.iter().enumerate().filter(|_| shaded) {
            let (from, to) = (self.time.x(band.from), self.time.x(band.to));
            for &top in &tops {
                if index % 2 == 0 {
                    self.filled((from, top), (to, top + PANEL), BAND)?;
                }
            }
            let width = LETTER * band.label.chars().count() as f64 + 2.0 * ROOM;
            if to - from >= width {
                self.text(&band.label, (0.5 * (from + to), labels_y), &label(11.0, QUIET, HPos::Center))?;
            }
        }
        for band in figure.bands.iter().skip(1).filter(|_| shaded) {
            let x = self.time.x(band.from);
            for &top in &tops {
                self.line(&[(x, top), (x, top + PANEL)], BAND_EDGE, 1.0)?;
            }
        }
        if !figure.bands.is_empty() && shaded {
            self.text(&figure.bands_name, (LEFT - 10.0, labels_y), &label(11.0, QUIET, HPos::Right))?;
        }
        Ok(())
    }

    fn panel(&self, panel: &Panel, top: f64) -> Result<(), Failure> {
        let axis = ValueAxis::of(panel, top);
        let scale = Scale::of(axis.least, axis.greatest);
        let ticks = Ticks::of(axis.least / scale.factor, axis.greatest / scale.factor, 6);
        for (value, text) in ticks.labels() {
            let y = axis.y(value * scale.factor);
            let color = if value == 0.0 { AXIS } else { GRID };
            self.line(&[(LEFT, y), (RIGHT, y)], color, 1.0)?;
            self.text(&text, (LEFT - 8.0, y), &label(12.0, QUIET, HPos::Right))?;
        }
        self.line(&[(LEFT, top), (LEFT, top + PANEL), (RIGHT, top + PANEL)], AXIS, 1.0)?;
        let title = format!("{} [{}{}]", panel.title, scale.prefix, panel.unit);
        let upright = label(13.0, TEXT, HPos::Center).transform(FontTransform::Rotate270);
        self.text(&title, (20.0, top + 0.5 * PANEL), &upright)?;
        for limit in panel.limits.iter().filter(|limit| panel.sees(limit)) {
            self.limit(limit, &axis)?;
            self.limit_label(limit, &axis)?;
        }
        for series in &panel.series {
            let points: Vec<_> =
                series.points.iter().map(|(time, value)| (self.time.x(*time), axis.y(*value))).collect();
            self.stroke(&points, series)?;
        }
        let unseen = panel.unseen();
        if !unseen.is_empty() {
            let values: Vec<_> = unseen.iter().take(4).map(|value| signed(*value)).collect();
            let text = format!("limit off scale: {} {}", values.join(", "), panel.unit);
            self.text(&text, (LEFT + 8.0, top + 10.0), &label(10.5, QUIET, HPos::Left))?;
        }
        Ok(())
    }

    fn limit(&self, limit: &Limit, axis: &ValueAxis) -> Result<(), Failure> {
        const DASH: f64 = 6.0;
        const PERIOD: f64 = 10.0;
        let y = axis.y(limit.value);
        let mut x = LEFT;
        while x < RIGHT {
            self.line(&[(x, y), ((x + DASH).min(RIGHT), y)], limit.ink.color(), 1.2)?;
            x += PERIOD;
        }
        Ok(())
    }

    /// Above an upper limit, below a lower one: outside, where its own curve is not; of another axis one may be, and it
    /// runs on over the label.
    fn limit_label(&self, limit: &Limit, axis: &ValueAxis) -> Result<(), Failure> {
        let text = format!("limit {}", signed(limit.value));
        let y = axis.y(limit.value) + if limit.value < 0.0 { 8.0 } else { -7.0 };
        self.text(&text, (RIGHT - 2.0, y), &label(10.5, limit.ink.color(), HPos::Right))
    }

    fn stroke(&self, points: &[(f64, f64)], series: &Series) -> Result<(), Failure> {
        let (color, width) = match series.stroke {
            Stroke::Plain => (series.ink.color(), 2.0),
            Stroke::Under => (series.ink.color(), 4.0),
            Stroke::Over => (series.ink.color(), 1.3),
        };
        self.line(points, color, width)
    }

    fn line(&self, points: &[(f64, f64)], color: RGBColor, width: f64) -> Result<(), Failure> {
        let points: Vec<_> = points.iter().map(|point| fine(*point)).collect();
        let style = ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: (width * FINE) as u32 };
        self.area.draw(&PathElement::new(points, style)).map_err(internal)
    }

    fn filled(&self, from: (f64, f64), to: (f64, f64), color: RGBColor) -> Result<(), Failure> {
        self.area.draw(&Rectangle::new([fine(from), fine(to)], color.filled())).map_err(internal)
    }

    fn text(&self, text: &str, at: (f64, f64), style: &TextStyle<'_>) -> Result<(), Failure> {
        self.area.draw_text(text, style, fine(at)).map_err(internal)
    }
}

/// A number with a minus that is as wide as a plus.
fn signed(value: f64) -> String {
    plain(value).replacen('-', "−", 1)
}

/// A text style about the middle of the text's height, `size` in pixels.
fn label(size: f64, color: RGBColor, h_pos: HPos) -> TextStyle<'static> {
    // The backend draws fonts smaller than they are asked for, by this.
    const SHRINKS: f64 = 1.24;
    let font = FontDesc::new(FontFamily::SansSerif, size * FINE * SHRINKS, FontStyle::Normal);
    TextStyle { font, color: color.to_backend_color(), pos: Pos::new(h_pos, VPos::Center) }
}

fn bold(style: TextStyle<'static>) -> TextStyle<'static> {
    TextStyle { font: style.font.style(FontStyle::Bold), ..style }
}

/// Pixels in the whole numbers of the backend.
fn fine((x, y): (f64, f64)) -> (i32, i32) {
    ((x * FINE).round() as i32, (y * FINE).round() as i32)
}

/// Positions of marks on an axis: whole multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
    first: i64,
    last: i64,
    step: f64,
    decimals: usize,
}

impl Ticks {
    /// About `wanted` of them between `least` and `greatest`.
    fn of(least: f64, greatest: f64, wanted: u32) -> Self {
        let rough = (greatest - least) / f64::from(wanted);
        let exponent = rough.log10().floor();
        let power = 10f64.powf(exponent);
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(power);
        let decimals = (-step.log10().floor()).clamp(0.0, 17.0) as usize;
        let slack = 1e-9;
        let (first, last) = ((least / step - slack).ceil() as i64, (greatest / step + slack).floor() as i64);
        Self { first, last: last.min(first.saturating_add(50)), step, decimals }
    }

    fn labels(&self) -> impl Iterator<Item = (f64, String)> {
        (self.first..=self.last).map(|index| {
            let value = index as f64 * self.step;
            let text = format!("{value:.*}", self.decimals);
            (value, text.replacen('-', "−", 1))
        })
    }
}

/// A power of ten that is taken out of the marks of an axis and put into its title.
struct Scale {
    factor: f64,
    prefix: String,
}

impl Scale {
    fn of(least: f64, greatest: f64) -> Self {
        let largest = least.abs().max(greatest.abs());
        if (1e-2..1e5).contains(&largest) || largest == 0.0 || !largest.is_finite() {
            return Self { factor: 1.0, prefix: String::new() };
        }
        let exponent = (largest.log10() / 3.0).floor() as i32 * 3;
        let digits: String = exponent
            .to_string()
            .chars()
            .map(|c| match c {
                '-' => '⁻',
                '1' => '¹',
                '2' => '²',
                '3' => '³',
                c => c.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(c),
            })
            .collect();
        Self { factor: 10f64.powi(exponent), prefix: format!("10{digits} ") }
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "both ends of a step are the very same number")]
mod tests {
    use super::*;
    use planner::{
        AxisMoveSpec, Judged, LimitsSpec, Request, RequestSpec, ShortPathPolicy, State, Synchronization,
    };

    fn plan(distances: &[f64]) -> Plan {
        let axis = |(index, &distance): (usize, &f64)| AxisMoveSpec {
            axis: format!("axis {index} <&>"),
            kind: Ok(AxisKind::Prismatic),
            start: State::default(),
            goal: State::at_rest(distance),
            limits: LimitsSpec {
                max_velocity: 0.25,
                max_acceleration: 3.0,
                max_jerk: 100.0,
                ..LimitsSpec::default()
            },
        };
        let request = Request::try_from(RequestSpec {
            axes: distances.iter().enumerate().map(axis).collect(),
            cycle_time_ns: None,
            family: Ok(planner::Family::SCurve),
            order: None,
            short_path: Ok(ShortPathPolicy::Reject),
            synchronization: Ok(Synchronization::None),
            minimum_duration: None,
            end_on_cycle: false,
        });
        Judged::answer(&request.unwrap()).unwrap().plan().clone()
    }

    /// What a servo with a lag and a ripple might have done.
    fn tracked(plan: &Plan) -> Tracked {
        let mut tracked = Tracked { axis: "x".into(), unit: "m".into(), ..Tracked::default() };
        let mut sampler = plan.sampler();
        for cycle in 0..plan.cycle_count() + 60 {
            let time = cycle as f64 * 1e-3;
            let setpoint = sampler.at(cycle).next().unwrap().state;
            let late = plan.axes()[0].profile.at(time - 0.004).state;
            let ripple = 2e-5 * (time * 300.0).sin() * (-(time - 0.2).abs() * 8.0).exp();
            tracked.times.push(time);
            tracked.commanded_position.push(setpoint.position);
            tracked.measured_position.push(late.position + ripple);
            tracked.commanded_velocity.push(setpoint.velocity);
            tracked.measured_velocity.push(late.velocity + 300.0 * ripple);
            tracked.following_error.push(setpoint.position - late.position - ripple);
        }
        tracked
    }

    #[test]
    fn a_plan_has_four_panels_with_units_limits_and_phases() {
        let svg = svg(&of_plan(&plan(&[0.05]))).unwrap();
        for part in
            ["Position [m]", "Velocity [m/s]", "Acceleration [m/s²]", "Jerk [m/s³]", "Time [s]", "type 1"]
        {
            assert!(svg.contains(part), "{part}");
        }
        for part in
            ["limit 0.25", "limit 3", "limit −3", "limit 100", "limit −100", ">\n7\n<", "&lt;&amp;&gt;"]
        {
            assert!(svg.contains(part), "{part}");
        }
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn jerk_is_drawn_in_steps() {
        let figure = of_plan(&plan(&[0.05]));
        let points = &figure.panels[3].series[0].points;
        for pair in points.windows(2) {
            let (upright, level) = (pair[0].0 == pair[1].0, pair[0].1 == pair[1].1);
            assert!(upright || level, "{pair:?}");
        }
    }

    #[test]
    fn several_axes_have_a_legend_and_a_standstill_is_a_figure_too() {
        let several = svg(&of_plan(&plan(&[0.05, -0.1]))).unwrap();
        assert!(several.contains("axis 0 &lt;&amp;&gt;\n") && several.contains("axis 1 &lt;&amp;&gt;\n"));
        let still = svg(&of_plan(&plan(&[0.0]))).unwrap();
        assert!(still.contains("stands still") && !still.contains("NaN"));
    }

    #[test]
    fn tracking_is_laid_over_the_command() {
        let plan = plan(&[0.05]);
        let svg = svg(&of_tracking(&plan, &tracked(&plan))).unwrap();
        for part in ["commanded", "measured", "Following error [", "Jerk [m/s³]"] {
            assert!(svg.contains(part), "{part}");
        }
        // To be looked at.
        std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/../target/tracking.svg"), svg).unwrap();
    }

    #[test]
    fn long_curves_keep_their_extremes() {
        let mut points: Vec<_> = (0..1_000_000).map(|index| (f64::from(index), 0.0)).collect();
        points[123_456].1 = 1.0;
        points[654_321].1 = -1.0;
        let kept = decimated(points, 1e6);
        assert!(kept.len() < 10_000, "{}", kept.len());
        assert!(kept.contains(&(123_456.0, 1.0)) && kept.contains(&(654_321.0, -1.0)));
    }
}
