//! Draws a figure as an SVG document. Text is left to the viewer's sans-serif, so nothing is embedded.

use plotters::coord::Shift;
use plotters::prelude::{
    Circle, Color as _, DrawingArea, FontDesc, FontFamily, FontTransform, IntoDrawingArea as _, PathElement,
    RGBColor, Rectangle, SVGBackend, ShapeStyle, TextStyle,
};
use plotters::style::FontStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axes::{Scale, Ticks, TimeAxis, ValueAxis, signed};
use super::figure::{Figure, Ink, Limit, Mark, Marks, Panel, Series, Strip, Stroke};
use super::layout::{
    BANDS_LINE, BOTTOM, FINE, LEFT, LEGEND_LINE, PANEL, PANEL_GAP, RIGHT, STRIP, STRIPS_GAP, SUBTITLE_LINE,
    TOP, WIDTH,
};
use crate::failure::Failure;

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

    /// Has another curve its colour already?
    fn is_dashed(self) -> bool {
        matches!(self, Self::Number(number) if number >= Self::PALETTE.len())
    }
}

const TEXT: RGBColor = RGBColor(31, 41, 55);
const QUIET: RGBColor = RGBColor(107, 114, 128);
const AXIS: RGBColor = RGBColor(156, 163, 175);
const GRID: RGBColor = RGBColor(229, 231, 235);
const BAND: RGBColor = RGBColor(244, 246, 248);
const BAND_EDGE: RGBColor = RGBColor(209, 213, 219);

/// The most curves that a legend names.
const MOST_NAMED: usize = 12;
/// The most strips: what is below them is to be seen as well.
const MOST_STRIPS: usize = 12;
/// How much of its colour the span of a strip has [1]: its label is to be read.
const TINT: f64 = 0.45;

/// The figure as an SVG document.
pub(crate) fn svg(figure: &Figure) -> Result<String, Failure> {
    let legend = Legend::of(figure);
    let more_lines = lines(&figure.subtitle, RIGHT - LEFT).len().saturating_sub(1);
    let legend_top = TOP + SUBTITLE_LINE * more_lines as f64;
    let strips_top = legend_top + legend.height();
    let strips = figure.strips.len().min(MOST_STRIPS) as f64;
    let strips = if strips > 0.0 { strips * STRIP + STRIPS_GAP } else { 0.0 };
    let panels_top = strips_top + strips + if figure.bands.is_empty() { 0.0 } else { BANDS_LINE };
    let panels = figure.panels.len() as f64;
    let height = panels_top + panels * (PANEL + PANEL_GAP) - PANEL_GAP + BOTTOM;
    let mut text = String::new();
    let size = ((WIDTH * FINE) as u32, (height * FINE) as u32);
    let drawn = {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        let canvas = Canvas { area: &area, time: TimeAxis::of(figure) };
        canvas
            .figure(figure, &legend, [legend_top, strips_top, panels_top])
            .and_then(|()| area.present().map_err(internal))
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
    rows: Vec<Vec<(f64, Entry<'a>)>>,
    more: usize,
}

/// What a legend names.
#[derive(Clone, Copy)]
enum Entry<'a> {
    Curve(&'a Series),
    Marks(&'a Marks),
}

impl<'a> Entry<'a> {
    fn name(self) -> &'a str {
        match self {
            Self::Curve(series) => &series.name,
            Self::Marks(marks) => &marks.name,
        }
    }
}

/// Roughly, of a sans-serif at 13 px [px].
const LETTER: f64 = 7.2;
const SAMPLE: f64 = 26.0;

impl<'a> Legend<'a> {
    fn of(figure: &'a Figure) -> Self {
        let curves = figure.panels.iter().flat_map(|panel| &panel.series).map(Entry::Curve);
        let marks = figure.panels.iter().flat_map(|panel| &panel.marks);
        let marks = marks.filter(|marks| !marks.points.is_empty()).map(Entry::Marks);
        let mut entries: Vec<Entry<'_>> = Vec::new();
        for entry in curves.chain(marks) {
            if !entries.iter().any(|other| other.name() == entry.name()) {
                entries.push(entry);
            }
        }
        if entries.len() < 2 {
            return Self { rows: Vec::new(), more: 0 };
        }
        let more = entries.len().saturating_sub(MOST_NAMED);
        let mut rows = vec![Vec::new()];
        let mut x = LEFT;
        for entry in entries.into_iter().take(MOST_NAMED) {
            let width = SAMPLE + 8.0 + LETTER * entry.name().chars().count() as f64 + 22.0;
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

struct Canvas<'a, 'b> {
    area: &'a DrawingArea<SVGBackend<'b>, Shift>,
    time: TimeAxis,
}

impl Canvas<'_, '_> {
    fn figure(&self, figure: &Figure, legend: &Legend<'_>, tops: [f64; 3]) -> Result<(), Failure> {
        let [legend_top, strips_top, panels_top] = tops;
        self.area.fill(&RGBColor(255, 255, 255)).map_err(internal)?;
        self.text(&figure.title, (LEFT, 20.0), &bold(label(17.0, TEXT, HPos::Left)))?;
        for (index, line) in lines(&figure.subtitle, RIGHT - LEFT).iter().enumerate() {
            self.text(line, (LEFT, 44.0 + SUBTITLE_LINE * index as f64), &label(13.0, QUIET, HPos::Left))?;
        }
        self.legend(legend, legend_top)?;
        self.strips(figure, strips_top)?;
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

    fn legend(&self, legend: &Legend<'_>, top: f64) -> Result<(), Failure> {
        let mut y = top + 4.0;
        for row in &legend.rows {
            for (x, entry) in row {
                match entry {
                    Entry::Curve(series) => self.stroke(&[(*x, y), (x + SAMPLE, y)], series)?,
                    // Of whatever colour.
                    Entry::Marks(marks) => self.mark((x + 0.5 * SAMPLE, y), marks.mark, QUIET)?,
                }
                self.text(entry.name(), (x + SAMPLE + 8.0, y), &label(13.0, TEXT, HPos::Left))?;
            }
            y += LEGEND_LINE;
        }
        if legend.more > 0 {
            let text = format!("and {} more", legend.more);
            self.text(&text, (LEFT, y), &label(13.0, QUIET, HPos::Left))?;
        }
        Ok(())
    }

    /// Each row has its name beside it, and in each span its label, where there is room.
    fn strips(&self, figure: &Figure, top: f64) -> Result<(), Failure> {
        const ROOM: f64 = 2.0;
        for (index, Strip { name, spans }) in figure.strips.iter().take(MOST_STRIPS).enumerate() {
            let y = top + index as f64 * STRIP;
            let middle = y + 0.5 * (STRIP - 2.0);
            let title =
                if figure.strips.len() > 1 { format!("region of {name}") } else { "region".to_owned() };
            self.text(&title, (LEFT - 10.0, middle), &label(11.0, QUIET, HPos::Right))?;
            for span in spans {
                let (from, to) = (self.time.x(span.from), self.time.x(span.to));
                self.filled((from, y), (to, y + STRIP - 2.0), tint(span.ink.color()))?;
                let width = 6.0 * span.label.len() as f64 + 2.0 * ROOM;
                if to - from >= width {
                    self.text(span.label, (0.5 * (from + to), middle), &label(10.0, TEXT, HPos::Center))?;
                }
            }
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
        let scale = Scale::of(axis.least, axis.greatest, &panel.unit);
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
        for marks in &panel.marks {
            for (time, value) in &marks.points {
                self.mark((self.time.x(*time), axis.y(*value)), marks.mark, marks.ink.color())?;
            }
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

    fn mark(&self, at: (f64, f64), mark: Mark, color: RGBColor) -> Result<(), Failure> {
        let (radius, filled, width) = match mark {
            Mark::Dot => (1.8, true, 0.0),
            Mark::Ring => (4.2, false, 1.2),
            Mark::Cross => {
                const ARM: f64 = 4.0;
                let (x, y) = at;
                self.line(&[(x - ARM, y - ARM), (x + ARM, y + ARM)], color, 1.4)?;
                return self.line(&[(x - ARM, y + ARM), (x + ARM, y - ARM)], color, 1.4);
            }
        };
        let style = ShapeStyle { color: color.to_rgba(), filled, stroke_width: (width * FINE) as u32 };
        let circle = Circle::new(fine(at), (radius * FINE) as i32, style);
        self.area.draw(&circle).map_err(internal)
    }

    fn stroke(&self, points: &[(f64, f64)], series: &Series) -> Result<(), Failure> {
        let (color, width) = match series.stroke {
            Stroke::Plain => (series.ink.color(), 2.0),
            Stroke::Under => (series.ink.color(), 4.0),
            Stroke::Over => (series.ink.color(), 1.3),
        };
        if !series.ink.is_dashed() {
            return self.line(points, color, width);
        }
        dashes(points).iter().try_for_each(|dash| self.line(dash, color, width))
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

/// A curve cut into dashes, by its length.
fn dashes(points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    const DASH: f64 = 7.0;
    const GAP: f64 = 4.0;
    let mut all = Vec::new();
    let mut dash: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
    let (mut is_drawn, mut left) = (true, DASH);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut rest = (to.0 - from.0).hypot(to.1 - from.1);
        while rest > left {
            let share = left / rest;
            from = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            rest -= left;
            if is_drawn {
                dash.push(from);
                all.push(std::mem::take(&mut dash));
            } else {
                dash = vec![from];
            }
            is_drawn = !is_drawn;
            left = if is_drawn { DASH } else { GAP };
        }
        left -= rest;
        if is_drawn {
            dash.push(to);
        }
    }
    if dash.len() > 1 {
        all.push(dash);
    }
    all
}

/// A text in lines of at most `width` pixels, at 13 px.
fn lines(text: &str, width: f64) -> Vec<String> {
    let most = (width / LETTER) as usize;
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A colour that a label can be read on.
fn tint(RGBColor(red, green, blue): RGBColor) -> RGBColor {
    let [red, green, blue] =
        [red, green, blue].map(|part| (255.0 - TINT * (255.0 - f64::from(part))).round() as u8);
    RGBColor(red, green, blue)
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
