use std::path::Path;

use serde::Deserialize;

/// Who may call what, and on which streams. What nobody grants is denied.
///
/// A file in TOML, read when the process starts:
///
/// ```toml
/// [[grant]]
/// identity = "spiffe://plant/cell-7/*"            # of the caller's certificate
/// methods = ["motion.v1.SetpointService/*"]       # as in the schema: service/method
/// streams = ["cell-7/*"]                          # names of streams
/// ```
///
/// A `*` at the end of a pattern stands for any rest; elsewhere it is a letter like others.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Policy {
    #[serde(default, rename = "grant")]
    grants: Vec<Grant>,
}

#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Grant {
    identity: Pattern,
    methods: Vec<Pattern>,
    #[serde(default)]
    streams: Vec<Pattern>,
}

#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
struct Pattern {
    beginning: String,
    /// Does anything follow it?
    is_open: bool,
}

/// Why a text is no policy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct InvalidPolicy(String);

impl Policy {
    /// From the text of a file.
    ///
    /// # Errors
    /// Where the text is no TOML, has keys that a policy does not, or grants nothing to anybody.
    pub fn parse(text: &str) -> Result<Self, InvalidPolicy> {
        let policy: Self =
            toml::from_str(text).map_err(|error| InvalidPolicy(error.to_string().trim().to_owned()))?;
        if policy.grants.is_empty() {
            let text =
                "it grants nothing, so that nobody could call: write a [[grant]] with identity and methods";
            return Err(InvalidPolicy(text.to_owned()));
        }
        Ok(policy)
    }

    /// From a file.
    ///
    /// # Errors
    /// Where the file cannot be read, or is no policy.
    pub fn read(path: &Path) -> Result<Self, InvalidPolicy> {
        let said = |error: &dyn std::fmt::Display| InvalidPolicy(format!("{}: {error}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| said(&error))?;
        Self::parse(&text).map_err(|error| said(&error))
    }

    /// May `identity` call `method`, as `motion.v1.PlannerService/Plan`?
    #[must_use]
    pub fn allows_method(&self, identity: &str, method: &str) -> bool {
        self.of(identity).any(|grant| grant.methods.iter().any(|pattern| pattern.matches(method)))
    }

    /// May `identity` use `stream`?
    #[must_use]
    pub fn allows_stream(&self, identity: &str, stream: &str) -> bool {
        self.of(identity).any(|grant| grant.streams.iter().any(|pattern| pattern.matches(stream)))
    }

    fn of(&self, identity: &str) -> impl Iterator<Item = &Grant> {
        self.grants.iter().filter(move |grant| grant.identity.matches(identity))
    }
}

impl Pattern {
    fn matches(&self, name: &str) -> bool {
        if self.is_open { name.starts_with(&self.beginning) } else { name == self.beginning }
    }
}

impl TryFrom<String> for Pattern {
    type Error = InvalidPolicy;

    fn try_from(text: String) -> Result<Self, InvalidPolicy> {
        if text.is_empty() {
            return Err(InvalidPolicy("a pattern is empty: write a name, or * for any".to_owned()));
        }
        let open = text.strip_suffix('*').map(str::to_owned);
        let is_open = open.is_some();
        let beginning = open.unwrap_or(text);
        if beginning.contains('*') {
            let text =
                format!("{beginning:?} has a * that is not at its end: only there it stands for any rest");
            return Err(InvalidPolicy(text));
        }
        Ok(Self { beginning, is_open })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELLS: &str = r#"
        [[grant]]
        identity = "spiffe://plant/cell-7/*"
        methods = ["motion.v1.SetpointService/*"]
        streams = ["cell-7/*"]
        [[grant]]
        identity = "controller.plant"
        methods = ["motion.v1.PlannerService/*", "motion.v1.SetpointService/ControlStream"]
        streams = ["*"]
        [[grant]]
        identity = "spiffe://plant/*"
        methods = ["motion.v1.PlannerService/Plan"]
    "#;

    #[test]
    fn what_nobody_grants_is_denied() {
        let policy = Policy::parse(CELLS).unwrap();
        let axis = "spiffe://plant/cell-7/axis";
        let methods = [
            (axis, "motion.v1.SetpointService/StreamSetpoints", true),
            (axis, "motion.v1.PlannerService/Plan", true),
            (axis, "motion.v1.PlannerService/PlanPvt", false),
            ("controller.plant", "motion.v1.SetpointService/ControlStream", true),
            ("controller.plant", "motion.v1.SetpointService/StreamSetpoints", false),
            ("controller.plant.example", "motion.v1.PlannerService/Plan", false),
            ("", "motion.v1.PlannerService/Plan", false),
        ];
        for (identity, method, allowed) in methods {
            assert_eq!(policy.allows_method(identity, method), allowed, "{identity} {method}");
        }
        let streams = [
            (axis, "cell-7/x", true),
            (axis, "cell-70/x", false),
            (axis, "cell-7", false),
            ("controller.plant", "cell-8/x", true),
            ("spiffe://plant/cell-8/axis", "cell-8/x", false),
        ];
        for (identity, stream, allowed) in streams {
            assert_eq!(policy.allows_stream(identity, stream), allowed, "{identity} {stream}");
        }
    }

    #[test]
    fn what_is_no_policy_says_why() {
        let rows = [
            ("", "grants nothing"),
            ("[[grant]]\nidentity = \"a\"", "methods"),
            ("[[grant]]\nidentity = \"a\"\nmethods = []\nstream = []", "stream"),
            ("[[grant]]\nidentity = \"a*b\"\nmethods = []", "not at its end"),
            ("[[grant]]\nidentity = \"\"\nmethods = []", "is empty"),
            ("grants = 7", "grants"),
            ("[[", "TOML"),
        ];
        for (text, said) in rows {
            let error = Policy::parse(text).unwrap_err().to_string();
            assert!(error.contains(said), "{text:?}: {error}");
        }
    }
}
