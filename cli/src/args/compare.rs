//! The flags of a comparison.

use std::path::PathBuf;

use clap::Args;

use super::{HigherLimitFlags, LimitFlags, MoveFlags, figure, scale};
use crate::law::Law;

/// Plan one move with several families, have the same simulated axis follow each, and show the differences.
///
/// The axis fits the kind of the move. In metres it is a linear motor of 6 kg on an air bearing that carries 1.5 kg on a flexible
/// mount, read by a laser to 10 nm, of 150 N. In radians it is a torque motor of 0.12 kg m² that carries 0.03 kg m² in the same way, read to
/// 0.1 urad, of 30 N m. In pulses it is the linear motor, and a pulse is a micrometre, or what --pulses-per-metre makes it. Each swings at 30 Hz
/// while the drive holds the motor, with half a percent of critical damping, and the drive's position loop has a gain of 60/s. All of it is simulated in this process, in
/// virtual time: the same request, the same numbers. Where a motor comes to the end of its effort, the table says so.
#[derive(Debug, Args)]
#[command(
    allow_negative_numbers = true,
    override_usage = "\
portamento compare --distance <U> --max-velocity <U/S>
           --max-acceleration <U/S²> --max-jerk <U/S³> [OPTIONS]
       portamento compare --request <FILE.json>... [OPTIONS]",
    after_help = "\
Limits that a polynomial needs and that are not given are chosen, and printed:
each so that its derivative takes half the time of the one below to its limit,
s = 2 j²/a, c = 2 s²/j and so on. Every limit can then be reached.

Which family leaves least swinging depends on the mount: the third order leaves
least where its jerk lasts whole periods of the swing. Here, with the limits of
the first example, it lasts 1.5. Another axis can be given with --model.

Examples:
  The move of Nguyen, Ng and Chen (2008), 50 mm at 60 mm/s, with its figures:
    portamento compare --distance 0.05 --max-velocity 0.06 \\
        --max-acceleration 0.6 --max-jerk 12 --plot compare.svg
  Every order:
    portamento compare --distance 0.05 --max-velocity 0.06 \\
        --max-acceleration 0.6 --max-jerk 12 \\
        --families polynomial:2,polynomial:3,polynomial:6,polynomial:8
  Requests from files, each with a family and limits of its own:
    portamento compare --request gentle.json brisk.json --plot both.svg"
)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) one: MoveFlags,
    #[command(flatten)]
    pub(crate) limits: LimitFlags,
    #[command(flatten)]
    pub(crate) higher: HigherLimitFlags,
    /// The families: s-curve, trapezoidal, polynomial:N with N from 2 to 8, trigonometric.
    #[arg(long, value_name = "FAMILY,...", value_delimiter = ',', value_parser = Law::named, help_heading = "Method",
        default_values_t = Law::OF_THE_PAPER)]
    pub(crate) families: Vec<Law>,
    /// Compare the PlanRequests in these files, in proto3 JSON.
    #[arg(long, value_name = "FILE.json", num_args = 1.., help_heading = "Input from files", group = "files",
        conflicts_with_all = ["MoveFlags", "LimitFlags", "HigherLimitFlags", "families"])]
    pub(crate) request: Vec<PathBuf>,
    /// What the axis that follows is made of: a list of one AxisModel, in proto3 JSON, instead of the motor of its kind.
    #[arg(long, value_name = "FILE.json", help_heading = "Input from files")]
    pub(crate) model: Option<PathBuf>,
    /// How many pulses a metre has for the linear motor that follows an axis in pulses [1/m]; 1000000 if not given.
    #[arg(long, value_name = "N", help_heading = "Axis", value_parser = scale, conflicts_with = "model")]
    pub(crate) pulses_per_metre: Option<f64>,
    /// How near to the goal counts as settled [u]; 1 um, 1 urad or one pulse if not given.
    #[arg(long, value_name = "U", help_heading = "Output")]
    pub(crate) settle_tolerance: Option<f64>,
    /// Draw the velocities over each other, and the errors of motor and load.
    #[arg(long, value_name = "FILE.svg|png", help_heading = "Output", value_parser = figure)]
    pub(crate) plot: Option<PathBuf>,
}
