//! A cell behind certificates: planners and an axis that know each other by those of one authority, under a policy.

use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use client::Connect;
use e2e::{Authority, move_of, planned};
use sim_axis::{RemoteAxis, RemoteRun, TrackRequest, TrackingReport};

use crate::engine::{Container, Network};

const AXIS: &str = "spiffe://plant/cell-7/axis-x";
const CONTROLLER: &str = "spiffe://plant/cell-7/controller";

pub(crate) struct Cell {
    pub(crate) network: Network,
    authority: Authority,
    files: PathBuf,
}

impl Cell {
    pub(crate) fn new(story: &str) -> Self {
        let files = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{story}-{}", std::process::id()));
        Self { network: Network::new(story), authority: Authority::default(), files }
    }

    /// Starts `image` as `name` with a certificate of these names, made for it now.
    fn start(&self, image: &str, name: &str, port: u16, names: &[&str], arguments: &[&str]) -> Container {
        let directory = self.files.join(name);
        std::fs::create_dir_all(&directory).unwrap();
        // The process in the container is nobody that this machine knows.
        std::fs::set_permissions(&directory, std::fs::Permissions::from_mode(0o755)).unwrap();
        let identity = self.authority.vouch_for_all(names);
        let policy = include_str!("../../deploy/config/policy.toml").to_owned();
        for (file, text) in [
            ("ca.pem", self.authority.pem()),
            ("certificate.pem", identity.certificate),
            ("key.pem", identity.key),
            ("policy.toml", policy),
        ] {
            std::fs::write(directory.join(file), text).unwrap();
        }
        let mut all = vec![
            "--tls-cert=/files/certificate.pem",
            "--tls-key=/files/key.pem",
            "--tls-client-ca=/files/ca.pem",
            "--policy=/files/policy.toml",
        ];
        all.extend(arguments);
        Container::start_with(&self.network, image, name, port, &[&directory], &all)
    }

    pub(crate) fn planner(&self, name: &str) -> Container {
        self.planner_called(name, name)
    }

    /// One that its callers know as `known_as`, and that the network has as `name`.
    pub(crate) fn planner_called(&self, known_as: &str, name: &str) -> Container {
        self.start("server", name, 50051, &[known_as], &[])
    }

    pub(crate) fn axis(&self) -> Container {
        let arguments = [
            "--tls-ca=/files/ca.pem",
            "--tls-identity-cert=/files/certificate.pem",
            "--tls-identity-key=/files/key.pem",
        ];
        self.start("sim-axis", "axis", 50052, &[AXIS, "axis"], &arguments)
    }

    /// How the controller connects to what is called `name` on the network.
    pub(crate) fn controller(&self, name: &str) -> Connect {
        self.authority.connect_as(CONTROLLER).with_server_name(name)
    }

    /// The axis begins a move of `distance` [m] in real time, at 0.25 m/s, streamed by one of `planners`.
    pub(crate) async fn begin(&self, axis: &Container, planners: &[&str], distance: f64) -> RemoteRun {
        let plan = planned(move_of(distance, 0.25));
        let mut request = TrackRequest::new("cell-7/x", String::new(), plan);
        request.endpoints = planners.iter().map(|name| format!("https://{name}:50051")).collect();
        // A machine that is shared stalls for longer than forty cycles now and then.
        request.lead_cycles = 250;
        let remote = RemoteAxis::connect_by(&self.controller("axis"), &axis.secure_endpoint()).await.unwrap();
        let mut run = remote.track(request).await.unwrap();
        assert!(run.next().await.unwrap().is_some(), "it moves");
        run
    }
}

impl Drop for Cell {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.files);
    }
}

/// Waits for the end of a run: not a cycle is missed, and what was played is the plan, bit for bit.
pub(crate) async fn undisturbed(mut run: RemoteRun, distance: f64) -> TrackingReport {
    while run.next().await.unwrap().is_some() {}
    let report = run.finish().unwrap();
    let plan = planned(move_of(distance, 0.25));
    assert_eq!(report.stream.cycles_executed, plan.plan().cycle_count());
    assert_eq!(report.stream.counters.underruns, 0, "{:?}", report.stream);
    assert!(!report.stream.stop_tail_used, "{:?}", report.stream);
    let mut sampling = proto::Sampling::new(plan, 0, 0).unwrap();
    let mut digest = proto::Digest::ZERO;
    while !sampling.is_over() {
        digest = sampling.read().map_or(digest, |chunk| chunk.digest);
    }
    assert_eq!(report.stream.digest, digest);
    report
}
