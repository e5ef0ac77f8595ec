//! Bad resumes over the wire: each is refused with its reason, and nothing else is disturbed.

use e2e::{move_of, open, planned};
use planner::{Accepted, Judged, Maker};
use proto::pb::open::Source as WireSource;
use proto::pb::setpoint_service_client::SetpointServiceClient;
use proto::pb::stream_setpoints_request::Message;
use proto::stream::{FromAxis, Motion, Open, Resume, Source};
use proto::{Digest, Reason, Rejected, pb};
use tonic::transport::Channel;

use crate::replica::Replica;
use crate::run::{LEAD, Run, alone, request};

const HELD: u64 = 500;

/// An axis that has played 460 cycles of `plan` and holds 500.
fn good(plan: &Accepted) -> Open {
    let motion = Motion::opened(planner::motion::Motion::open(plan.clone()).unwrap());
    let digest = motion.digest_from((0, Digest::ZERO), HELD);
    let resume =
        Resume { motion, next_cycle: HELD + 1, digest, checkpoint_cycle: 0, checkpoint_digest: Digest::ZERO };
    Open {
        epoch: 10,
        executed_cycle: HELD - 40,
        source: Source::Resume(Box::new(resume)),
        ..open("cell-8/x", plan.clone())
    }
}

/// What comes of opening with `open`, on the wire.
async fn asked(
    client: &mut SetpointServiceClient<Channel>,
    open: pb::Open,
) -> Result<pb::StreamSetpointsResponse, Rejected> {
    let first = pb::StreamSetpointsRequest { message: Some(Message::Open(Box::new(open))) };
    // The axis says nothing more, and keeps its side open.
    let requests = tokio_stream::StreamExt::chain(tokio_stream::once(first), tokio_stream::pending());
    let refused = |status: &tonic::Status| {
        Rejected::from_status(status).unwrap_or_else(|| panic!("no reason in {status:?}"))
    };
    let mut answers =
        client.stream_setpoints(requests).await.map_err(|status| refused(&status))?.into_inner();
    answers.message().await.map(Option::unwrap).map_err(|status| refused(&status))
}

fn on_wire(open: Open, change: impl Fn(&mut pb::Open, &mut pb::Resume)) -> pb::Open {
    let wire = proto::request_to_wire(&FromAxis::Open(Box::new(open)));
    let Some(Message::Open(open)) = wire.message else { panic!("an open") };
    let mut open = *open;
    let Some(WireSource::Resume(mut resume)) = open.source.take() else { panic!("a resume") };
    change(&mut open, &mut resume);
    open.source = Some(WireSource::Resume(resume));
    open
}

#[tokio::test(flavor = "multi_thread")]
async fn every_bad_resume_is_refused_with_its_reason() {
    let _alone = alone().await;
    type Change = fn(&mut pb::Open, &mut pb::Resume);
    let rows: [(&str, Reason, &str, Change); 11] = [
        ("a forged plan", Reason::PlanRejected, "open.resume.motion.plan.axes[0].segments", |_, resume| {
            let plan = resume.motion.as_mut().unwrap().plan.as_mut().unwrap();
            plan.axes[0].segments[2].duration *= 1.5;
        }),
        ("another digest", Reason::DigestMismatch, "", |_, resume| resume.digest ^= 1),
        ("another checkpoint", Reason::DigestMismatch, "", |_, resume| {
            (resume.checkpoint_cycle, resume.checkpoint_digest) = (400, 1);
        }),
        ("past the end", Reason::ResumePastEnd, "", |open, resume| {
            (open.executed_cycle, resume.next_cycle, resume.checkpoint_cycle) = (5000, 5001, 4900);
        }),
        ("more than can be held", Reason::ValueOutOfRange, "open.resume.next_cycle", |open, resume| {
            (open.executed_cycle, open.close_at_rest) = (2000, false);
            (resume.next_cycle, resume.checkpoint_cycle) = (2042, 2000);
        }),
        ("more than a lead", Reason::ValueOutOfRange, "open.resume.next_cycle", |open, _| {
            open.executed_cycle = HELD - 41;
        }),
        ("no cycle", Reason::ValueOutOfRange, "open.resume.next_cycle", |_, resume| resume.next_cycle = 0),
        ("a checkpoint too far", Reason::ValueOutOfRange, "open.resume.checkpoint_cycle", |open, resume| {
            (open.executed_cycle, resume.next_cycle, resume.checkpoint_cycle) = (1200, 1201, 100);
        }),
        ("executed and not held", Reason::ValueOutOfRange, "open.executed_cycle", |open, _| {
            open.executed_cycle = HELD + 1
        }),
        (
            "another planner's bits",
            Reason::PlanRejected,
            "open.resume.motion.plan.evaluation_version",
            |_, resume| {
                resume.motion.as_mut().unwrap().plan.as_mut().unwrap().evaluation_version += 1;
            },
        ),
        ("no motion", Reason::FieldMissing, "open.resume.motion", |_, resume| resume.motion = None),
    ];
    let replica = Replica::start("replica").await;
    let plan = planned(move_of(0.3, 0.25));
    let run = Run::begin(request("cell-7/x", &[replica.endpoint()], &plan, LEAD)).await;
    let mut client = SetpointServiceClient::connect(replica.endpoint()).await.unwrap();
    for (what, reason, field, change) in rows {
        let refused = asked(&mut client, on_wire(good(&plan), change)).await.expect_err(what);
        let at = refused.fields.first().map_or("", |violation| violation.field.as_str());
        assert_eq!((refused.reason, at), (reason, field), "{what}: {refused}");
        if reason == Reason::DigestMismatch {
            assert_eq!(refused.metadata["cycle"], HELD.to_string(), "{what}");
        }
    }
    // What is not changed is taken; then the same epoch is of the past, and so is every one below it.
    asked(&mut client, on_wire(good(&plan), |_, _| {})).await.unwrap();
    let played = run.finish().await;
    played.is_undisturbed(&plan, &[]);
    assert_eq!(played.failovers(), 0);
}

/// Replicas of two versions of the planner serve the same stream where their evaluation is the same: setpoints are those of the pieces, and
/// who made the pieces does not matter.
#[tokio::test(flavor = "multi_thread")]
async fn a_plan_of_another_version_of_the_planner_is_gone_on_with() {
    let _alone = alone().await;
    let replica = Replica::start("replica").await;
    let plan = planned(move_of(0.3, 0.25));
    let maker = Maker { planner_version: "0.0.7".into(), ..plan.plan().maker().clone() };
    let older = Judged::new(plan.plan().clone().made_by(maker).unwrap()).accepted().unwrap();
    assert_ne!(older.plan().maker(), plan.plan().maker());
    let mut client = SetpointServiceClient::connect(replica.endpoint()).await.unwrap();
    asked(&mut client, on_wire(good(&older), |_, _| {})).await.unwrap();
    // It was served from its first cycle on, too: every bit is that of the plan made here.
    let played = Run::begin(request("cell-7/x", &[replica.endpoint()], &older, LEAD)).await.finish().await;
    played.is_undisturbed(&plan, &[]);
}

/// Whoever has opened last holds the stream: an epoch from the past takes it from nobody.
#[tokio::test(flavor = "multi_thread")]
async fn an_epoch_from_the_past() {
    let _alone = alone().await;
    let replica = Replica::start("replica").await;
    let plan = planned(move_of(0.3, 0.25));
    let run = Run::begin(request("cell-8/x", &[replica.endpoint()], &plan, LEAD)).await;
    let mut client = SetpointServiceClient::connect(replica.endpoint()).await.unwrap();
    // The run's epoch is of this century.
    let refused = asked(&mut client, on_wire(good(&plan), |_, _| {})).await.unwrap_err();
    assert_eq!(refused.reason, Reason::EpochSuperseded, "{refused}");
    assert_eq!(refused.metadata["given"], "10");
    assert!(refused.metadata["current_epoch"].parse::<u64>().unwrap() > 10);
    let played = run.finish().await;
    played.is_undisturbed(&plan, &[]);
    assert_eq!(played.failovers(), 0);
}
