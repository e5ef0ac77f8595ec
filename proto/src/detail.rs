/// How much is told of each of many plans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Detail {
    /// All of it: the bytes of a plan that is asked for by itself.
    #[default]
    Full,
    /// What nobody can work out from the rest: no fingerprint, no explanation, and of the certificate whether the plan
    /// passed.
    Motion,
}
