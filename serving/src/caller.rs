use std::sync::Arc;

use proto::{Reason, Rejected};
use rustls_pki_types::CertificateDer;
use tonic::codegen::http::Extensions;
use tonic::transport::server::{TcpConnectInfo, TlsConnectInfo};

use crate::policy::Policy;

/// Who calls, and what he may do. Every request that a process serves has one.
#[derive(Clone, Debug, Default)]
pub struct Caller {
    identity: Option<Arc<str>>,
    policy: Option<Arc<Policy>>,
}

impl Caller {
    /// Of a request that a service is asked to answer.
    #[must_use]
    pub fn of<T>(request: &tonic::Request<T>) -> Self {
        request.extensions().get::<Self>().cloned().unwrap_or_default()
    }

    /// Of who comes where nobody is asked for a certificate, as to pages on the side port: he may what `policy` grants to
    /// those without a name.
    #[must_use]
    pub fn without_a_name(policy: Option<Policy>) -> Self {
        Self { identity: None, policy: policy.map(Arc::new) }
    }

    /// By the certificate of a connection: its first name that is a URI, else its first DNS name.
    pub(crate) fn of_connection(extensions: &Extensions, policy: Option<&Arc<Policy>>) -> Self {
        let certificates =
            extensions.get::<TlsConnectInfo<TcpConnectInfo>>().and_then(TlsConnectInfo::peer_certs);
        let identity = certificates.and_then(|chain| name_in(chain.first()?));
        Self { identity, policy: policy.cloned() }
    }

    /// The name that the caller's certificate gives; `None` without one.
    #[must_use]
    pub fn identity(&self) -> Option<&str> {
        self.identity.as_deref()
    }

    /// May the caller use `stream`? Without a policy everybody may.
    ///
    /// # Errors
    /// `STREAM_NOT_ALLOWED`, the same whether there is such a stream or not.
    pub fn may_use(&self, stream: &str) -> Result<(), Rejected> {
        if self.sees(stream) {
            return Ok(());
        }
        let text = format!(
            "the policy does not let {who} use stream {stream:?}: use a name that it grants, or have it extended",
            who = self.called()
        );
        Err(Rejected::new(Reason::StreamNotAllowed, text)
            .with("identity", self.called())
            .with("stream", stream))
    }

    /// As [`may_use`](Self::may_use), of the streams in a list.
    #[must_use]
    pub fn sees(&self, stream: &str) -> bool {
        self.policy.as_ref().is_none_or(|policy| policy.allows_stream(self.name(), stream))
    }

    /// May the caller call `method`, as `motion.v1.PlannerService/Plan`? Without a policy everybody may.
    ///
    /// # Errors
    /// `METHOD_NOT_ALLOWED`.
    pub fn may_call(&self, method: &str) -> Result<(), Rejected> {
        let allowed = self.policy.as_ref().is_none_or(|policy| policy.allows_method(self.name(), method));
        if allowed || method.starts_with(HEALTH) {
            return Ok(());
        }
        let text = format!(
            "the policy does not let {who} call {method}: use an identity that may, or have it extended",
            who = self.called()
        );
        Err(Rejected::new(Reason::MethodNotAllowed, text)
            .with("identity", self.called())
            .with("method", method))
    }

    fn name(&self) -> &str {
        self.identity.as_deref().unwrap_or_default()
    }

    fn called(&self) -> &str {
        self.identity.as_deref().unwrap_or("a caller without a name")
    }
}

/// Whether a process is well is nobody's secret, and orchestrators have no names.
const HEALTH: &str = "grpc.health.v1.Health/";

fn name_in(certificate: &CertificateDer<'_>) -> Option<Arc<str>> {
    let certificate = webpki::EndEntityCert::try_from(certificate).ok()?;
    let name = certificate.valid_uri_names().next().or_else(|| certificate.valid_dns_names().next())?;
    Some(name.into())
}
