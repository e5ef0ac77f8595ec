//! A servo drive and the axis behind it: setpoints in, positions and efforts out; and the runs in which such axes follow a
//! stream.
//!
//! # The physics
//! Start at [`Axis::step`], one cycle of one axis: read, decide, apply, observe. Then read in this order:
//! - [`AxisModelSpec`], [`AxisModel`]: what an axis is made of, before and after it was checked
//! - [`Quintic`]: what a drive makes of two setpoints, between them
//! - [`Encoder`], [`Measured`]: what the drive sees of the motor
//! - [`Servo`], [`Decision`]: position, velocity and current loops, as a pure function
//! - [`Plant`]: motor, spring and load; the exact step over one substep
//! - [`ReportCard`]: how well the axis followed, and how it came to rest
//!
//! Nothing of this reads a clock, sleeps or allocates while it steps: the same setpoints give the same numbers,
//! bit for bit, whether a cycle lasts a millisecond of wall clock or a microsecond of a test.
//!
//! # The runs
//! - [`Player`]: several axes that play one stream, cycle by cycle; pure as well
//! - [`track`], [`Tracking`]: opens a stream and runs a player on a thread of its own, by the wall clock or in virtual time
//! - [`SimAxis`]: the same for callers over gRPC
//!
//! # Words and units
//! *Substep*: the drive's own period [s], 50 to 100 µs; a cycle has a whole number of them. *Effort*: the
//! motor's force [N] or torque [N m]. *Inertia*: a mass [kg] or a moment of inertia [kg m²]. *Mechanical
//! units*: metres or radians. *Axis units*: those of the setpoints; mechanical units, or pulses where a model
//! says how many pulses make a unit. Following error is commanded minus measured: positive while an axis lags
//! in the positive direction.
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets")]

mod audit;
mod axis;
mod clock;
mod commands;
mod config;
mod cycle_thread;
mod delay;
mod discretise;
mod encoder;
mod faults;
mod figures;
mod friction;
mod interpolate;
mod jitter;
mod model;
mod models;
mod monitor;
mod noise;
mod plant;
mod player;
mod rpc;
mod run;
mod samples;
mod service;
mod servo;
mod stability;
mod vibration;
mod watched;

pub use audit::{InvalidField, InvalidModel};
pub use axis::{Axis, AxisConfig, InvalidConfig, Observation};
pub use clock::{Clock, lateness_of};
pub use commands::{Answered, Commander};
pub use config::Config;
pub use encoder::{Encoder, Measured};
pub use faults::{Fault, Faults};
pub use interpolate::Quintic;
pub use jitter::{Jitter, Lateness};
pub use model::{AxisModel, AxisModelSpec, EncoderSpec, FrictionSpec, LoadSpec, MechanicsSpec, ServoSpec};
pub use models::{InvalidModels, Models};
pub use monitor::ReportCard;
pub use plant::Plant;
pub use player::{Beat, Divergence, Player};
pub use rpc::{ModelFileError, RemoteAxis, RemoteRun, models_from_json, track_request};
pub use run::{
    DEFAULT_SETTLE_WINDOW, StreamReport, TrackError, TrackRequest, Tracking, TrackingReport, Update,
    default_settle_tolerance, track,
};
pub use samples::Samples;
pub use service::SimAxis;
pub use serving::{Misfits, ServeError, Settings};
pub use servo::{Decision, Memory, Servo};
