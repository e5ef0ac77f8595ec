//! Services as tools see them that have nothing but an address: the schema is asked for by reflection, and messages are JSON.

use std::collections::HashSet;

use prost_reflect::{DescriptorPool, DynamicMessage, MessageDescriptor, MethodDescriptor, SerializeOptions};
use prost_types::FileDescriptorProto;
use serde_json::{Value, json};
use tokio::sync::mpsc;
use tokio_stream::StreamExt as _;
use tokio_stream::wrappers::ReceiverStream;
use tonic::client::Grpc;
use tonic::codec::{Codec, DecodeBuf, Decoder, EncodeBuf, Encoder};
use tonic::codegen::http::uri::PathAndQuery;
use tonic::transport::Channel;
use tonic::{Request, Status, Streaming};
use tonic_prost::ProstCodec;
use tonic_reflection::pb::v1::server_reflection_request::MessageRequest;
use tonic_reflection::pb::v1::server_reflection_response::MessageResponse;
use tonic_reflection::pb::v1::{ServerReflectionRequest, ServerReflectionResponse};

/// What one process serves, as it says itself.
#[derive(Clone, Debug)]
pub struct Reflected {
    channel: Channel,
    pool: DescriptorPool,
    services: Vec<String>,
}

/// Which reflection a tool speaks: `v1`, or `v1alpha`, which older ones know alone. Their messages are the same bytes.
pub const VERSIONS: [&str; 2] = ["v1", "v1alpha"];

impl Reflected {
    /// Asks for the schema, by reflection of one of [`VERSIONS`]: which services there are, the file of each, and what that imports.
    ///
    /// # Errors
    /// What the process answers that does not tell.
    pub async fn by(version: &str, channel: Channel) -> Result<Self, Status> {
        let mut asked = Asked::of(version, channel.clone());
        let MessageResponse::ListServicesResponse(list) =
            asked.one(MessageRequest::ListServices(String::new())).await?
        else {
            return Err(Status::internal("no list of services"));
        };
        let services: Vec<String> = list.service.into_iter().map(|service| service.name).collect();
        let mut pending: Vec<MessageRequest> =
            services.iter().cloned().map(MessageRequest::FileContainingSymbol).collect();
        let (mut files, mut known) = (Vec::new(), HashSet::new());
        while let Some(request) = pending.pop() {
            let MessageResponse::FileDescriptorResponse(found) = asked.one(request).await? else {
                return Err(Status::internal("no file of the schema"));
            };
            for bytes in found.file_descriptor_proto {
                let file: FileDescriptorProto =
                    prost::Message::decode(bytes.as_slice()).expect("a file of the schema");
                if !known.insert(file.name().to_owned()) {
                    continue;
                }
                let unknown = file.dependency.iter().filter(|name| !known.contains(*name));
                pending.extend(unknown.cloned().map(MessageRequest::FileByFilename));
                files.push(file);
            }
        }
        let mut pool = DescriptorPool::new();
        pool.add_file_descriptor_protos(files).expect("files that go together");
        Ok(Self { channel, pool, services })
    }

    /// The names of the services.
    #[must_use]
    pub fn services(&self) -> &[String] {
        &self.services
    }

    /// Calls a method of one message and one answer, as `motion.v1.PlannerService/Plan`.
    ///
    /// # Errors
    /// The refusal.
    pub async fn call(&self, method: &str, request: Value) -> Result<Value, Status> {
        let descriptor = self.method(method);
        let request = message(&descriptor.input(), request);
        let mut grpc = self.ready().await?;
        let answer = grpc.unary(Request::new(request), path(method), Dynamic(descriptor.output())).await?;
        Ok(value(&answer.into_inner()))
    }

    /// Begins a method of several messages, in either direction.
    ///
    /// # Errors
    /// The refusal.
    pub async fn begin(
        &self,
        method: &str,
        requests: mpsc::Receiver<Value>,
    ) -> Result<Streaming<DynamicMessage>, Status> {
        let descriptor = self.method(method);
        let input = descriptor.input();
        let requests = ReceiverStream::new(requests).map(move |request| message(&input, request));
        let mut grpc = self.ready().await?;
        let answers =
            grpc.streaming(Request::new(requests), path(method), Dynamic(descriptor.output())).await?;
        Ok(answers.into_inner())
    }

    fn method(&self, method: &str) -> MethodDescriptor {
        let (service, name) = method.split_once('/').expect("service/method");
        let service =
            self.pool.get_service_by_name(service).unwrap_or_else(|| panic!("{service} is not told of"));
        let found = service.methods().find(|known| known.name() == name);
        found.unwrap_or_else(|| panic!("{method} is not told of"))
    }

    async fn ready(&self) -> Result<Grpc<Channel>, Status> {
        let mut grpc = Grpc::new(self.channel.clone()).max_decoding_message_size(proto::MAX_MESSAGE_BYTES);
        grpc.ready().await.map_err(|error| Status::unavailable(error.to_string()))?;
        Ok(grpc)
    }

    /// Plans, streams and holds: plans 50 mm, plays the plan as an axis does, has it held on the way by somebody else, and goes on by
    /// itself to the end. Gives the cycles that it has played.
    ///
    /// # Errors
    /// The first refusal.
    pub async fn plan_stream_and_hold(&self, stream: &str) -> Result<u64, Status> {
        let limits = json!({"maxVelocity": 0.25, "maxAcceleration": 3, "maxJerk": 100});
        let axis = json!({
            "axis": "x", "kind": "AXIS_KIND_PRISMATIC", "goal": {"position": 0.05}, "limits": limits
        });
        let request = json!({
            "axes": [axis], "family": "PROFILE_FAMILY_S_CURVE", "shortPathPolicy": "SHORT_PATH_POLICY_REJECT",
            "synchronization": "SYNCHRONIZATION_NONE"
        });
        let plan = self.call("motion.v1.PlannerService/Plan", request).await?["plan"].take();
        assert_eq!(plan["certificate"]["passed"], json!(true), "{plan}");

        let (say, said) = mpsc::channel(8);
        let open = json!({"open": {"stream": stream, "epoch": "1", "closeAtRest": true, "plan": plan}});
        say.send(open).await.expect("a stream");
        let mut answers = self.begin("motion.v1.SetpointService/StreamSetpoints", said).await?;
        let hold = json!({"stream": stream, "operation": {"requestId": "wait", "hold": {}}});
        let (mut holding, mut rests_at) = (None, None);
        let (mut executed, mut has_gone_on) = (0, false);
        while let Some(answer) = answers.message().await? {
            let answer = value(&answer);
            if answer.get("opened").is_some() {
                // Its session is there: whoever commands finds it.
                let (this, hold) = (self.clone(), hold.clone());
                let held = async move { this.call("motion.v1.SetpointService/ControlStream", hold).await };
                holding = Some(tokio::spawn(held));
            } else if let Some(operation) = answer.get("operation") {
                assert_eq!(operation["requestId"], "go on", "{operation}");
                has_gone_on = true;
            } else if let Some(batch) = answer.get("batch") {
                let accepted = number(&batch["firstCycle"]) + number(&batch["columns"]["cycles"]) - 1;
                // It begins to play when it has been told to hold: before, the motion might be over. And it stays behind what it
                // holds, as an axis does, so that what is replaced is not played yet.
                if number(&batch["revision"]) > 0 {
                    let rests = batch["last"] == json!(true);
                    executed = executed.max(if rests { accepted } else { accepted.saturating_sub(20) });
                }
                let report = json!({
                    "executedCycle": executed.to_string(), "acceptedCycle": accepted.to_string(),
                    "grantCycle": (executed + 40).to_string(), "revision": batch["revision"], "digest": batch["digest"]
                });
                say.send(json!({"report": report})).await.expect("a stream");
                // The report has said that it plays by the hold: whoever asked for it is answered.
                if number(&batch["revision"]) == 1
                    && let Some(holding) = holding.take()
                {
                    let held = holding.await.expect("it is answered")?;
                    let result = &held["result"];
                    assert_eq!(
                        (&result["requestId"], &result["onPath"]),
                        (&json!("wait"), &json!(true)),
                        "{held}"
                    );
                    rests_at = Some(number(&result["restCycle"]));
                }
                if rests_at.take_if(|cycle| accepted >= *cycle).is_some() {
                    // Held. It goes on by what the axis itself asks for, in band.
                    let on = json!({"operation": {"requestId": "go on", "resume": {}}});
                    say.send(on).await.expect("a stream");
                }
            }
        }
        assert!(has_gone_on, "it was held, and went on");
        Ok(executed)
    }
}

/// A 64-bit integer, which JSON has as a text; one of 32 bits as a number.
fn number(value: &Value) -> u64 {
    value
        .as_str()
        .map_or_else(|| value.as_u64(), |text| text.parse().ok())
        .unwrap_or_else(|| panic!("{value}"))
}

/// A connection to the reflection service.
struct Asked {
    grpc: Grpc<Channel>,
    path: PathAndQuery,
}

impl Asked {
    fn of(version: &str, channel: Channel) -> Self {
        Self {
            grpc: Grpc::new(channel),
            path: path(&format!("grpc.reflection.{version}.ServerReflection/ServerReflectionInfo")),
        }
    }

    async fn one(&mut self, message: MessageRequest) -> Result<MessageResponse, Status> {
        let request = ServerReflectionRequest { host: String::new(), message_request: Some(message) };
        self.grpc.ready().await.map_err(|error| Status::unavailable(error.to_string()))?;
        let codec = ProstCodec::<ServerReflectionRequest, ServerReflectionResponse>::default();
        let requests = Request::new(tokio_stream::once(request));
        let mut answers = self.grpc.streaming(requests, self.path.clone(), codec).await?.into_inner();
        let answer = answers.message().await?.and_then(|answer| answer.message_response);
        match answer {
            Some(MessageResponse::ErrorResponse(error)) => Err(Status::not_found(error.error_message)),
            Some(answer) => Ok(answer),
            None => Err(Status::internal("reflection says nothing")),
        }
    }
}

fn path(method: &str) -> PathAndQuery {
    format!("/{method}").parse().expect("a path")
}

fn message(of: &MessageDescriptor, json: Value) -> DynamicMessage {
    DynamicMessage::deserialize(of.clone(), json)
        .unwrap_or_else(|error| panic!("no {}: {error}", of.full_name()))
}

fn value(message: &DynamicMessage) -> Value {
    let options = SerializeOptions::new().skip_default_fields(false);
    message.serialize_with_options(serde_json::value::Serializer, &options).expect("JSON")
}

/// Messages whose type is known when they are there.
struct Dynamic(MessageDescriptor);

impl Codec for Dynamic {
    type Encode = DynamicMessage;
    type Decode = DynamicMessage;
    type Encoder = Bytes;
    type Decoder = Self;

    fn encoder(&mut self) -> Bytes {
        Bytes
    }

    fn decoder(&mut self) -> Self {
        Self(self.0.clone())
    }
}

/// A message as its bytes.
struct Bytes;

impl Encoder for Bytes {
    type Item = DynamicMessage;
    type Error = Status;

    fn encode(&mut self, message: DynamicMessage, buffer: &mut EncodeBuf<'_>) -> Result<(), Status> {
        prost::Message::encode(&message, buffer).map_err(|error| Status::internal(error.to_string()))
    }
}

impl Decoder for Dynamic {
    type Item = DynamicMessage;
    type Error = Status;

    fn decode(&mut self, bytes: &mut DecodeBuf<'_>) -> Result<Option<DynamicMessage>, Status> {
        let message = DynamicMessage::decode(self.0.clone(), bytes);
        message.map(Some).map_err(|error| Status::internal(error.to_string()))
    }
}
