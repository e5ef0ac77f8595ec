//! A servo drive and the axis behind it, as physics: setpoints in, positions and efforts out.
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets")]

mod audit;
mod delay;
mod discretise;
mod encoder;
mod friction;
mod interpolate;
mod model;
mod monitor;
mod noise;
mod plant;
mod servo;
mod vibration;

pub use audit::{InvalidField, InvalidModel};
pub use encoder::{Encoder, Measured};
pub use interpolate::Quintic;
pub use model::{AxisModel, AxisModelSpec, EncoderSpec, FrictionSpec, LoadSpec, MechanicsSpec, ServoSpec};
pub use monitor::ReportCard;
pub use plant::Plant;
pub use servo::{Decision, Memory, Servo};
