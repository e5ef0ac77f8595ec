use planner::State;

/// Setpoints on their way through the drive: what goes in comes out a whole number of substeps later.
#[derive(Clone, Debug)]
pub(crate) struct DelayLine {
    waiting: Box<[State]>,
    oldest: usize,
}

impl DelayLine {
    /// `substeps` of delay, filled with `start` as if the axis had always stood there.
    pub(crate) fn new(substeps: usize, start: State) -> Self {
        Self { waiting: vec![start; substeps].into_boxed_slice(), oldest: 0 }
    }

    pub(crate) fn pass(&mut self, setpoint: State) -> State {
        let Some(slot) = self.waiting.get_mut(self.oldest) else {
            return setpoint;
        };
        let delayed = std::mem::replace(slot, setpoint);
        self.oldest = (self.oldest + 1) % self.waiting.len();
        delayed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setpoint_comes_out_after_its_delay() {
        let outputs = |substeps: usize| -> Vec<f64> {
            let mut line = DelayLine::new(substeps, State::at_rest(0.0));
            (1..=5).map(|n| line.pass(State::at_rest(f64::from(n))).position).collect()
        };
        assert_eq!(outputs(0), [1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(outputs(1), [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(outputs(3), [0.0, 0.0, 0.0, 1.0, 2.0]);
    }
}
