//! Figures: panels over one time axis, drawn as SVG, and painted as PNG.
//!
//! [`figure::Figure`] says what is to be seen, `of_plan`, `of_points`, `of_tracking` and `of_comparison` make one, [`write`] draws it.

mod axes;
mod comparison;
mod figure;
mod layout;
mod planned;
mod png;
mod points;
mod svg;
mod tracked;

pub(crate) use comparison::of_comparison;
pub(crate) use planned::of_plan;
pub(crate) use points::of_points;
pub(crate) use tracked::{Tracked, of_tracking};

use std::path::Path;

use crate::failure::Failure;
use figure::Figure;
use svg::svg;

/// Draws a figure into a file, in the format that its name says: `.png`, or SVG.
pub(crate) fn write(path: &Path, figure: &Figure) -> Result<(), Failure> {
    let svg = svg(figure)?;
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    let file = if is_png { png::png(&svg)? } else { svg.into_bytes() };
    std::fs::write(path, file).map_err(Failure::unwritable(path))
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "both ends of a step are the very same number")]
mod tests {
    use super::*;
    use planner::{
        AxisKind, AxisMoveSpec, Judged, LimitsSpec, Plan, Request, RequestSpec, ShortPathPolicy, State,
        Synchronization,
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
    fn what_somebody_else_changed_on_the_way_is_drawn_as_commanded() {
        let plan = plan(&[0.05]);
        let mut tracked = tracked(&plan);
        tracked.commanded_acceleration = vec![0.25; tracked.times.len()];
        tracked.commanded_jerk = vec![0.0; tracked.times.len()];
        let as_planned = of_tracking(&plan, &tracked);
        assert!(as_planned.subtitle.contains("cycles") && as_planned.bands.len() == 7, "{as_planned:?}");
        // From 200 ms on it rests where it is.
        let (resting, _) = tracked.commanded_position.split_at_mut(200);
        let rest = *resting.last().unwrap();
        tracked.commanded_position[200..].fill(rest);
        let changed = of_tracking(&plan, &tracked);
        assert!(changed.subtitle.ends_with("changed on the way"), "{}", changed.subtitle);
        assert_eq!(changed.bands.iter().map(|band| band.from).collect::<Vec<_>>(), [0.0, 0.2]);
        let acceleration = changed.panels.iter().find(|panel| panel.title == "Acceleration").unwrap();
        assert!(acceleration.series[0].points.iter().all(|point| point.1 == 0.25));
    }

    #[test]
    fn long_curves_keep_their_extremes() {
        let mut points: Vec<_> = (0..1_000_000).map(|index| (f64::from(index), 0.0)).collect();
        points[123_456].1 = 1.0;
        points[654_321].1 = -1.0;
        let kept = planned::decimated(points, 1e6);
        assert!(kept.len() < 10_000, "{}", kept.len());
        assert!(kept.contains(&(123_456.0, 1.0)) && kept.contains(&(654_321.0, -1.0)));
    }
}
