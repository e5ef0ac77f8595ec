//! What dashboards, alerts and the runbook speak of is what the processes tell, by the same names.

use std::collections::BTreeSet;
use std::net::{Ipv4Addr, SocketAddr};

use e2e::{Loopback, LoopbackAxis};

const RUNBOOK: &str = include_str!("../../deploy/README.md");
const ALERTS: &str = include_str!("../../deploy/metrics/alerts.yml");
const DASHBOARD: &str = include_str!("../../deploy/grafana/motion.json");

/// The figures that a text names: words that begin with `motion_`, without what a histogram adds to its name.
fn named(text: &str) -> BTreeSet<String> {
    let words = text.split(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_'));
    let figures = words.filter(|word| word.starts_with("motion_"));
    let whole = |word: &str| {
        let suffix = ["_bucket", "_sum", "_count"].into_iter().find_map(|suffix| word.strip_suffix(suffix));
        suffix.unwrap_or(word).to_owned()
    };
    figures.map(whole).collect()
}

/// Both processes as they have just been started: every figure is there, so that its first increase is seen.
#[tokio::test]
async fn what_is_asked_for_is_told() {
    let http = Some(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
    let mut config = server::Config::loopback();
    config.serving.http = http;
    let server = Loopback::with(config).await;
    // In this process both tell on the same page.
    let _axis = LoopbackAxis::start().await;
    let page = reqwest::get(server.page("/metrics")).await.unwrap().text().await.unwrap();
    let told: BTreeSet<String> = page
        .lines()
        .filter_map(|line| line.strip_prefix("# TYPE ")?.split(' ').next())
        .map(str::to_owned)
        .collect();
    assert!(told.len() > 15 && told.iter().all(|name| name.starts_with("motion_")), "{told:?}");
    for (whose, text) in [("alerts.yml", ALERTS), ("motion.json", DASHBOARD), ("README.md", RUNBOOK)] {
        let unknown: Vec<_> = named(text).difference(&told).cloned().collect();
        assert!(unknown.is_empty(), "{whose} asks for {unknown:?}, and told are {told:?}");
    }
    let table: Vec<&str> = RUNBOOK.lines().filter(|line| line.starts_with("| `motion_")).collect();
    let unnamed: Vec<_> = told.difference(&named(&table.join("\n"))).cloned().collect();
    assert!(unnamed.is_empty(), "the table of the runbook leaves out {unnamed:?}");
}

/// Each alert has its paragraph in the runbook, and each paragraph its alert.
#[test]
fn every_alert_is_in_the_runbook() {
    let alerts: BTreeSet<&str> =
        ALERTS.lines().filter_map(|line| line.trim().strip_prefix("- alert: ")).collect();
    let paragraphs: BTreeSet<&str> = RUNBOOK
        .lines()
        .filter_map(|line| line.strip_prefix("**Motion")?.split_once("**"))
        .map(|(name, _)| name)
        .collect();
    let alerts: BTreeSet<&str> = alerts.into_iter().filter_map(|name| name.strip_prefix("Motion")).collect();
    assert!(alerts.len() >= 10);
    assert_eq!(alerts, paragraphs);
}
