use prost::{Message, Name};
use proto::pb::planner_service_server::PlannerService as _;
use proto::pb::setpoint_service_server::SetpointService as _;
use proto::{JsonError, Reason, Rejected};
use serving::axum::Router;
use serving::axum::body::{Body, Bytes};
use serving::axum::extract::State;
use serving::axum::http::{StatusCode, header};
use serving::axum::response::{IntoResponse as _, Response};
use serving::axum::routing::{get, post};
use tokio_stream::StreamExt as _;
use tonic::{Code, Request, Status};

use super::{Console, events};

/// The methods that the pages call, under the names that they have over gRPC.
pub(super) fn routes() -> Router<Console> {
    let method = |name: &str| format!("/console/api/motion.v1.{name}");
    Router::new()
        .route(&method("PlannerService/Plan"), post(plan))
        .route(&method("PlannerService/PlanPvt"), post(plan_pvt))
        .route(&method("PlannerService/VerifyPlan"), post(verify))
        .route(&method("PlannerService/SamplePlan"), post(sample))
        .route(&method("SetpointService/ControlStream"), post(control))
        .route(&method("SetpointService/WatchStream"), get(events::watch))
}

async fn plan(State(console): State<Console>, body: Bytes) -> Response {
    let answer = async { console.planner.plan(console.admits("PlannerService/Plan", read(&body)?)?).await };
    write(answer.await)
}

async fn plan_pvt(State(console): State<Console>, body: Bytes) -> Response {
    let answer =
        async { console.planner.plan_pvt(console.admits("PlannerService/PlanPvt", read(&body)?)?).await };
    write(answer.await)
}

async fn verify(State(console): State<Console>, body: Bytes) -> Response {
    let answer = async {
        console.planner.verify_plan(console.admits("PlannerService/VerifyPlan", read(&body)?)?).await
    };
    write(answer.await)
}

async fn control(State(console): State<Console>, body: Bytes) -> Response {
    let answer = async {
        console.setpoints.control_stream(console.admits("SetpointService/ControlStream", read(&body)?)?).await
    };
    write(answer.await)
}

/// A line of JSON for each message.
async fn sample(State(console): State<Console>, body: Bytes) -> Response {
    let answer = async {
        console.planner.sample_plan(console.admits("PlannerService/SamplePlan", read(&body)?)?).await
    };
    let samples = match answer.await {
        Ok(samples) => samples.into_inner(),
        Err(status) => return refused(&status),
    };
    let lines = samples.map(|sample| {
        let line = sample.map_err(|status| status.message().to_owned());
        line.and_then(|sample| proto::to_json(&sample).map_err(|error| error.to_string()))
            .map(|line| Bytes::from(line + "\n"))
    });
    ([(header::CONTENT_TYPE, "application/x-ndjson")], Body::from_stream(lines)).into_response()
}

impl Console {
    /// The request as one of whoever comes here, if he may ask it.
    pub(super) fn admits<T>(&self, method: &str, mut request: Request<T>) -> Result<Request<T>, Status> {
        self.caller.may_call(&format!("motion.v1.{method}"))?;
        request.extensions_mut().insert(self.caller.clone());
        Ok(request)
    }
}

fn read<T: Message + Name + Default>(body: &[u8]) -> Result<Request<T>, Status> {
    let invalid = |text: String| Status::from(Rejected::new(Reason::MessageInvalid, text));
    let text = str::from_utf8(body).map_err(|error| invalid(format!("the body is not UTF-8: {error}")))?;
    let message = proto::from_json(text);
    let message =
        message.map_err(|error: JsonError| invalid(format!("the body is not a {}: {error}", T::NAME)))?;
    Ok(Request::new(message))
}

fn write<T: Message + Name>(answer: Result<tonic::Response<T>, Status>) -> Response {
    match answer {
        Ok(answer) => match proto::to_json(answer.get_ref()) {
            Ok(text) => ([(header::CONTENT_TYPE, JSON)], text).into_response(),
            Err(error) => refused(&Status::internal(error.to_string())),
        },
        Err(status) => refused(&status),
    }
}

const JSON: &str = "application/json";

/// The object that `portamento --json` prints.
pub(super) fn refusal(status: &Status) -> String {
    match Rejected::from_status(status) {
        Some(rejected) => rejected.to_json().to_string(),
        None => proto::status_json(status).to_string(),
    }
}

fn refused(status: &Status) -> Response {
    (http_status(status.code()), [(header::CONTENT_TYPE, JSON)], refusal(status)).into_response()
}

/// As `google/rpc/code.proto` maps codes to HTTP.
fn http_status(code: Code) -> StatusCode {
    match code {
        Code::Ok => StatusCode::OK,
        Code::InvalidArgument | Code::FailedPrecondition | Code::OutOfRange => StatusCode::BAD_REQUEST,
        Code::Unauthenticated => StatusCode::UNAUTHORIZED,
        Code::PermissionDenied => StatusCode::FORBIDDEN,
        Code::NotFound => StatusCode::NOT_FOUND,
        Code::Aborted | Code::AlreadyExists => StatusCode::CONFLICT,
        Code::ResourceExhausted => StatusCode::TOO_MANY_REQUESTS,
        Code::Unimplemented => StatusCode::NOT_IMPLEMENTED,
        Code::Unavailable => StatusCode::SERVICE_UNAVAILABLE,
        Code::DeadlineExceeded => StatusCode::GATEWAY_TIMEOUT,
        Code::Cancelled | Code::Unknown | Code::Internal | Code::DataLoss => {
            StatusCode::INTERNAL_SERVER_ERROR
        }
    }
}
