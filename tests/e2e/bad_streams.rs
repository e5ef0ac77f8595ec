//! Axes that vanish, never grant, grant for ever, speak out of turn: the server stays as it was, and its memory bounded.

use std::time::Duration;

use client::{Client, Error, Setpoints};
use e2e::{Loopback, fifty_millimetres, move_of, open, planned};
use proto::pb::stream_setpoints_request::Message;
use proto::pb::stream_setpoints_response::Message as Answer;
use proto::stream::{FARTHEST_AHEAD, FromAxis, Open};
use proto::{Reason, Rejected, pb, request_to_wire};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Status, Streaming};

/// An axis that says what it likes.
struct Rude {
    says: mpsc::Sender<pb::StreamSetpointsRequest>,
    hears: Streaming<pb::StreamSetpointsResponse>,
}

impl Rude {
    async fn connect(server: &Loopback) -> Self {
        let (says, requests) = mpsc::channel(16);
        let mut setpoints = server.setpoints().await;
        // The answer's head comes at once; what is said decides the rest.
        let hears = setpoints.stream_setpoints(ReceiverStream::new(requests)).await.unwrap().into_inner();
        Self { says, hears }
    }

    async fn say(&self, message: Option<Message>) {
        self.says.send(pb::StreamSetpointsRequest { message }).await.unwrap();
    }

    async fn open(&self, open: Open) {
        self.says.send(request_to_wire(&FromAxis::Open(Box::new(open)))).await.unwrap();
    }

    async fn report(&self, report: pb::AxisReport) {
        self.say(Some(Message::Report(report))).await;
    }

    async fn hear(&mut self) -> Result<Option<Answer>, Status> {
        Ok(self.hears.message().await?.and_then(|response| response.message))
    }

    /// Listens until `cycle` has come, and gives its digest.
    async fn hear_until(&mut self, cycle: u64) -> u64 {
        loop {
            if let Some(Answer::Batch(batch)) = self.hear().await.unwrap() {
                let last = batch.first_cycle + u64::from(batch.columns.unwrap().cycles) - 1;
                assert!(last <= cycle, "cycle {last} was not granted");
                if last == cycle {
                    return batch.digest;
                }
            }
        }
    }

    /// How the stream ends.
    async fn refusal(&mut self) -> Rejected {
        loop {
            match self.hear().await {
                Ok(Some(_)) => {}
                Ok(None) => panic!("the stream ended well"),
                Err(status) => {
                    return Rejected::from_status(&status)
                        .unwrap_or_else(|| panic!("no reason in {status:?}"));
                }
            }
        }
    }

    /// The reason for which the stream ends.
    async fn reason(&mut self) -> Reason {
        self.refusal().await.reason
    }

    /// Nothing comes for a while.
    async fn silence(&mut self) {
        let heard = tokio::time::timeout(Duration::from_millis(100), self.hear()).await;
        assert!(heard.is_err(), "{heard:?}");
    }
}

/// The server still plans and streams.
async fn is_unharmed(server: &Loopback) {
    let client: Client = server.client().await;
    let opening = open("unharmed", planned(fifty_millimetres()));
    let mut stream = Setpoints::open(&client, opening).await.unwrap();
    while stream.next().await.unwrap().is_some() {}
    assert_eq!(stream.buffer().executed(), 314);
}

#[tokio::test]
async fn garbage_first() {
    let server = Loopback::start().await;
    for message in [
        None,
        Some(Message::Report(pb::AxisReport::default())),
        Some(Message::Operation(pb::Operation::default())),
    ] {
        let mut axis = Rude::connect(&server).await;
        axis.say(message).await;
        assert_eq!(axis.reason().await, Reason::ProtocolOrder);
    }
    is_unharmed(&server).await;
}

#[tokio::test]
async fn a_second_open() {
    let server = Loopback::start().await;
    let mut axis = Rude::connect(&server).await;
    axis.open(open("x", planned(fifty_millimetres()))).await;
    axis.hear_until(40).await;
    axis.open(open("x", planned(fifty_millimetres()))).await;
    assert_eq!(axis.reason().await, Reason::ProtocolOrder);
    is_unharmed(&server).await;
}

#[tokio::test]
async fn an_axis_that_never_grants() {
    let server = Loopback::start().await;
    let mut axis = Rude::connect(&server).await;
    axis.open(open("x", planned(fifty_millimetres()))).await;
    axis.hear_until(40).await;
    axis.silence().await;
    is_unharmed(&server).await;
    axis.silence().await;
}

#[tokio::test]
async fn an_axis_that_grants_for_ever() {
    let server = Loopback::start().await;
    let mut axis = Rude::connect(&server).await;
    axis.open(open("x", planned(move_of(60.0, 0.1)))).await;
    let digest = axis.hear_until(40).await;
    axis.report(pb::AxisReport { accepted_cycle: 40, grant_cycle: 1 << 63, digest, ..Default::default() })
        .await;
    axis.hear_until(FARTHEST_AHEAD).await;
    axis.silence().await;
    is_unharmed(&server).await;
}

#[tokio::test]
async fn an_axis_that_vanishes() {
    let server = Loopback::start().await;
    for epoch in 1..=20 {
        let mut axis = Rude::connect(&server).await;
        axis.open(Open { epoch, ..open("x", planned(move_of(60.0, 0.1))) }).await;
        axis.hear_until(40).await;
    }
    is_unharmed(&server).await;
    // The name is free again, for whatever epoch, once the server has seen that the axis has gone.
    let client = server.client().await;
    let opened = tokio::time::timeout(Duration::from_secs(10), async {
        loop {
            match Setpoints::open(&client, open("x", planned(fifty_millimetres()))).await {
                Ok(stream) => return stream,
                Err(Error::Rejected(rejected)) => assert_eq!(rejected.reason, Reason::EpochSuperseded),
                Err(error) => panic!("{error}"),
            }
        }
    });
    opened.await.expect("the name is free");
}

#[tokio::test]
async fn reports_that_cannot_be_true() {
    let server = Loopback::start().await;
    let lies = [
        (pb::AxisReport { accepted_cycle: 41, ..Default::default() }, Reason::ProtocolOrder),
        (
            pb::AxisReport { executed_cycle: 7, accepted_cycle: 6, ..Default::default() },
            Reason::ProtocolOrder,
        ),
        (pb::AxisReport { accepted_cycle: 20, digest: 1, ..Default::default() }, Reason::DigestMismatch),
        (pb::AxisReport { revision: 9, ..Default::default() }, Reason::ProtocolOrder),
        (
            pb::AxisReport {
                refused: Some(pb::Refused { reason: "BECAUSE".into(), ..Default::default() }),
                ..Default::default()
            },
            Reason::KindUnspecified,
        ),
    ];
    for (lie, reason) in lies {
        let mut axis = Rude::connect(&server).await;
        axis.open(open("x", planned(fifty_millimetres()))).await;
        axis.hear_until(40).await;
        axis.report(lie).await;
        assert_eq!(axis.reason().await, reason);
        drop(axis);
    }
    is_unharmed(&server).await;
}

#[tokio::test]
async fn a_newer_epoch_takes_the_stream_and_an_older_one_does_not() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let opening = |epoch| Open { epoch, ..open("x", planned(fifty_millimetres())) };
    let mut first = Setpoints::open(&client, opening(5)).await.unwrap();
    let Err(Error::Rejected(older)) = Setpoints::open(&client, opening(5)).await.map(|_| ()) else {
        panic!("epoch 5 is not newer than 5");
    };
    assert_eq!((older.reason, older.metadata["current_epoch"].as_str()), (Reason::EpochSuperseded, "5"));
    let mut second = Setpoints::open(&client, opening(6)).await.unwrap();
    while second.next().await.unwrap().is_some() {}
    let ended = loop {
        match first.next().await {
            Ok(Some(_)) => {}
            other => break other.map(|_| ()),
        }
    };
    let Err(Error::Rejected(superseded)) = ended else { panic!("{ended:?}") };
    assert_eq!(superseded.reason, Reason::EpochSuperseded);
}

#[tokio::test]
async fn an_operation_is_refused_and_the_motion_goes_on() {
    let server = Loopback::start().await;
    let mut axis = Rude::connect(&server).await;
    axis.open(open("x", planned(fifty_millimetres()))).await;
    let digest = axis.hear_until(40).await;
    let faster = pb::operation::Operation::SetOverride(pb::SetOverride { factor: f64::NAN });
    let append = pb::operation::Operation::AppendPvt(pb::AppendPvt::default());
    let rows = [
        (Some(faster), Reason::OverrideOutOfRange),
        // It goes to a goal, and not through points.
        (Some(append), Reason::ProtocolOrder),
        (None, Reason::ProtocolOrder),
    ];
    for (operation, reason) in rows {
        let operation = pb::Operation { request_id: "h1".into(), operation, ..Default::default() };
        axis.say(Some(Message::Operation(operation))).await;
        let Some(Answer::Refusal(refusal)) = axis.hear().await.unwrap() else { panic!("no answer") };
        assert_eq!(refusal.request_id, "h1");
        assert_eq!(Rejected::from_bytes(&refusal.status).unwrap().reason, reason);
    }
    axis.report(pb::AxisReport { accepted_cycle: 40, grant_cycle: 50, digest, ..Default::default() }).await;
    axis.hear_until(50).await;
}

#[tokio::test]
async fn a_resume_and_an_open_without_a_plan() {
    let server = Loopback::start().await;
    let rows = [
        (Some(pb::open::Source::Resume(pb::Resume::default())), Reason::FieldMissing, "open.resume.motion"),
        (None, Reason::FieldMissing, "open.source"),
        (Some(pb::open::Source::Plan(pb::Plan::default())), Reason::NoAxes, "open.plan.axes"),
    ];
    for (source, reason, field) in rows {
        let mut axis = Rude::connect(&server).await;
        let open = pb::Open { stream: "x".into(), epoch: 1, source, ..Default::default() };
        axis.say(Some(Message::Open(Box::new(open)))).await;
        let rejected = axis.refusal().await;
        assert_eq!((rejected.reason, rejected.fields[0].field.as_str()), (reason, field));
    }
    is_unharmed(&server).await;
}

#[tokio::test]
async fn an_open_that_is_outside_what_the_schema_says() {
    let server = Loopback::start().await;
    let sound = open("x", planned(fifty_millimetres()));
    let rows = [
        (Open { stream: String::new(), ..sound.clone() }, Reason::NameInvalid, "open.stream"),
        (Open { stream: "x".repeat(257), ..sound.clone() }, Reason::NameInvalid, "open.stream"),
        (Open { stream: "x\ny".into(), ..sound.clone() }, Reason::NameInvalid, "open.stream"),
        (Open { epoch: 0, ..sound.clone() }, Reason::ValueOutOfRange, "open.epoch"),
        (Open { lead_cycles: 9, ..sound.clone() }, Reason::ValueOutOfRange, "open.lead_cycles"),
        (Open { lead_cycles: 251, ..sound.clone() }, Reason::ValueOutOfRange, "open.lead_cycles"),
        (Open { batch_cycles: 1001, ..sound.clone() }, Reason::ValueOutOfRange, "open.batch_cycles"),
        (Open { axis_guard: 40, ..sound.clone() }, Reason::ValueOutOfRange, "open.axis_guard"),
        (Open { executed_cycle: 7, ..sound.clone() }, Reason::ValueOutOfRange, "open.executed_cycle"),
    ];
    for (open, reason, field) in rows {
        let mut axis = Rude::connect(&server).await;
        axis.open(open).await;
        let rejected = axis.refusal().await;
        assert_eq!((rejected.reason, rejected.fields[0].field.as_str()), (reason, field), "{rejected:?}");
        assert!(rejected.message.contains(':'), "{field} has no way out: {}", rejected.message);
    }
    // All of it at once, and what 0 stands for is sound.
    let mut axis = Rude::connect(&server).await;
    axis.open(Open { stream: String::new(), epoch: 0, lead_cycles: 9, ..sound.clone() }).await;
    assert_eq!(axis.refusal().await.fields.len(), 3);
    let mut axis = Rude::connect(&server).await;
    axis.open(Open { lead_cycles: 0, batch_cycles: 0, axis_guard: 0, ..sound }).await;
    axis.hear_until(40).await;
    is_unharmed(&server).await;
}
