//! Who is let in: certificates on both sides, and a policy of who may do what.

use std::time::Duration;

use client::{Client, Connect, Error, Setpoints};
use e2e::{Authority, Loopback, LoopbackAxis, fifty_millimetres, open, planned};
use proto::stream::{Ask, Operation, Watch};
use proto::{Reason, Rejected};
use serving::Policy;
use sim_axis::{RemoteAxis, TrackRequest};
use tonic::Code;

const AXIS: &str = "spiffe://plant/cell-7/axis";
const CONTROLLER: &str = "controller.plant";
const STRANGER: &str = "spiffe://plant/cell-8/axis";

const POLICY: &str = r#"
    [[grant]]
    identity = "spiffe://plant/cell-7/*"
    methods = ["motion.v1.SetpointService/*", "motion.v1.SimAxisService/*"]
    streams = ["cell-7/*"]
    [[grant]]
    identity = "spiffe://plant/cell-8/*"
    methods = ["motion.v1.SetpointService/*", "motion.v1.SimAxisService/*"]
    streams = ["cell-8/*"]
    [[grant]]
    identity = "controller.plant"
    methods = ["motion.v1.PlannerService/*", "motion.v1.SimAxisService/*"]
    streams = ["*"]
"#;

async fn server(authority: &Authority, policy: Option<&str>) -> Loopback {
    let mut config = server::Config::loopback();
    config.serving.tls = Some(authority.server());
    config.serving.policy = policy.map(|text| Policy::parse(text).unwrap());
    Loopback::with(config).await
}

async fn client(authority: &Authority, name: &str, server: &Loopback) -> Client {
    authority.connect_as(name).to(&server.secure_endpoint()).await.unwrap()
}

#[track_caller]
fn reason<T: std::fmt::Debug>(answer: Result<T, Error>) -> Reason {
    match answer {
        Err(Error::Rejected(rejected)) => rejected.reason,
        other => panic!("{other:?} is no refusal"),
    }
}

fn hold() -> Operation {
    Operation { request_id: "one".into(), not_before_cycle: None, ask: Some(Ask::Hold) }
}

#[tokio::test]
async fn only_those_are_let_in_whom_the_authority_vouches_for() {
    let (authority, other) = (Authority::default(), Authority::default());
    let server = server(&authority, None).await;
    let endpoint = server.secure_endpoint();
    let judged = client(&authority, AXIS, &server).await.plan(fifty_millimetres()).await.unwrap();
    assert!(judged.certificate().passed());

    let nobody = Connect::new().with_authority(authority.pem());
    let of_another = {
        let identity = other.vouch_for(AXIS);
        Connect::new().with_authority(authority.pem()).with_identity(identity.certificate, identity.key)
    };
    for stranger in [nobody, of_another] {
        // The server tells who it does not let in after the handshake, which for the client is then done.
        let answer = match stranger.to(&endpoint).await {
            Ok(client) => client.plan(fifty_millimetres()).await.map(|_| ()),
            Err(error) => Err(error),
        };
        assert!(matches!(answer, Err(Error::Unreachable { .. })), "{answer:?}");
    }
    // Who does not know the server's authority does not trust it, nor who expects somebody else.
    for wary in [other.connect_as(AXIS), authority.connect_as(AXIS).with_server_name("elsewhere")] {
        let answer = wary.to(&endpoint).await.map(|_| ());
        assert!(matches!(answer, Err(Error::Unreachable { .. })), "{answer:?}");
    }
    // In plain text nothing is answered.
    let plain = Client::connect(&server.endpoint()).await;
    let answer = match plain {
        Ok(client) => client.plan(fifty_millimetres()).await.map(|_| ()),
        Err(error) => Err(error),
    };
    assert!(matches!(answer, Err(Error::Unreachable { .. })), "{answer:?}");
    // And without an authority there is nobody to trust.
    assert!(matches!(Connect::new().to(&endpoint).await, Err(Error::Address { .. })));
}

#[tokio::test]
async fn a_policy_says_who_may_do_what() {
    let authority = Authority::default();
    let server = server(&authority, Some(POLICY)).await;
    let controller = client(&authority, CONTROLLER, &server).await;
    let axis = client(&authority, AXIS, &server).await;
    let stranger = client(&authority, STRANGER, &server).await;
    let plan = planned(fifty_millimetres());

    assert!(controller.plan(fifty_millimetres()).await.is_ok());
    assert_eq!(reason(axis.plan(fifty_millimetres()).await), Reason::MethodNotAllowed);
    let mut stream = Setpoints::open(&axis, open("cell-7/x", plan.clone())).await.unwrap();
    assert!(stream.next().await.unwrap().is_some());
    // A stream of others, one that there is and one that there is not, is refused alike.
    let mut refusals = Vec::new();
    for name in ["cell-7/x", "cell-7/y"] {
        let opened = Setpoints::open(&stranger, open(name, plan.clone())).await.map(|_| ());
        let commanded = stranger.control(name, hold()).await.map(|_| ());
        for answer in [opened, commanded] {
            let Err(Error::Rejected(rejected)) = answer else { panic!("{answer:?}") };
            assert_eq!(rejected.reason, Reason::StreamNotAllowed, "{name}");
            refusals.push(rejected.message.replace(name, "…"));
        }
    }
    refusals.dedup();
    assert_eq!(refusals.len(), 1, "{refusals:?}");
    // The controller sees all streams, and is not granted to command them.
    assert_eq!(reason(controller.control("cell-7/x", hold()).await), Reason::MethodNotAllowed);
    // Who is known and granted nothing can do nothing.
    let unknown = client(&authority, "nobody.plant", &server).await;
    assert_eq!(reason(unknown.plan(fifty_millimetres()).await), Reason::MethodNotAllowed);
    while stream.next().await.unwrap().is_some() {}
}

/// Whoever looks on sees the streams that he may use, and learns of no other: not their names, and not whether there are any.
#[tokio::test]
async fn who_looks_on_sees_what_he_may_use() {
    let authority = Authority::default();
    let server = server(&authority, Some(POLICY)).await;
    let axis = client(&authority, AXIS, &server).await;
    let stranger = client(&authority, STRANGER, &server).await;
    let plan = planned(fifty_millimetres());
    let _mine = Setpoints::open(&axis, open("cell-7/x", plan.clone())).await.unwrap();
    let _theirs = Setpoints::open(&stranger, open("cell-8/x", plan)).await.unwrap();

    let mut watching = stranger.watch(Watch::all()).await.unwrap();
    let first = watching.next().await.unwrap().expect("one that there is");
    assert_eq!(first.stream, "cell-8/x");
    // What is to be seen comes at once, one after the other: a moment later there would be the other.
    let second = tokio::time::timeout(Duration::from_millis(500), watching.next()).await;
    assert!(second.map_or(true, |next| next.unwrap().is_none_or(|seen| seen.stream == "cell-8/x")));

    let mut refusals = Vec::new();
    for name in ["cell-7/x", "cell-7/y"] {
        let seen = match stranger.watch(Watch::stream(name)).await {
            Ok(mut watching) => watching.next().await.map(|_| ()),
            Err(error) => Err(error),
        };
        let Err(Error::Rejected(rejected)) = seen else { panic!("{seen:?}") };
        assert_eq!(rejected.reason, Reason::StreamNotAllowed, "{name}");
        refusals.push(rejected.message.replace(name, "…"));
    }
    assert_eq!(refusals[0], refusals[1], "one that there is and one that there is not are refused alike");
}

/// Reflection has to be granted; health is nobody's secret.
#[tokio::test]
async fn reflection_is_a_method_like_others_and_health_is_for_all() {
    use tonic_health::pb::HealthCheckRequest;
    use tonic_health::pb::health_client::HealthClient;
    use tonic_reflection::pb::v1::ServerReflectionRequest;
    use tonic_reflection::pb::v1::server_reflection_client::ServerReflectionClient;
    use tonic_reflection::pb::v1::server_reflection_request::MessageRequest;

    let authority = Authority::default();
    let server = server(&authority, Some(POLICY)).await;
    let channel = authority.connect_as(AXIS).channel(&server.secure_endpoint()).await.unwrap();
    let health = HealthClient::new(channel.clone()).check(HealthCheckRequest::default()).await;
    assert!(health.is_ok(), "{health:?}");
    let request = ServerReflectionRequest {
        host: String::new(),
        message_request: Some(MessageRequest::ListServices(String::new())),
    };
    let listed =
        ServerReflectionClient::new(channel).server_reflection_info(tokio_stream::iter([request])).await;
    let status = listed.map(|_| ()).unwrap_err();
    assert_eq!(status.code(), Code::PermissionDenied);
    assert_eq!(Rejected::from_status(&status).unwrap().reason, Reason::MethodNotAllowed);
}

#[tokio::test]
async fn an_axis_connects_with_its_own_certificate_and_is_asked_for_callers() {
    let authority = Authority::default();
    let server = server(&authority, Some(POLICY)).await;
    let mut config = sim_axis::Config::loopback();
    config.serving.tls = Some(authority.server());
    config.serving.policy = Some(Policy::parse(POLICY).unwrap());
    config.connect = authority.connect_as(AXIS);
    let axis = LoopbackAxis::with(config).await;

    let controller =
        RemoteAxis::connect_by(&authority.connect_as(CONTROLLER), &axis.secure_endpoint()).await.unwrap();
    let plan = planned(fifty_millimetres());
    let mut request = TrackRequest::new("cell-7/x", server.secure_endpoint(), plan);
    request.clock = sim_axis::Clock::Virtual;
    let mut run = controller.track(request.clone()).await.unwrap();
    while run.next().await.unwrap().is_some() {}
    assert_eq!(run.finish().unwrap().stream.cycles_executed, 314);
    // What the controller may, the planner has yet to grant to the axis.
    request.stream = "cell-8/x".into();
    let refused = controller.track(request.clone()).await.map(|_| ());
    assert_eq!(reason(refused), Reason::StreamNotAllowed);
    // And a stranger learns of no stream by any way.
    let stranger =
        RemoteAxis::connect_by(&authority.connect_as(STRANGER), &axis.secure_endpoint()).await.unwrap();
    request.stream = "cell-7/x".into();
    assert_eq!(reason(stranger.track(request).await.map(|_| ())), Reason::StreamNotAllowed);
    assert_eq!(reason(stranger.command("cell-7/x", hold()).await), Reason::StreamNotAllowed);
    let Err(Error::Rejected(rejected)) = stranger.command("", hold()).await else { panic!("no refusal") };
    assert_eq!(rejected.reason, Reason::StreamNotHere);
    assert!(!rejected.to_string().contains("cell-7"), "{rejected}");
}

/// The name is the first that is a URI, whatever else the certificate says.
#[tokio::test]
async fn a_uri_goes_before_dns_names() {
    let authority = Authority::default();
    let server = server(&authority, Some(POLICY)).await;
    let identity = authority.vouch_for_all(&[CONTROLLER, AXIS]);
    let connect =
        Connect::new().with_authority(authority.pem()).with_identity(identity.certificate, identity.key);
    let both = connect.to(&server.secure_endpoint()).await.unwrap();
    let Err(Error::Rejected(rejected)) = both.plan(fifty_millimetres()).await else { panic!("no refusal") };
    assert_eq!(rejected.metadata["identity"], AXIS);
}

/// TLS alone, without callers' certificates, lets everybody in who trusts the server.
#[tokio::test]
async fn encryption_without_callers_certificates() {
    let authority = Authority::default();
    let identity = authority.vouch_for("localhost");
    let mut config = server::Config::loopback();
    config.serving.tls = Some(serving::Tls::new(identity.certificate.into(), identity.key.into(), None));
    let server = Loopback::with(config).await;
    let client = Connect::new().with_authority(authority.pem()).to(&server.secure_endpoint()).await.unwrap();
    assert!(client.plan(fifty_millimetres()).await.is_ok());
}
