//! `deploy/up.sh`: the whole plant by one command, restarted under an axis that moves, with its figures.

use std::process::{Command, Stdio};
use std::time::Duration;

use client::Client;
use e2e::{fifty_millimetres, move_of, planned};
use sim_axis::{RemoteAxis, TrackRequest};

use crate::cell::undisturbed;
use crate::engine::{self, docker};

/// Where compose puts it.
const BALANCER: &str = "http://127.0.0.1:50050";
const AXES: [&str; 2] = ["http://127.0.0.1:50052", "http://127.0.0.1:50053"];
const PROMETHEUS: &str = "http://127.0.0.1:9099";

/// The plant, until this is dropped.
struct Plant;

impl Plant {
    fn up() -> Self {
        let done = script(&[]).status().expect("the script runs");
        assert!(done.success(), "deploy/up.sh failed");
        Self
    }
}

impl Drop for Plant {
    fn drop(&mut self) {
        let _ = script(&["down"]).output();
    }
}

fn script(arguments: &[&str]) -> Command {
    let mut command = Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy/up.sh"));
    command.args(arguments).env("TAG", "e2e").stdin(Stdio::null());
    command
}

/// What Prometheus says; waits until it says so, as it asks once a second.
#[expect(clippy::disallowed_methods, reason = "Prometheus asks on its own clock; nothing tells us")]
async fn figure(query: &str, is_enough: impl Fn(f64) -> bool) {
    let mut said = String::new();
    for _ in 0..60 {
        let page = format!("{PROMETHEUS}/api/v1/query");
        let asked = reqwest::Client::new().get(page).query(&[("query", query)]).send().await;
        if let Ok(answer) = asked {
            said = answer.text().await.unwrap_or_default();
            // {"data":{"result":[{"value":[TIME,"VALUE"]}]}}
            let value = said.rsplit(",\"").next().and_then(|rest| rest.split('"').next());
            if value.and_then(|value| value.parse().ok()).is_some_and(&is_enough) {
                return;
            }
        }
        tokio::time::sleep(Duration::from_millis(500)).await;
    }
    panic!("{query}: {said}");
}

/// The planners' containers.
fn planners() -> Vec<String> {
    let filters = ["label=com.docker.compose.project=portamento", "label=com.docker.compose.service=planner"];
    let listed = docker(&["ps", "--quiet", "--filter", filters[0], "--filter", filters[1]]);
    listed.lines().map(str::to_owned).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_plant_comes_up_and_is_restarted_without_a_missed_cycle() {
    if !engine::is_there() {
        return;
    }
    let _plant = Plant::up();
    figure("sum(up{job=\"planner\"})", |up| up == 3.0).await;
    figure("sum(up{job=\"axis\"})", |up| up == 2.0).await;
    // Through the balancer a call goes to any of them.
    let client = Client::connect(BALANCER).await.unwrap();
    for _ in 0..30 {
        assert!(client.plan(fifty_millimetres()).await.is_ok());
    }
    figure("count(motion_plan_seconds_count{family=\"s_curve\"} > 0)", |replicas| replicas >= 2.0).await;

    let mut runs = Vec::new();
    for (index, axis) in AXES.into_iter().enumerate() {
        let plan = planned(move_of(6.0, 0.25));
        let mut request = TrackRequest::new(format!("cell-7/{index}"), "http://balancer:50050", plan);
        request.lead_cycles = 250;
        let mut run = RemoteAxis::connect(axis).await.unwrap().track(request).await.unwrap();
        assert!(run.next().await.unwrap().is_some(), "it moves");
        runs.push(tokio::spawn(undisturbed(run, 6.0)));
    }
    let planners = planners();
    assert_eq!(planners.len(), 3);
    for planner in &planners {
        docker(&["restart", "--time", "20", planner]);
        // The balancer has to see it before the next one goes.
        figure("sum(haproxy_backend_active_servers{proxy=\"streams\"})", |active| active == 3.0).await;
    }
    let mut failovers = 0;
    for run in runs {
        failovers += run.await.unwrap().stream.failovers;
    }
    assert!(failovers >= 2, "{failovers}");
    figure("sum(motion_underruns_total)", |underruns| underruns == 0.0).await;
}
