/// What to give up when the path is too short to change from the start to the end velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ShortPathPolicy {
    /// Nothing: overshoot or go back, time-optimally.
    Reverse,
    /// The end velocity, as Bui, Le and Doan (2021) do: it becomes the start velocity (their type 8B); and where the two
    /// differ by more than a²/j and the type is not 1 to 5, it first becomes the start velocity ± a²/j.
    MatchStartVelocity,
    /// The end velocity: the reachable one that is closest to the one asked for.
    NearestVelocity,
    /// The move: an error that names the least length.
    #[default]
    Reject,
}
