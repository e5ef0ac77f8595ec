//! Motions of a given duration: each one that is allowed is planned and legal, each one that is blocked is refused, and the borders
//! between both are where they are said to be. More of them:
//!
//! ```text
//! cargo test --release -p portamento-planner --test durations -- --ignored --nocapture
//! ```

#![allow(
    clippy::float_cmp,
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking; this one also reports, and compares what is to be the same number"
)]

mod common;

use common::Random;
use common::states::{Kind, Question, question};
use planner::{AxisTransfer, NoSuchDuration, Transit, transfer_violations};

/// Of a duration [1]: how far beside a border a motion is asked for.
const BESIDE: f64 = 1e-9;
/// Of the scale of a motion [1]: how far its pieces may be apart.
const END: f64 = 1e-12;

/// A time in which nothing moves [s], or as good as nothing: positions are not known better.
const NOTHING: f64 = 1e-12;

#[track_caller]
fn check_legal(asked: &Question, duration: f64, planned: &Transit) {
    let found = transfer_violations(&planned.to_profile(), &asked.bounds(), asked.goal);
    assert_eq!(found, [], "{asked:?} in {duration}: {planned:?}");
    let off = common::transit::residual(planned, asked.bounds.max_jerk);
    assert!(off <= END, "{off:e} apart: {asked:?} in {duration}: {planned:?}");
    let lasts = planned.duration();
    assert!((lasts - duration).abs() <= 4.0 * f64::EPSILON * duration, "{lasts}, not {duration}: {asked:?}");
    assert_eq!((planned.start(), planned.end()), (asked.start, asked.goal));
}

#[derive(Default)]
struct Tally {
    blocked: [u32; 7],
    most_pieces: usize,
}

impl Tally {
    fn scan(&mut self, random: &mut Random, asked: &Question) {
        let axis = AxisTransfer::from(asked.transfer());
        let arrivals = axis.arrivals().unwrap();
        let least = arrivals.least();
        assert_eq!(least, axis.fastest().unwrap().duration());
        let blocked = arrivals.blocked();
        self.blocked[blocked.len()] += 1;
        // Far from zero a way is known to what positions are rounded to, and a border to whatever that makes of it.
        let exact = asked.start.position == 0.0;
        let mut before = least;
        for interval in blocked {
            assert!(before <= interval.after && interval.after < interval.before, "{asked:?}: {arrivals:?}");
            before = interval.before;
        }
        let inside = |duration: f64, margin: f64| {
            let deep = |border: f64| (duration - border).abs() > margin * border + NOTHING;
            let inside = blocked.iter().find(|blocked| blocked.after < duration && duration < blocked.before);
            inside.is_some_and(|blocked| margin == 0.0 || (deep(blocked.after) && deep(blocked.before)))
        };
        let mut durations: Vec<f64> = (0..6).map(|_| least * (1.0 + random.decades(1e-6, 1e3))).collect();
        for interval in blocked {
            let last = interval.before.min(1e3 * interval.after);
            durations.extend([
                interval.after,
                last,
                interval.after + random.unit() * (last - interval.after),
            ]);
            if interval.before - interval.after > 4.0 * BESIDE * interval.before {
                durations.extend([interval.after * (1.0 + BESIDE), last * (1.0 - BESIDE)]);
            }
            durations.extend([interval.after * (1.0 - BESIDE), last * (1.0 + BESIDE)]);
        }
        for duration in durations.into_iter().filter(|duration| *duration <= planner::LONGEST) {
            match axis.lasting(duration) {
                Ok(planned) => {
                    assert!(
                        !(exact && inside(duration, 0.5 * BESIDE)),
                        "{duration} is blocked: {asked:?}: {arrivals:?}: {planned:?}"
                    );
                    self.most_pieces = self.most_pieces.max(planned.segments().len());
                    check_legal(asked, duration, &planned);
                }
                Err(NoSuchDuration::TooShort { .. }) => assert!(duration < least),
                Err(refusal) => assert!(inside(duration, 0.0), "{refusal}: {asked:?}: {arrivals:?}"),
            }
        }
    }
}

fn scan(count: u32, seed: u64) {
    for kind in Kind::ALL {
        let (mut random, mut tally) = (Random(seed), Tally::default());
        for _ in 0..count / Kind::ALL.len() as u32 {
            let asked = question(&mut random, kind);
            tally.scan(&mut random, &asked);
        }
        println!("{kind:?}: blocked intervals {:?}, pieces {}", tally.blocked, tally.most_pieces);
    }
}

#[test]
fn what_is_allowed_is_planned_and_what_is_blocked_is_refused() {
    scan(7_000, 1);
}

#[test]
#[ignore = "a minute in release"]
fn what_is_allowed_is_planned_and_what_is_blocked_is_refused_in_many() {
    scan(700_000, 2);
}
