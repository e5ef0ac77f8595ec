//! A small chart for the examples: panels in rows and columns, curves in each, written as SVG.
//!
//! ```ignore
//! let mut panel = Panel::new("first simulation", "Time [s]", "Velocity [pulses/s]");
//! panel.curve("asymmetric", 0, points);
//! Chart { title: "…".into(), subtitle: "…".into(), columns: 2, panel: NARROW, panels: vec![panel] }.write("figure.svg")?;
//! ```

#![allow(dead_code, reason = "each example takes what it needs")]

use std::fmt::Write as _;

/// Panels, row by row.
pub(crate) struct Chart {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    pub(crate) columns: usize,
    /// Width and height of each panel [px].
    pub(crate) panel: (f64, f64),
    pub(crate) panels: Vec<Panel>,
}

/// Beside others, and alone in its row [px].
pub(crate) const NARROW: (f64, f64) = (310.0, 150.0);
pub(crate) const WIDE: (f64, f64) = (800.0, 180.0);

/// Curves over one pair of axes.
pub(crate) struct Panel {
    title: String,
    across: String,
    up: String,
    curves: Vec<Curve>,
    /// Horizontal lines that are not to be passed.
    bounds: Vec<f64>,
}

struct Curve {
    name: String,
    ink: usize,
    stroke: Stroke,
    points: Vec<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stroke {
    Solid,
    Dashed,
    Dots,
}

impl Stroke {
    /// What it adds to a line.
    fn dash(self) -> &'static str {
        if self == Self::Dashed { r#" stroke-dasharray="6 4""# } else { "" }
    }
}

/// Okabe and Ito (2008): told apart with every kind of colour vision.
const INKS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#282828"];

// Lengths [px].
const LEFT: f64 = 74.0;
const RIGHT: f64 = 26.0;
const ABOVE: f64 = 30.0;
const BELOW: f64 = 44.0;
const TOP: f64 = 84.0;
const LETTER: f64 = 6.8;

impl Panel {
    pub(crate) fn new(title: impl Into<String>, across: impl Into<String>, up: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            across: across.into(),
            up: up.into(),
            curves: Vec::new(),
            bounds: Vec::new(),
        }
    }

    /// Adds a curve in the colour number `ink`; curves of one name share a place in the legend.
    pub(crate) fn curve(&mut self, name: &str, ink: usize, points: Vec<(f64, f64)>) -> &mut Self {
        self.add(name, ink, Stroke::Solid, points)
    }

    /// The same, dashed.
    pub(crate) fn dashed(&mut self, name: &str, ink: usize, points: Vec<(f64, f64)>) -> &mut Self {
        self.add(name, ink, Stroke::Dashed, points)
    }

    /// Single points.
    pub(crate) fn dots(&mut self, name: &str, ink: usize, points: Vec<(f64, f64)>) -> &mut Self {
        self.add(name, ink, Stroke::Dots, points)
    }

    fn add(&mut self, name: &str, ink: usize, stroke: Stroke, points: Vec<(f64, f64)>) -> &mut Self {
        self.curves.push(Curve { name: name.into(), ink, stroke, points });
        self
    }

    /// Adds a line that is not to be passed.
    pub(crate) fn bound(&mut self, value: f64) -> &mut Self {
        self.bounds.push(value);
        self
    }

    /// Least and greatest across and up, with zero in the latter and some room.
    fn extent(&self) -> [f64; 4] {
        let points = self.curves.iter().flat_map(|curve| &curve.points);
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0];
        for &(x, y) in points {
            extent = [extent[0].min(x), extent[1].max(x), extent[2].min(y), extent[3].max(y)];
        }
        for &bound in &self.bounds {
            extent = [extent[0], extent[1], extent[2].min(bound), extent[3].max(bound)];
        }
        let [left, right, low, high] = extent;
        let room = if high > low { 0.08 * (high - low) } else { 1.0 };
        let right = if right > left { right } else { left + 1.0 };
        [left, right, low - room, high + room]
    }

    fn draw(&self, svg: &mut String, (left, top): (f64, f64), (width, height): (f64, f64)) {
        let (right, bottom) = (left + width, top + height);
        let [least, most, low, high] = self.extent();
        let x = |value: f64| left + (value - least) / (most - least) * width;
        let y = |value: f64| bottom - (value - low) / (high - low) * height;
        text(svg, (left, top - 9.0), "start", 13.0, "#1f2937", &self.title);
        for (value, label) in ticks(least, most, 5) {
            line(svg, (x(value), top), (x(value), bottom), "#e5e7eb");
            text(svg, (x(value), bottom + 15.0), "middle", 11.0, "#6b7280", &label);
        }
        for (value, label) in ticks(low, high, 4) {
            let color = if value == 0.0 { "#9ca3af" } else { "#e5e7eb" };
            line(svg, (left, y(value)), (right, y(value)), color);
            text(svg, (left - 6.0, y(value) + 4.0), "end", 11.0, "#6b7280", &label);
        }
        for &bound in &self.bounds {
            let at = y(bound);
            let _ = writeln!(
                svg,
                r##"<line x1="{left:.1}" y1="{at:.1}" x2="{right:.1}" y2="{at:.1}" stroke="#9ca3af" stroke-dasharray="5 4"/>"##
            );
        }
        line(svg, (left, top), (left, bottom), "#9ca3af");
        line(svg, (left, bottom), (right, bottom), "#9ca3af");
        text(svg, (0.5 * (left + right), bottom + 32.0), "middle", 11.0, "#1f2937", &self.across);
        let middle = 0.5 * (top + bottom);
        let _ = writeln!(
            svg,
            r##"<text transform="translate({:.1} {middle:.1}) rotate(-90)" text-anchor="middle" font-size="11" fill="#1f2937">{}</text>"##,
            left - 56.0,
            escaped(&self.up)
        );
        for Curve { ink, stroke, points, .. } in &self.curves {
            let ink = INKS[ink % INKS.len()];
            if *stroke == Stroke::Dots {
                for &(t, value) in points {
                    dot(svg, (x(t), y(value)), ink);
                }
                continue;
            }
            let points: Vec<String> =
                points.iter().map(|&(t, value)| format!("{:.2},{:.2}", x(t), y(value))).collect();
            let _ = writeln!(
                svg,
                r#"<polyline fill="none" stroke="{ink}" stroke-width="1.8" stroke-linejoin="round"{} points="{}"/>"#,
                stroke.dash(),
                points.join(" ")
            );
        }
    }
}

impl Chart {
    /// Writes the chart to `path`, and says so.
    pub(crate) fn write(&self, path: &str) -> std::io::Result<()> {
        std::fs::write(path, self.svg())?;
        eprintln!("drawn in {path}");
        Ok(())
    }

    /// The chart as a file has it.
    pub(crate) fn svg(&self) -> String {
        let columns = self.columns.max(1);
        let rows = self.panels.len().div_ceil(columns);
        let cell = (LEFT + self.panel.0 + RIGHT, ABOVE + self.panel.1 + BELOW);
        let (width, height) = (columns as f64 * cell.0, TOP + rows as f64 * cell.1);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        );
        let _ = writeln!(
            svg,
            r##"<text x="{LEFT}" y="28" font-size="17" font-weight="bold" fill="#1f2937">{}</text>"##,
            escaped(&self.title)
        );
        text(&mut svg, (LEFT, 48.0), "start", 12.0, "#6b7280", &self.subtitle);
        self.legend(&mut svg);
        for (index, panel) in self.panels.iter().enumerate() {
            let (row, column) = ((index / columns) as f64, (index % columns) as f64);
            panel.draw(&mut svg, (column * cell.0 + LEFT, TOP + row * cell.1 + ABOVE), self.panel);
        }
        svg + "</svg>\n"
    }

    /// Every name once.
    fn legend(&self, svg: &mut String) {
        let mut named: Vec<&Curve> = Vec::new();
        for curve in self.panels.iter().flat_map(|panel| &panel.curves) {
            if !named.iter().any(|other| other.name == curve.name) {
                named.push(curve);
            }
        }
        let mut x = LEFT;
        for Curve { name, ink, stroke, .. } in named {
            let ink = INKS[ink % INKS.len()];
            if *stroke == Stroke::Dots {
                dot(svg, (x + 13.0, 68.0), ink);
            } else {
                let _ = writeln!(
                    svg,
                    r#"<line x1="{x:.1}" y1="68" x2="{:.1}" y2="68" stroke="{ink}" stroke-width="2"{}/>"#,
                    x + 26.0,
                    stroke.dash()
                );
            }
            text(svg, (x + 33.0, 72.0), "start", 12.0, "#1f2937", name);
            x += 33.0 + LETTER * name.chars().count() as f64 + 22.0;
        }
    }
}

fn dot(svg: &mut String, (x, y): (f64, f64), ink: &str) {
    let _ = writeln!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="2.2" fill="{ink}"/>"#);
}

fn line(svg: &mut String, (x1, y1): (f64, f64), (x2, y2): (f64, f64), color: &str) {
    let _ = writeln!(svg, r#"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" stroke="{color}"/>"#);
}

fn text(svg: &mut String, (x, y): (f64, f64), anchor: &str, size: f64, color: &str, words: &str) {
    let words = escaped(words);
    let _ = writeln!(
        svg,
        r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}" fill="{color}">{words}</text>"#
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// About `wanted` whole multiples of 1, 2 or 5 times a power of ten, with their labels.
fn ticks(least: f64, most: f64, wanted: u32) -> Vec<(f64, String)> {
    let rough = (most - least) / f64::from(wanted);
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * power).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(power);
    let decimals = (-(step * 1.000_001).log10().floor()).clamp(0.0, 9.0) as usize;
    // Zeros say nothing.
    let brief = step < 1e-3 || least.abs().max(most.abs()) >= 1e5;
    let (first, last) = ((least / step - 1e-9).ceil() as i64, (most / step + 1e-9).floor() as i64);
    let label = |value: f64| {
        let text = match value {
            0.0 => "0".to_owned(),
            _ if brief => format!("{:e}", format!("{value:.3e}").parse::<f64>().unwrap_or(value)),
            _ => format!("{value:.decimals$}"),
        };
        text.replacen('-', "−", 1)
    };
    (first..=last).map(|index| index as f64 * step).map(|value| (value, label(value))).collect()
}
