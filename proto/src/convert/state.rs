use planner::State;

use crate::pb;

impl From<pb::AxisState> for State {
    fn from(wire: pb::AxisState) -> Self {
        let pb::AxisState { position, velocity, acceleration } = wire;
        Self { position, velocity, acceleration }.with_positive_zeros()
    }
}

impl From<State> for pb::AxisState {
    fn from(state: State) -> Self {
        let State { position, velocity, acceleration } = state;
        Self { position, velocity, acceleration }
    }
}
