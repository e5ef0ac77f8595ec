//! What was measured, and the laws through it, as SVG: a panel for each question, both axes in decades.

use std::ops::Range;

use plotters::chart::SeriesLabelPosition;
use plotters::coord::Shift;
use plotters::prelude::{
    ChartBuilder, Circle, Color as _, DrawingArea, IntoDrawingArea as _, IntoFont as _, IntoLogRange as _,
    PathElement, RGBColor, SVGBackend,
};

use crate::Failed;
use crate::fit::Fit;
use crate::measured::{Point, series};

/// A question as it is drawn.
struct Panel {
    question: &'static str,
    title: &'static str,
    across: &'static str,
    up: &'static str,
    series: &'static [&'static str],
    /// Curves fall: the room for their names is above.
    falls: bool,
}

/// Okabe and Ito (2008), as every figure of this project: told apart with every kind of colour vision.
const INKS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];
const TEXT: RGBColor = RGBColor(31, 41, 55);
const AXIS: RGBColor = RGBColor(107, 114, 128);
const GRID: RGBColor = RGBColor(229, 231, 235);
const FINE_GRID: RGBColor = RGBColor(243, 244, 246);
// On a sheet of its own, so that it is read on a dark page as well.
const PAPER: RGBColor = RGBColor(255, 255, 255);

/// Width and height of a panel [px].
const PANEL: (u32, u32) = (480, 340);
const COLUMNS: usize = 2;
const TITLE: u32 = 44;
/// The drawing's units in a pixel: plotters rounds to whole ones, and curves would have steps.
const FINE: u32 = 8;

const PLANNING: &[Panel] = &[
    Panel {
        question: "plan",
        title: "A move of several axes that arrive together",
        across: "Axes",
        up: "CPU time [µs]",
        series: &["plan", "judge", "from bytes to bytes", "call, server", "plan, alone"],
        falls: false,
    },
    Panel {
        question: "points",
        title: "A table of position, velocity and time",
        across: "Points",
        up: "CPU time [ms]",
        series: &[
            "plan and judge, 1 axis",
            "call, server, 1 axis",
            "plan and judge, 6 axes",
            "call, server, 6 axes",
        ],
        falls: false,
    },
];

const LENGTH: &[Panel] = &[
    Panel {
        question: "pieces",
        title: "To read a plan of one axis, and to judge it",
        across: "Pieces",
        up: "CPU time [µs]",
        series: &["read and judge"],
        falls: false,
    },
    Panel {
        question: "sample",
        title: "One setpoint of it",
        across: "Pieces",
        up: "CPU time [ns]",
        series: &["in order", "anywhere"],
        falls: false,
    },
    Panel {
        question: "length",
        title: "To open a stream with it",
        across: "Pieces",
        up: "CPU time [ms]",
        series: &["to open, server", "to open, axis"],
        falls: false,
    },
    Panel {
        question: "pieces memory",
        title: "How large it is",
        across: "Pieces",
        up: "Memory [KiB]",
        series: &["in the process", "on the wire"],
        falls: false,
    },
];

const STREAMS: &[Panel] = &[
    Panel {
        question: "streams",
        title: "Streams of one axis at 1 kHz",
        across: "Streams",
        up: "Cores",
        series: &["server, plain", "axes, plain", "server, compact", "axes, compact", "server, alone"],
        falls: false,
    },
    Panel {
        question: "axes of a stream",
        title: "A hundred streams of several axes",
        across: "Axes of a stream",
        up: "Cores",
        series: &["server, plain", "axes, plain", "server, compact", "axes, compact"],
        falls: false,
    },
    Panel {
        question: "batch",
        title: "A hundred streams, by cycles of a batch",
        across: "Cycles of a batch",
        up: "Cores",
        series: &["server", "axes"],
        falls: true,
    },
    Panel {
        question: "take-over",
        title: "Server killed: until its streams are open again",
        across: "Streams",
        up: "Time [ms]",
        series: &["p50, plain", "longest, plain", "p50, compact", "longest, compact"],
        falls: false,
    },
];

/// Every figure by the name of its file; those of which nothing was measured are left out.
pub(crate) fn all(points: &[Point]) -> Result<Vec<(&'static str, String)>, Failed> {
    let figures = [
        ("planning.svg", "Planning", PLANNING),
        ("length.svg", "Motions of many pieces", LENGTH),
        ("streams.svg", "Streams", STREAMS),
    ];
    let mut drawn = Vec::new();
    for (file, title, panels) in figures {
        let seen: Vec<&Panel> = panels.iter().filter(|panel| panel.extent(points).is_some()).collect();
        if !seen.is_empty() {
            drawn.push((file, figure(title, &seen, points)?));
        }
    }
    Ok(drawn)
}

fn figure(title: &str, panels: &[&Panel], points: &[Point]) -> Result<String, Failed> {
    let columns = COLUMNS.min(panels.len());
    let rows = panels.len().div_ceil(columns);
    let size = (PANEL.0 * columns as u32, TITLE + PANEL.1 * rows as u32);
    let fine = (size.0 * FINE, size.1 * FINE);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, fine).into_drawing_area();
        area.fill(&PAPER)?;
        let name = ("sans-serif", 18 * FINE).into_font().color(&TEXT);
        area.draw_text(
            &format!("{title}: measured, with the range of rounds; lines are the fitted laws"),
            &name,
            (16 * FINE as i32, 14 * FINE as i32),
        )?;
        let (_, below) = area.split_vertically(TITLE * FINE);
        for (panel, area) in panels.iter().zip(below.split_evenly((rows, columns))) {
            panel.draw(&area, points)?;
        }
        area.present()?;
    }
    let [drawn, shown] =
        [fine, size].map(|(width, height)| format!("<svg width=\"{width}\" height=\"{height}\""));
    Ok(text.replacen(&drawn, &shown, 1))
}

impl Panel {
    fn series<'a>(&self, points: &'a [Point]) -> impl Iterator<Item = (&'static str, Vec<&'a Point>)> {
        let question = self.question;
        self.series.iter().map(move |name| (*name, series(points, question, name)))
    }

    /// Whole decades, or a little more than what is there.
    fn extent(&self, points: &[Point]) -> Option<[Range<f64>; 2]> {
        let all: Vec<&Point> = self.series(points).flat_map(|(_, points)| points).collect();
        let range = |least: f64, most: f64| {
            let (low, high) = (least / 1.3, most * 1.3);
            // A range without two powers of ten in it would have no scale.
            let powers = high.log10().floor() - low.log10().ceil();
            if powers >= 1.0 {
                low..high
            } else {
                10f64.powf(low.log10().floor())..10f64.powf(high.log10().ceil())
            }
        };
        let least = |of: fn(&Point) -> f64| all.iter().map(|point| of(point)).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&Point) -> f64| all.iter().map(|point| of(point)).fold(0.0, f64::max);
        let there = !all.is_empty() && least(|point| point.least) > 0.0;
        there.then(|| {
            [
                range(least(|point| point.n), most(|point| point.n)),
                range(least(|point| point.least), most(|point| point.most)),
            ]
        })
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>, points: &[Point]) -> Result<(), Failed> {
        let Some([across, up]) = self.extent(points) else { return Ok(()) };
        let font = |size: u32| ("sans-serif", size * FINE).into_font().color(&TEXT);
        let mut chart = ChartBuilder::on(area)
            .caption(self.title, font(15))
            .margin(10 * FINE)
            .margin_right(22 * FINE)
            .x_label_area_size(42 * FINE)
            .y_label_area_size(62 * FINE)
            .build_cartesian_2d(across.clone().log_scale(), up.log_scale())?;
        chart
            .configure_mesh()
            .axis_style(AXIS.stroke_width(FINE))
            .set_all_tick_mark_size(4 * FINE)
            .bold_line_style(GRID.stroke_width(FINE))
            .light_line_style(FINE_GRID.stroke_width(FINE))
            .label_style(font(12))
            .axis_desc_style(font(13))
            .x_labels(5)
            .y_labels(6)
            .x_desc(self.across)
            .y_desc(self.up)
            .x_label_formatter(&|value| plain(*value))
            .y_label_formatter(&|value| plain(*value))
            .draw()?;
        for ((name, measured), ink) in self.series(points).zip(INKS) {
            if measured.is_empty() {
                continue;
            }
            let sizes: Vec<(f64, f64)> = measured.iter().map(|point| (point.n, point.median)).collect();
            if let Some(fit) = Fit::of(&sizes) {
                let (first, last) = (sizes[0].0, sizes[sizes.len() - 1].0);
                let steps = 60;
                let at = |step: i32| first * (last / first).powf(f64::from(step) / f64::from(steps));
                let curve: Vec<(f64, f64)> = (0..=steps).map(|step| (at(step), fit.at(at(step)))).collect();
                chart.draw_series([PathElement::new(curve, ink.stroke_width(2 * FINE))])?;
            }
            let ranges = measured
                .iter()
                .map(|it| PathElement::new([(it.n, it.least), (it.n, it.most)], ink.stroke_width(FINE)));
            chart.draw_series(ranges)?;
            chart
                .draw_series(sizes.iter().map(|at| Circle::new(*at, 4 * FINE, ink.filled())))?
                .label(name)
                .legend(move |(x, y)| Circle::new((x + 8 * FINE as i32, y), 4 * FINE, ink.filled()));
        }
        chart
            .configure_series_labels()
            .position(if self.falls {
                SeriesLabelPosition::UpperRight
            } else {
                SeriesLabelPosition::LowerRight
            })
            .margin(8 * FINE)
            .legend_area_size(18 * FINE)
            .label_font(font(12))
            .background_style(PAPER.mix(0.85))
            .draw()?;
        Ok(())
    }
}

/// A power of ten as people write it.
fn plain(value: f64) -> String {
    if (1e-3..1e6).contains(&value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:e}")
    }
}
