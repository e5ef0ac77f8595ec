use std::convert::Infallible;
use std::fmt;
use std::net::SocketAddr;

use axum::Router;
use prost::Message as _;
use prost_types::FileDescriptorSet;
use tokio_util::sync::CancellationToken;
use tonic::body::Body;
use tonic::codegen::{Service, http};
use tonic::server::NamedService;
use tonic::service::{Routes, RoutesBuilder};
use tonic_health::ServingStatus;
use tonic_health::server::HealthReporter;

use crate::address::Address;
use crate::connections::Connections;
use crate::frame::{frame, transport};

use crate::leaving::{FAREWELL, Leaving};
use crate::listener::Listener;
use crate::settings::{Misfits, Settings};
use crate::side_port::{SidePort, router};
use crate::telemetry;

/// A process that has its port and does not serve yet.
#[derive(Debug)]
pub struct Bound {
    settings: Settings,
    listener: Listener,
    address: Address,
    side_port: Option<SidePort>,
}

/// What a process serves beside health and reflection.
pub struct Services {
    schema: &'static [u8],
    routes: RoutesBuilder,
    names: Vec<&'static str>,
    pages: Router,
}

/// Why a process cannot serve.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// Settings that cannot be.
    #[error(transparent)]
    Settings(#[from] Misfits),
    /// The port cannot be had.
    #[error("cannot listen on {address}: {cause}; choose another with --{setting}")]
    Bind {
        /// Which of the ports.
        setting: &'static str,
        /// The address.
        address: Address,
        /// What the system says.
        cause: std::io::Error,
    },
    /// Serving failed.
    #[error("cannot serve: {0}")]
    Serve(#[from] tonic::transport::Error),
    /// The reflection service cannot read the schema.
    #[error("cannot offer reflection: {0}")]
    Reflection(#[from] tonic_reflection::server::Error),
}

impl Services {
    /// None yet, of a schema that is an encoded `google.protobuf.FileDescriptorSet`.
    #[must_use]
    pub fn of_schema(schema: &'static [u8]) -> Self {
        Self { schema, routes: RoutesBuilder::default(), names: Vec::new(), pages: Router::new() }
    }

    /// One more.
    #[must_use]
    pub fn with<S>(mut self, service: S) -> Self
    where
        S: Service<http::Request<Body>, Response = http::Response<Body>, Error = Infallible>
            + NamedService
            + Clone
            + Send
            + Sync
            + 'static,
        S::Future: Send + 'static,
    {
        self.names.push(S::NAME);
        self.routes.add_service(service);
        self
    }

    /// With pages on the side port, beside those that every process has; none is to begin with `/healthz`, `/readyz`,
    /// `/metrics` or the name of a service.
    #[must_use]
    pub fn with_pages(mut self, pages: Router) -> Self {
        self.pages = self.pages.merge(pages);
        self
    }

    /// The methods of all services, as `motion.v1.PlannerService/Plan`; none of a schema that cannot be read, which
    /// reflection says.
    fn methods(&self) -> Vec<String> {
        let files = FileDescriptorSet::decode(self.schema).unwrap_or_default().file;
        let services = files.iter().flat_map(|file| {
            file.service
                .iter()
                .map(move |service| (format!("{}.{}", file.package(), service.name()), service))
        });
        services
            .filter(|(name, _)| self.names.contains(&name.as_str()))
            .flat_map(|(name, service)| {
                service.method.iter().map(move |method| format!("{name}/{}", method.name()))
            })
            .collect()
    }

    /// With reflection of exactly what is served, in both versions that tools ask for, where it is asked for.
    fn into_routes<H>(self, health: H, reflects: bool) -> Result<Routes, tonic_reflection::server::Error>
    where
        H: Service<http::Request<Body>, Response = http::Response<Body>, Error = Infallible>
            + NamedService
            + Clone
            + Send
            + Sync
            + 'static,
        H::Future: Send + 'static,
    {
        let Self { schema, mut routes, names, pages: _ } = self;
        let reflection = || {
            let builder = tonic_reflection::server::Builder::configure()
                .register_encoded_file_descriptor_set(schema)
                .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
                .with_service_name(H::NAME);
            names.iter().fold(builder, |builder, name| builder.with_service_name(*name))
        };
        routes.add_service(health);
        if !reflects {
            return Ok(routes.routes());
        }
        routes.add_service(reflection().with_service_name(REFLECTION_V1).build_v1()?);
        routes.add_service(reflection().with_service_name(REFLECTION_V1ALPHA).build_v1alpha()?);
        Ok(routes.routes())
    }
}

impl fmt::Debug for Services {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Services").field("names", &self.names).finish_non_exhaustive()
    }
}

impl Bound {
    /// Takes the ports, and begins to keep figures.
    ///
    /// # Errors
    /// Settings that cannot be, and a port that is taken.
    pub async fn to(settings: Settings) -> Result<Self, ServeError> {
        let settings = settings.misfits().into_result(settings)?;
        let bind_error =
            |cause| ServeError::Bind { setting: "listen", address: settings.listen.clone(), cause };
        let listener = Listener::at(&settings.listen).await.map_err(bind_error)?;
        let address = listener.address().map_err(bind_error)?;
        let side_port = match settings.http {
            None => None,
            Some(address) => {
                let taken = SidePort::to(address).await;
                Some(taken.map_err(|cause| ServeError::Bind {
                    setting: "http",
                    address: address.into(),
                    cause,
                })?)
            }
        };
        telemetry::keep();
        Ok(Self { settings, listener, address, side_port })
    }

    /// Where the side port is, where there is one.
    #[must_use]
    pub fn http_address(&self) -> Option<SocketAddr> {
        self.side_port.as_ref().map(SidePort::address)
    }

    /// Where the process listens.
    #[must_use]
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// Serves until `stop` completes; then says so, lets work end, and leaves at the drain deadline whatever is still going
    /// on. Until the last moment it answers: health that it does not serve any more, and new work by what `leaving` tells
    /// the services.
    ///
    /// # Errors
    /// Failures of the transport.
    pub async fn serve(
        self,
        services: Services,
        leaving: Leaving,
        stop: impl Future<Output = ()> + Send + 'static,
    ) -> Result<(), ServeError> {
        let Self { settings, listener, address, side_port } = self;
        let (health, health_service) = tonic_health::server::health_reporter();
        let names = services.names.clone();
        tell(&health, &names, ServingStatus::Serving).await;
        let health_pages = Routes::new(health_service.clone()).into_axum_router();
        let pages = router(services.pages.clone(), health_pages, &leaving);
        let beside = async {
            match side_port {
                Some(port) => port.serve(pages).await,
                None => std::future::pending().await,
            }
        };
        let incoming = Connections::of(listener, settings.max_connections, settings.keepalive_timeout);
        let mut server = transport(&settings)?.layer(frame(&settings, services.methods()));
        let server = server.add_routes(services.into_routes(health_service, settings.reflection)?);

        tracing::info!(%address, "serving");
        let gone = CancellationToken::new();
        let leave = {
            let gone = gone.clone();
            async move {
                stop.await;
                tracing::info!("draining: no new work, what is going on is told");
                tell(&health, &names, ServingStatus::NotServing).await;
                leaving.leave(settings.drain_deadline).await;
                gone.cancel();
            }
        };
        let serving = server.serve_with_incoming_shutdown(incoming, leave);
        let farewell = async {
            gone.cancelled().await;
            #[expect(
                clippy::disallowed_methods,
                reason = "who does not close is waited for this long and no longer"
            )]
            tokio::time::sleep(FAREWELL).await;
        };
        tokio::select! {
            served = serving => served?,
            () = farewell => {}
            // To the last moment: a process that drains is asked whether it is ready.
            () = beside => {}
            () = telemetry::take_up() => {}
        }
        Ok(())
    }
}

/// Tells whoever routes by health; the empty name is that of the whole process.
async fn tell(health: &HealthReporter, names: &[&str], status: ServingStatus) {
    for name in names.iter().chain([&""]) {
        health.set_service_status(name, status).await;
    }
}

const REFLECTION_V1: &str = "grpc.reflection.v1.ServerReflection";
const REFLECTION_V1ALPHA: &str = "grpc.reflection.v1alpha.ServerReflection";
