//! The committed questions about one axis from any state to any state, with the answers of Ruckig 0.19.4 (Berscheid and Kröger, 2021), and
//! those that it refuses although they are valid.

use planner::{BoundsSpec, State};
use serde::Deserialize;

/// A question, and how long the peer takes.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Record {
    pub(crate) kind: String,
    p0: f64,
    v0: f64,
    a0: f64,
    pf: f64,
    vf: f64,
    af: f64,
    pub(crate) vmax: f64,
    pub(crate) vmin: f64,
    pub(crate) amax: f64,
    pub(crate) amin: f64,
    pub(crate) jmax: f64,
    /// 0, or why the peer refused.
    pub(crate) result: i32,
    /// \[s\]
    pub(crate) duration: Option<f64>,
}

impl Record {
    pub(crate) fn start(&self) -> State {
        State { position: self.p0, velocity: self.v0, acceleration: self.a0 }
    }

    pub(crate) fn goal(&self) -> State {
        State { position: self.pf, velocity: self.vf, acceleration: self.af }
    }

    pub(crate) fn bounds(&self) -> BoundsSpec {
        BoundsSpec {
            min_velocity: self.vmin,
            max_velocity: self.vmax,
            min_acceleration: self.amin,
            max_acceleration: self.amax,
            max_jerk: self.jmax,
        }
    }
}

pub(crate) fn records() -> Vec<Record> {
    serde_json::from_str(include_str!("../vectors/states.json")).unwrap()
}

/// A question of one axis or more, one number for each.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Failure {
    pub(crate) kind: u32,
    p0: Vec<f64>,
    v0: Vec<f64>,
    a0: Vec<f64>,
    pf: Vec<f64>,
    vf: Vec<f64>,
    af: Vec<f64>,
    pub(crate) vmax: Vec<f64>,
    pub(crate) amax: Vec<f64>,
    pub(crate) jmax: Vec<f64>,
}

impl Failure {
    pub(crate) fn axes(&self) -> usize {
        self.p0.len()
    }

    pub(crate) fn start(&self, axis: usize) -> State {
        State { position: self.p0[axis], velocity: self.v0[axis], acceleration: self.a0[axis] }
    }

    pub(crate) fn goal(&self, axis: usize) -> State {
        State { position: self.pf[axis], velocity: self.vf[axis], acceleration: self.af[axis] }
    }
}

pub(crate) fn failures() -> Vec<Failure> {
    serde_json::from_str(include_str!("../vectors/peer_failures.json")).unwrap()
}
