//! gRPC-Web, as a browser speaks it: HTTP/1.1, across origins, for calls with one answer and with many.

use e2e::{Loopback, fifty_millimetres, planned};
use prost::Message as _;
use proto::{pb, plan_to_wire};

const ORIGIN: &str = "https://console.plant";

async fn server() -> Loopback {
    let mut config = server::Config::loopback();
    config.serving.grpc_web = true;
    config.serving.cors_origins = vec![ORIGIN.to_owned()];
    Loopback::with(config).await
}

async fn call(server: &Loopback, method: &str, message: &[u8]) -> reqwest::Response {
    let mut body = vec![0];
    body.extend(u32::try_from(message.len()).unwrap().to_be_bytes());
    body.extend(message);
    reqwest::Client::builder()
        .http1_only()
        .build()
        .unwrap()
        .post(format!("{}/{method}", server.endpoint()))
        .header("content-type", "application/grpc-web+proto")
        .header("x-grpc-web", "1")
        .header("origin", ORIGIN)
        .body(body)
        .send()
        .await
        .unwrap()
}

/// Frames of an answer: flag and bytes. Source: "gRPC Web", message framing: the flag 0x80 is that of trailers.
fn frames(mut body: &[u8]) -> Vec<(u8, Vec<u8>)> {
    let mut frames = Vec::new();
    while let [flag, a, b, c, d, rest @ ..] = body {
        let (frame, after) = rest.split_at(u32::from_be_bytes([*a, *b, *c, *d]) as usize);
        frames.push((*flag, frame.to_vec()));
        body = after;
    }
    frames
}

#[tokio::test]
async fn a_browser_plans_and_samples() {
    let server = server().await;
    let request = pb::PlanRequest::from(fifty_millimetres()).encode_to_vec();
    let answer = call(&server, "motion.v1.PlannerService/Plan", &request).await;
    assert_eq!(answer.headers()["access-control-allow-origin"], ORIGIN);
    let body = answer.bytes().await.unwrap();
    let frames = self::frames(&body);
    let plan = pb::PlanResponse::decode(frames[0].1.as_slice()).unwrap().plan.unwrap();
    assert_eq!(plan, plan_to_wire(planned(fifty_millimetres()).judged()));
    let (flag, trailers) = frames.last().unwrap();
    assert_eq!((*flag, String::from_utf8_lossy(trailers).contains("grpc-status:0")), (0x80, true));

    let sample = pb::SamplePlanRequest { plan: Some(plan), ..Default::default() }.encode_to_vec();
    let body = call(&server, "motion.v1.PlannerService/SamplePlan", &sample).await.bytes().await.unwrap();
    let cycles: u32 = self::frames(&body)
        .iter()
        .filter(|(flag, _)| *flag == 0)
        .map(|(_, chunk)| pb::SamplePlanResponse::decode(chunk.as_slice()).unwrap())
        .map(|chunk| chunk.columns.unwrap().cycles)
        .sum();
    assert_eq!(cycles, 315, "cycle 0 and the 314 of the motion");
}

#[tokio::test]
async fn a_refusal_keeps_its_reason() {
    let server = server().await;
    let answer = call(&server, "motion.v1.PlannerService/Plan", &[]).await;
    let exposed = answer.headers()["access-control-expose-headers"].to_str().unwrap().to_owned();
    assert!(exposed.contains("grpc-status-details-bin"), "{exposed}");
    let headers = format!("{:?}", answer.headers());
    let body = answer.bytes().await.unwrap();
    let said = format!("{headers}{}", String::from_utf8_lossy(&body));
    assert!(said.contains("grpc-status-details-bin") && said.contains("axes"), "{said}");
}

#[tokio::test]
async fn pages_of_other_origins_are_not_allowed() {
    let server = server().await;
    let ask = async |origin: &str| {
        let asked = reqwest::Client::new()
            .request(reqwest::Method::OPTIONS, format!("{}/motion.v1.PlannerService/Plan", server.endpoint()))
            .header("origin", origin)
            .header("access-control-request-method", "POST")
            .header("access-control-request-headers", "x-grpc-web,content-type")
            .send();
        asked.await.unwrap().headers().get("access-control-allow-origin").cloned()
    };
    assert_eq!(ask(ORIGIN).await.unwrap(), ORIGIN);
    assert_eq!(ask("https://elsewhere.example").await, None);
}

/// Where browsers are not answered, HTTP/1.1 is not spoken.
#[tokio::test]
async fn browsers_are_answered_only_where_it_is_asked_for() {
    let server = Loopback::start().await;
    let page = format!("{}/motion.v1.PlannerService/Plan", server.endpoint());
    let asked = reqwest::Client::builder().http1_only().build().unwrap().post(page).send().await;
    assert!(asked.is_err() || asked.is_ok_and(|answer| !answer.status().is_success()));
}
