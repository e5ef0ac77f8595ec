//! What the stories stand on: a server on a free port of this machine, and the moves that they are about.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::missing_panics_doc,
    reason = "helpers of tests fail by panicking"
)]

mod certificates;
mod line;
mod network;
mod plant;
mod process;
mod readings;
mod reflected;
mod rig;

use std::net::SocketAddr;

pub use certificates::{Authority, Identity};
use client::Client;
pub use line::{Line, Proxy, carry_all};
pub use network::{Axis, Faults, Network};
use planner::{
    Accepted, AxisKind, AxisMoveSpec, Judged, JudgedPvt, LimitsSpec, PvtAxisSpec, PvtInterpolation,
    PvtPolicy, PvtRequest, PvtRequestSpec, Request, RequestSpec, ShortPathPolicy, State, Synchronization,
};
pub use plant::{Costs, Fleet, Heirs, Life, Mortality, Outcome, Plant, live};
pub use process::Process;
use proto::pb::planner_service_client::PlannerServiceClient;
use proto::pb::setpoint_service_client::SetpointServiceClient;
use proto::stream::{Open, Source};
pub use readings::{Traffic, cpu, cpu_with_ended, loopback, resident_kib};
pub use reflected::{Reflected, VERSIONS};
pub use rig::{Answer, Delays, Rig, difference, replay};
use server::{Address, Config, Server};
use sim_axis::SimAxis;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tonic::transport::{Channel, Endpoint};

/// A real server behind real gRPC, on this machine alone.
#[derive(Debug)]
pub struct Loopback {
    address: Address,
    http: Option<SocketAddr>,
    stop: Option<oneshot::Sender<()>>,
    serving: JoinHandle<()>,
}

impl Loopback {
    /// A server with default settings.
    pub async fn start() -> Self {
        Self::with(Config::loopback()).await
    }

    /// A server with these settings.
    pub async fn with(config: Config) -> Self {
        let server = Server::bind(config).await.expect("a free port");
        let (address, http) = (server.address().clone(), server.http_address());
        let (stop, stopped) = oneshot::channel();
        let serving = tokio::spawn(async move {
            let stop = async {
                // Dropped is stopped too.
                let _ = stopped.await;
            };
            server.run(stop).await.expect("served");
        });
        Self { address, http, stop: Some(stop), serving }
    }

    /// Where it is, for those who come with encryption; certificates name this machine as `localhost`.
    #[must_use]
    pub fn secure_endpoint(&self) -> String {
        format!("https://localhost:{}", self.address.port().expect("a port"))
    }

    /// Where it is.
    #[must_use]
    pub fn endpoint(&self) -> String {
        self.address.endpoint()
    }

    /// A page of its side port.
    #[must_use]
    pub fn page(&self, path: &str) -> String {
        format!("http://{}{path}", self.http.expect("a side port"))
    }

    /// A typed client.
    pub async fn client(&self) -> Client {
        Client::connect(&self.endpoint()).await.expect("a server")
    }

    /// A bare connection, for what no client of ours would say.
    pub async fn channel(&self) -> Channel {
        Endpoint::from_shared(self.endpoint()).expect("an address").connect().await.expect("a server")
    }

    /// The generated planner client.
    pub async fn planner(&self) -> PlannerServiceClient<Channel> {
        PlannerServiceClient::new(self.channel().await)
    }

    /// The generated setpoint client.
    pub async fn setpoints(&self) -> SetpointServiceClient<Channel> {
        SetpointServiceClient::new(self.channel().await)
    }

    /// Tells the server to stop, as SIGTERM does.
    pub fn tell_to_stop(&mut self) {
        if let Some(stop) = self.stop.take() {
            let _ = stop.send(());
        }
    }

    /// Waits until the server has stopped.
    pub async fn stopped(self) {
        self.serving.await.expect("the server stops by itself");
    }
}

/// A real axis simulator behind real gRPC, on this machine alone.
#[derive(Debug)]
pub struct LoopbackAxis {
    address: Address,
    http: Option<SocketAddr>,
    stop: Option<oneshot::Sender<()>>,
    serving: JoinHandle<()>,
}

impl LoopbackAxis {
    /// A simulator of ideal axes.
    pub async fn start() -> Self {
        Self::with(sim_axis::Config::loopback()).await
    }

    /// A simulator with these settings.
    pub async fn with(config: sim_axis::Config) -> Self {
        let axis = SimAxis::bind(config).await.expect("a free port");
        let (address, http) = (axis.address().clone(), axis.http_address());
        let (stop, stopped) = oneshot::channel();
        let serving = tokio::spawn(async move {
            let stop = async {
                // Dropped is stopped too.
                let _ = stopped.await;
            };
            axis.run(stop).await.expect("served");
        });
        Self { address, http, stop: Some(stop), serving }
    }

    /// Where it is, for those who come with encryption; certificates name this machine as `localhost`.
    #[must_use]
    pub fn secure_endpoint(&self) -> String {
        format!("https://localhost:{}", self.address.port().expect("a port"))
    }

    /// Where it is.
    #[must_use]
    pub fn endpoint(&self) -> String {
        self.address.endpoint()
    }

    /// A page of its side port.
    #[must_use]
    pub fn page(&self, path: &str) -> String {
        format!("http://{}{path}", self.http.expect("a side port"))
    }

    /// A bare connection, for what no client of ours would say.
    pub async fn channel(&self) -> Channel {
        Endpoint::from_shared(self.endpoint()).expect("an address").connect().await.expect("a simulator")
    }

    /// Tells the simulator to stop, as SIGTERM does.
    pub fn tell_to_stop(&mut self) {
        if let Some(stop) = self.stop.take() {
            let _ = stop.send(());
        }
    }

    /// Waits until the simulator has stopped.
    pub async fn stopped(self) {
        self.serving.await.expect("the simulator stops by itself");
    }
}

/// The move of the papers: 50 mm within 0.25 m/s, 3 m/s² and 100 m/s³; 314 cycles of 1 ms.
#[must_use]
pub fn fifty_millimetres() -> RequestSpec {
    move_of(0.05, 0.25)
}

/// A move of `distance` \[m\] at `velocity` \[m/s\].
#[must_use]
pub fn move_of(distance: f64, velocity: f64) -> RequestSpec {
    let limits = LimitsSpec {
        max_velocity: velocity,
        max_acceleration: 3.0,
        max_jerk: 100.0,
        ..LimitsSpec::default()
    };
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(distance),
        limits,
    };
    RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(planner::Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    }
}

/// Plans in this process.
#[must_use]
pub fn planned(spec: RequestSpec) -> Accepted {
    Judged::answer(&Request::try_from(spec).expect("a request"))
        .expect("a plan")
        .accepted()
        .expect("a good plan")
}

/// The same move of so many axes, `x0` and on, each a little farther than the one before it, all arriving together.
#[must_use]
pub fn together(axes: usize, spec: &RequestSpec) -> RequestSpec {
    let of = |number: usize| {
        spec.axes.iter().cloned().map(move |mut axis| {
            axis.axis = format!("{}{number}", axis.axis);
            axis.goal.position *= 1.0 - 0.5 * number as f64 / axes as f64;
            axis
        })
    };
    RequestSpec {
        axes: (0..axes).flat_map(of).collect(),
        synchronization: Ok(Synchronization::Time),
        ..spec.clone()
    }
}

/// A swing of 0.1 m in 2π s through so many points of so many axes, evenly spread over `seconds`.
#[must_use]
pub fn swing(axes: usize, points: usize, seconds: f64) -> PvtRequestSpec {
    let times: Vec<f64> = (1..=points).map(|number| seconds * number as f64 / points as f64).collect();
    let axis = |number: usize| {
        let angle = |time: f64| time + number as f64;
        PvtAxisSpec {
            axis: format!("x{number}"),
            kind: Ok(AxisKind::Prismatic),
            limits: LimitsSpec {
                max_velocity: 0.5,
                max_acceleration: 4.0,
                max_jerk: 160.0,
                ..LimitsSpec::default()
            },
            start: State { velocity: 0.1 * angle(0.0).cos(), ..State::default() },
            positions: times.iter().map(|&time| 0.1 * (angle(time).sin() - angle(0.0).sin())).collect(),
            velocities: times.iter().map(|&time| 0.1 * angle(time).cos()).collect(),
            times: times.clone(),
        }
    };
    PvtRequestSpec {
        axes: (0..axes).map(axis).collect(),
        cycle_time_ns: None,
        interpolation: Ok(PvtInterpolation::SShaped),
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: false,
    }
}

/// Plans points in this process.
#[must_use]
pub fn planned_pvt(spec: PvtRequestSpec) -> Accepted {
    let judged = JudgedPvt::answer(&PvtRequest::try_from(spec).expect("a request")).expect("a plan");
    judged.judged().clone().accepted().expect("a good plan")
}

/// Opens `plan` on stream `stream`, to close at rest.
#[must_use]
pub fn open(stream: &str, plan: Accepted) -> Open {
    Open {
        stream: stream.into(),
        epoch: 1,
        lead_cycles: 40,
        batch_cycles: 10,
        axis_guard: 2,
        close_at_rest: true,
        accept_unproved: false,
        compact: false,
        executed_cycle: 0,
        source: Source::Plan(plan),
    }
}
