//! Every column of numbers, with a number that is none at one place: reason and path there, and nothing wrong beside it. And the same number where
//! all moves have it in common.

use client::Client;
use e2e::{Loopback, fifty_millimetres};
use planner::{AxisMoveSpec, Shortest};
use proto::{Detail, MoveColumns, Reason};

/// A column by its name, the path of its number in a request, and how to get at both; whether it is a limit.
struct Column {
    name: &'static str,
    path: &'static str,
    column: fn(&mut MoveColumns) -> &mut Vec<f64>,
    common: fn(&mut AxisMoveSpec, f64),
    good: f64,
    is_limit: bool,
}

const COLUMNS: [Column; 12] = [
    state("start_position", "start.position", |c| &mut c.start_position, |axis, v| axis.start.position = v),
    state("start_velocity", "start.velocity", |c| &mut c.start_velocity, |axis, v| axis.start.velocity = v),
    state(
        "start_acceleration",
        "start.acceleration",
        |c| &mut c.start_acceleration,
        |axis, v| axis.start.acceleration = v,
    ),
    state("goal_position", "goal.position", |c| &mut c.goal_position, |axis, v| axis.goal.position = v),
    state("goal_velocity", "goal.velocity", |c| &mut c.goal_velocity, |axis, v| axis.goal.velocity = v),
    state(
        "goal_acceleration",
        "goal.acceleration",
        |c| &mut c.goal_acceleration,
        |axis, v| axis.goal.acceleration = v,
    ),
    limit(
        "max_velocity",
        "limits.max_velocity",
        |c| &mut c.max_velocity,
        |axis, v| axis.limits.max_velocity = v,
    ),
    limit(
        "max_acceleration",
        "limits.max_acceleration",
        |c| &mut c.max_acceleration,
        |axis, v| axis.limits.max_acceleration = v,
    ),
    limit("max_jerk", "limits.max_jerk", |c| &mut c.max_jerk, |axis, v| axis.limits.max_jerk = v),
    limit(
        "max_deceleration",
        "limits.max_deceleration",
        |c| &mut c.max_deceleration,
        |axis, v| axis.limits.max_deceleration = Some(v),
    ),
    limit(
        "max_velocity_reverse",
        "limits.max_velocity_reverse",
        |c| &mut c.max_velocity_reverse,
        |axis, v| axis.limits.max_velocity_reverse = Some(v),
    ),
    limit("feed_rate", "limits.feed_rate", |c| &mut c.feed_rate, |axis, v| axis.limits.feed_rate = Some(v)),
];

const fn state(
    name: &'static str,
    path: &'static str,
    column: fn(&mut MoveColumns) -> &mut Vec<f64>,
    common: fn(&mut AxisMoveSpec, f64),
) -> Column {
    Column { name, path, column, common, good: 0.0, is_limit: false }
}

const fn limit(
    name: &'static str,
    path: &'static str,
    column: fn(&mut MoveColumns) -> &mut Vec<f64>,
    common: fn(&mut AxisMoveSpec, f64),
) -> Column {
    Column { name, path, column, common, good: 2.0, is_limit: true }
}

const NO_NUMBERS: [f64; 4] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e61];

#[tokio::test]
async fn every_number_has_its_reason_and_place() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let mut rows = 0;
    for column in &COLUMNS {
        let bad = NO_NUMBERS.map(|number| (number, Reason::NotFinite));
        let below = [(-1.0, Reason::LimitNotPositive), (1e-61, Reason::LimitNotPositive)];
        for (number, reason) in bad.into_iter().chain(below.into_iter().filter(|_| column.is_limit)) {
            check(&client, column, number, reason).await;
            rows += 1;
        }
    }
    assert_eq!(rows, 12 * 4 + 6 * 2);
}

async fn check(client: &Client, column: &Column, number: f64, reason: Reason) {
    let Column { name, path, good, .. } = *column;
    let what = || format!("{name} {}", Shortest(number));
    let mut columns = MoveColumns::like(fifty_millimetres());
    // Something that differs, where it is not this.
    let differs =
        if name == "goal_position" { &mut columns.start_position } else { &mut columns.goal_position };
    *differs = vec![0.05, 0.06, 0.07];
    let mut apart = columns.clone();
    *(column.column)(&mut apart) = vec![good, number, good];
    let [moves] = client.plan_columns(&apart, Detail::Motion).await.unwrap().try_into().unwrap();
    let refused: Vec<_> = moves.refusals().collect();
    let [(1, rejected)] = refused.as_slice() else { panic!("{}: {refused:?}", what()) };
    assert_eq!((rejected.reason, rejected.fields.len()), (reason, 1), "{}", what());
    assert_eq!(rejected.fields[0].field, format!("columns.{name}[1]"));
    assert!(rejected.message.starts_with(&format!("columns.{name}[1]: is ")), "{rejected}");
    // In common: of each move, at one path.
    (column.common)(&mut columns.like.axes[0], number);
    let [moves] = client.plan_columns(&columns, Detail::Motion).await.unwrap().try_into().unwrap();
    let refused: Vec<_> = moves.refusals().collect();
    assert_eq!(refused.len(), 3, "{}", what());
    for (_, rejected) in refused {
        assert_eq!(rejected.fields[0].field, format!("columns.like.axes[0].{path}"), "{}", what());
        assert_eq!(rejected.reason, reason);
    }
}
