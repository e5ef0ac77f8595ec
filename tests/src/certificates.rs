use client::Connect;
use rcgen::{
    BasicConstraints, CertificateParams, CertifiedIssuer, ExtendedKeyUsagePurpose, IsCa, KeyPair, SanType,
};
use serving::Tls;

/// An authority of a test's own, which vouches for whoever it is asked to.
#[derive(Debug)]
pub struct Authority(CertifiedIssuer<'static, KeyPair>);

/// A certificate and its key, as PEM.
#[derive(Clone, Debug)]
pub struct Identity {
    /// The certificate.
    pub certificate: String,
    /// Its key.
    pub key: String,
}

impl Default for Authority {
    fn default() -> Self {
        let mut params = CertificateParams::new(Vec::new()).expect("parameters");
        params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        let key = KeyPair::generate().expect("a key");
        Self(CertifiedIssuer::self_signed(params, key).expect("an authority"))
    }
}

impl Authority {
    /// Its certificate, as PEM.
    #[must_use]
    pub fn pem(&self) -> String {
        self.0.pem()
    }

    /// A certificate for `name`: a URI where it has a scheme, else a DNS name.
    #[must_use]
    pub fn vouch_for(&self, name: &str) -> Identity {
        self.vouch_for_all(&[name])
    }

    /// A certificate with several names.
    #[must_use]
    pub fn vouch_for_all(&self, names: &[&str]) -> Identity {
        let mut params = CertificateParams::new(Vec::new()).expect("parameters");
        params.subject_alt_names = names
            .iter()
            .map(|name| {
                let text = (*name).try_into().expect("a name");
                if name.contains("://") { SanType::URI(text) } else { SanType::DnsName(text) }
            })
            .collect();
        params.extended_key_usages =
            vec![ExtendedKeyUsagePurpose::ServerAuth, ExtendedKeyUsagePurpose::ClientAuth];
        let key = KeyPair::generate().expect("a key");
        let certificate = params.signed_by(&key, &self.0).expect("a certificate");
        Identity { certificate: certificate.pem(), key: key.serialize_pem() }
    }

    /// What a server on this machine serves with, to those that this authority vouches for.
    #[must_use]
    pub fn server(&self) -> Tls {
        let Identity { certificate, key } = self.vouch_for("localhost");
        Tls::new(certificate.into(), key.into(), Some(self.pem().into()))
    }

    /// How `name` connects.
    #[must_use]
    pub fn connect_as(&self, name: &str) -> Connect {
        let Identity { certificate, key } = self.vouch_for(name);
        Connect::new().with_authority(self.pem()).with_identity(certificate, key)
    }
}
