//! What a server says with plans in it: the same messages, with the plans in bytes already.
//!
//! A field that is a message is written as one of bytes is, so they have the names of those messages, and their JSON. [`pb`] has the service with these answers, and
//! everybody who reads them has the trees of the same names there.

use prost::bytes::Bytes;
use prost::{Message, Name};

use crate::pb;

/// As [`pb::PlanResponse`].
#[derive(Clone, PartialEq, Message)]
pub struct PlanResponse {
    /// The [`pb::Plan`].
    #[prost(bytes = "bytes", tag = "1")]
    pub plan: Bytes,
}

/// As [`pb::PlanManyResponse`].
#[derive(Clone, PartialEq, Message)]
pub struct PlanManyResponse {
    /// A [`pb::PlanOutcome`] for each request, in the order of the requests.
    #[prost(bytes = "bytes", repeated, tag = "1")]
    pub outcomes: Vec<Bytes>,
    /// The answer to columns.
    #[prost(message, optional, tag = "2")]
    pub columns: Option<pb::PlanColumns>,
}

/// As [`pb::PlanPvtResponse`].
#[derive(Clone, PartialEq, Message)]
pub struct PlanPvtResponse {
    /// The [`pb::Plan`].
    #[prost(bytes = "bytes", tag = "1")]
    pub plan: Bytes,
    /// A [`pb::PvtPointReport`] for each point, axis by axis.
    #[prost(bytes = "bytes", repeated, tag = "2")]
    pub points: Vec<Bytes>,
}

impl Name for PlanResponse {
    const NAME: &'static str = pb::PlanResponse::NAME;
    const PACKAGE: &'static str = pb::PlanResponse::PACKAGE;
}

impl Name for PlanManyResponse {
    const NAME: &'static str = pb::PlanManyResponse::NAME;
    const PACKAGE: &'static str = pb::PlanManyResponse::PACKAGE;
}

impl Name for PlanPvtResponse {
    const NAME: &'static str = pb::PlanPvtResponse::NAME;
    const PACKAGE: &'static str = pb::PlanPvtResponse::PACKAGE;
}
