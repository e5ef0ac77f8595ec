//! Panels over one time axis, as an SVG file.

use std::fmt::{Result, Write};

/// One quantity over time.
pub(crate) struct Panel {
    pub(crate) title: &'static str,
    pub(crate) unit: &'static str,
    /// [time, value]; a jump is two values at one time.
    pub(crate) line: Vec<[f64; 2]>,
    /// What was commanded.
    pub(crate) dots: Vec<[f64; 2]>,
    /// Both limits, where there are any.
    pub(crate) limits: Option<[f64; 2]>,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 190.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 18.0;
const TOP: f64 = 78.0;
const GAP: f64 = 34.0;

/// The figure: a title, a line of words below it, and the panels one above the other.
pub(crate) fn figure(
    title: &str,
    words: &str,
    end: f64,
    panels: &[Panel],
) -> std::result::Result<String, std::fmt::Error> {
    let height = TOP + panels.len() as f64 * (HEIGHT + GAP) + 24.0;
    let mut svg = String::new();
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" \
         font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#333\">"
    )?;
    writeln!(svg, "<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>")?;
    writeln!(svg, "<text x=\"{LEFT}\" y=\"24\" font-size=\"17\" font-weight=\"bold\">{title}</text>")?;
    writeln!(svg, "<text x=\"{LEFT}\" y=\"43\" fill=\"#666\">{words}</text>")?;
    for (index, panel) in panels.iter().enumerate() {
        let top = TOP + index as f64 * (HEIGHT + GAP);
        panel.draw(&mut svg, top, end, index + 1 == panels.len())?;
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

impl Panel {
    fn draw(&self, svg: &mut String, top: f64, end: f64, last: bool) -> Result {
        let [low, high] = self.span();
        let scale = Scale { end, low, high, top };
        writeln!(
            svg,
            "<text x=\"{LEFT}\" y=\"{:.1}\" font-weight=\"bold\">{} <tspan fill=\"#888\" \
             font-weight=\"normal\">[{}]</tspan></text>",
            top - 7.0,
            self.title,
            self.unit
        )?;
        for value in ticks(low, high, 5.0) {
            let y = scale.y(value);
            let colour = if value == 0.0 { "#999" } else { "#e4e4e4" };
            writeln!(svg, "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"{colour}\"/>", WIDTH - RIGHT)?;
            writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT - 8.0,
                y + 4.0,
                Short(value)
            )?;
        }
        for time in ticks(0.0, end, 12.0) {
            let x = scale.x(time);
            writeln!(svg, "<path d=\"M{x:.1} {top:.1}v{HEIGHT}\" stroke=\"#f0f0f0\"/>")?;
            if last {
                let y = top + HEIGHT + 17.0;
                writeln!(
                    svg,
                    "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>",
                    Short(time)
                )?;
            }
        }
        if last {
            let (x, y) = (WIDTH - RIGHT, top + HEIGHT + 34.0);
            writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\" fill=\"#888\">time [s]</text>"
            )?;
        }
        for limit in self.limits.into_iter().flatten().filter(|&limit| limit >= low && limit <= high) {
            let y = scale.y(limit);
            writeln!(
                svg,
                "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"#c0392b\" stroke-dasharray=\"6 4\"/>",
                WIDTH - RIGHT
            )?;
        }
        for &[time, value] in &self.dots {
            let (x, y) = (scale.x(time), scale.y(value));
            writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.1\" fill=\"#e08a1e\"/>")?;
        }
        write!(
            svg,
            "<path fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"1.2\" stroke-linejoin=\"round\" d=\""
        )?;
        for (index, &[time, value]) in self.line.iter().enumerate() {
            let command = if index == 0 { 'M' } else { 'L' };
            write!(svg, "{command}{:.2} {:.2}", scale.x(time), scale.y(value))?;
        }
        writeln!(svg, "\"/>")
    }

    /// What there is to see, with some air: limits where the line comes near to them.
    fn span(&self) -> [f64; 2] {
        let (mut low, mut high) = (0.0f64, 0.0f64);
        for &[_, value] in self.line.iter().chain(&self.dots) {
            (low, high) = (low.min(value), high.max(value));
        }
        if let Some([least, greatest]) = self.limits {
            if low < 0.3 * least {
                low = low.min(least);
            }
            high = high.max(greatest);
        }
        let air = 0.06 * (high - low).max(1e-9);
        [low - air, high + air]
    }
}

struct Scale {
    end: f64,
    low: f64,
    high: f64,
    top: f64,
}

impl Scale {
    fn x(&self, time: f64) -> f64 {
        LEFT + time / self.end * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        self.top + HEIGHT * (self.high - value) / (self.high - self.low)
    }
}

/// Round numbers from `low` to `high`, about as many as asked for.
fn ticks(low: f64, high: f64, about: f64) -> Vec<f64> {
    let rough = (high - low) / about;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * decade).into_iter().find(|&step| step >= rough);
    let step = step.unwrap_or(decade);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|number| number as f64 * step).collect()
}

/// A tick without the digits that its binary form has too many.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> Result {
        write!(f, "{}", (self.0 * 1e6).round() / 1e6)
    }
}
