//! What becomes of an operation: when it is planned, and what is answered.

use planner::LAST_CYCLE;
use planner::motion::{Operation as Planned, Refused, Spliced};
use proto::stream::{
    Operation, OperationRefusal, OperationResult, RECENT_RESULTS, Revised, ToAxis, refused_operation,
};
use proto::{Reason, Rejected};

use super::queue::{Asker, Waiting};
use super::splice::{Splice, result};
use super::{Answer, MOST_REFUSALS, Output, Session};

/// Operations that wait at most: more are refused.
const MOST_WAITING: usize = 64;

impl Session {
    /// Takes what somebody asks for; answers at once what needs no motion to be answered.
    pub(super) fn operate(&mut self, asker: Asker, operation: Operation) {
        let id = operation.request_id.clone();
        if let Some(done) = self.recent.iter().rev().find(|result| result.request_id == id).cloned() {
            // A server of another version may not have said what it was.
            let is_same = done.operation_digest == 0 || done.operation_digest == operation.digest();
            return self.answer(asker, &id, if is_same { Ok(done) } else { Err(reused(&id)) });
        }
        if self.ended {
            let text = "the stream is over: open a new one";
            return self.answer(asker, &id, Err(Rejected::new(Reason::StreamFinished, text)));
        }
        let in_flight = self.splice.as_mut().map(|splice| &mut splice.waiting);
        let same = in_flight.filter(|waiting| waiting.request_id == id).or_else(|| self.queue.find(&id));
        match same {
            Some(waiting) if waiting.digest == operation.digest() => return waiting.also_for(asker),
            Some(_) => return self.answer(asker, &id, Err(reused(&id))),
            None => {}
        }
        match self.checked(&operation) {
            Ok(planned) => {
                self.queue.push(asker, operation, planned);
                self.advance();
            }
            Err(rejected) => self.answer(asker, &id, Err(rejected)),
        }
    }

    fn checked(&self, operation: &Operation) -> Result<Planned, Rejected> {
        if let Some(why) = planner::wrong_name(&operation.request_id) {
            let field = planner::Field::named("request_id");
            return Err(planner::InvalidFields::one(field, why).into());
        }
        if let Some(given) = operation.not_before_cycle.filter(|cycle| *cycle > LAST_CYCLE) {
            let text = format!("is {given}: the last cycle that can be counted is {LAST_CYCLE}");
            let rejected = Rejected::for_field("not_before_cycle", Reason::ValueOutOfRange, text);
            return Err(rejected.with("given", given).with("nearest", LAST_CYCLE));
        }
        let planned = operation.planned()?;
        if self.queue.len() >= MOST_WAITING {
            let text = format!(
                "{MOST_WAITING} operations wait on this stream, as many as it takes: ask again when they are answered"
            );
            return Err(Rejected::new(Reason::Overloaded, text).with("allowed", MOST_WAITING));
        }
        Ok(planned)
    }

    /// Plans what is due, unless a splice is in flight.
    pub(super) fn advance(&mut self) {
        while !self.ended && self.splice.is_none() {
            let Some((place, cycle)) = self.queue.find_due(|waiting| self.begins(waiting)) else { return };
            let waiting = self.queue.take(place);
            self.plan(waiting, cycle);
        }
    }

    /// Where an operation would begin if it was planned now; `None` where a later report will do.
    ///
    /// As soon as it can be there in time, or in the last cycle that was sent: an axis has not executed that before it runs
    /// out.
    fn begins(&self, waiting: &Waiting) -> Option<u64> {
        let &Waiting { not_before, refusals, .. } = waiting;
        let (executed, sent) = (self.credit.executed(), self.credit.sent());
        // An axis that has not got its lead does not begin, and may not report: what is granted goes first.
        if self.has_more() {
            return None;
        }
        if not_before > executed.saturating_add(self.pace.horizon(refusals)) {
            return None;
        }
        let replaceable = sent >= self.pace.first_replaceable(executed);
        let farthest = if replaceable { sent } else { sent + 1 };
        let soonest = (executed + self.pace.margin(refusals)).min(farthest);
        Some(soonest.max(not_before).max(self.effective))
    }

    fn plan(&mut self, waiting: Waiting, cycle: u64) {
        let planned = match self.adopted.end(self.close_at_rest) {
            // Until when points can be appended is for the motion to say.
            Some(end) if cycle > end && !matches!(waiting.planned, Planned::Append(_)) => {
                Err(too_late(cycle, end))
            }
            _ => self
                .adopted
                .motion
                .under_way
                .splice(cycle, &waiting.planned)
                .map_err(|refused| refused_operation(&waiting.planned, refused)),
        };
        match planned {
            Err(rejected) => self.settle(waiting, &Err(rejected)),
            Ok(spliced) if spliced.motion.revision() == self.adopted.revision() => {
                self.nothing_to_do(waiting, &spliced);
            }
            Ok(spliced) => {
                let ended = self.adopted.end(self.close_at_rest).is_some_and(|end| self.credit.sent() >= end);
                let splice = Splice::new(waiting, spliced, &self.adopted, ended, &self.recent);
                let revised = Revised { motion: splice.branch.motion.clone() };
                self.outbox.push_back(Output::Send(ToAxis::Revised(Box::new(revised))));
                self.splice = Some(splice);
            }
        }
    }

    /// What was asked for is so already.
    fn nothing_to_do(&mut self, waiting: Waiting, spliced: &Spliced) {
        let result = result(&waiting, spliced);
        self.remember(result.clone());
        self.settle(waiting, &Ok(result));
    }

    /// The axis has adopted the splice.
    pub(super) fn confirm(&mut self) {
        let Some(Splice { waiting, branch, result, .. }) = self.splice.take() else { return };
        self.adopted = branch;
        self.refusals = 0;
        self.remember(result.clone());
        for overtaken in self.queue.take_overtaken(&waiting, result.effective_cycle) {
            let text = format!(
                "operation {:?} took effect at cycle {}, before this one was due: send it again if it is still wanted",
                waiting.request_id, result.effective_cycle
            );
            let rejected = Rejected::new(Reason::Superseded, text).with("by", &waiting.request_id);
            self.settle(overtaken, &Err(rejected.with("effective_cycle", result.effective_cycle)));
        }
        self.settle(waiting, &Ok(result));
    }

    /// The axis has not taken the splice: it goes on as it did, and the splice is planned again, farther ahead.
    pub(super) fn withdraw(&mut self, accepted: u64) {
        let Some(splice) = self.splice.take() else { return };
        if let Some((_, since)) = splice.sent() {
            self.pace.measured(self.credit.executed().saturating_sub(since));
        }
        let mut waiting = splice.waiting;
        self.send_again_after(accepted);
        waiting.refusals += 1;
        if waiting.refusals < MOST_REFUSALS {
            return self.queue.put_back(waiting);
        }
        let text = format!(
            "the axis has refused the operation {MOST_REFUSALS} times, and goes on as before: send it again with the same \
             request_id"
        );
        self.settle(waiting, &Err(Rejected::new(Reason::NotConfirmed, text)));
    }

    /// The motion is at its end, and the stream with it: what was to take effect later does not.
    pub(super) fn leave_too_late(&mut self) {
        for waiting in self.queue.take_all() {
            let (cycle, end) = (waiting.not_before, self.adopted.motion.last_cycle());
            let rejected = match self.adopted.motion.under_way.splice(cycle.max(end), &waiting.planned) {
                Err(refused @ Refused::AppendTooLate { .. }) => refused_operation(&waiting.planned, refused),
                _ => too_late(cycle, end),
            };
            self.settle(waiting, &Err(rejected));
        }
    }

    /// The session ends: what waits is answered.
    pub(super) fn leave_undone(&mut self) {
        let in_flight = self.splice.take().map(|splice| splice.waiting);
        for waiting in in_flight.into_iter().chain(self.queue.take_all()) {
            self.settle(waiting, &Err(Rejected::left_undone()));
        }
    }

    fn remember(&mut self, result: OperationResult) {
        self.effective = result.effective_cycle;
        if self.recent.len() >= RECENT_RESULTS {
            self.recent.remove(0);
        }
        self.recent.push(result);
    }

    fn settle(&mut self, waiting: Waiting, result: &Result<OperationResult, Rejected>) {
        for asker in waiting.askers {
            self.answer(asker, &waiting.request_id, result.clone());
        }
    }

    fn answer(&mut self, asker: Asker, request_id: &str, result: Result<OperationResult, Rejected>) {
        match (asker, result) {
            (Asker::Commander(ticket), result) => self.answers.push_back(Answer { ticket, result }),
            (Asker::Axis, Ok(result)) => self.outbox.push_back(Output::Send(ToAxis::Result(result))),
            (Asker::Axis, Err(rejected)) => {
                let refusal = OperationRefusal { request_id: request_id.to_owned(), rejected };
                self.outbox.push_back(Output::Send(ToAxis::Refusal(refusal)));
            }
        }
    }
}

fn reused(request_id: &str) -> Rejected {
    let text = format!(
        "{request_id:?} names an operation of this stream that is another one: give this one an id of its own"
    );
    Rejected::for_field("request_id", Reason::RequestIdReused, text)
}

fn too_late(cycle: u64, end: u64) -> Rejected {
    let text = format!(
        "the operation would take effect at cycle {cycle}, and the stream closes at rest at {end}: open a new one, or open \
         it without close_at_rest"
    );
    Rejected::new(Reason::StreamFinished, text).with("given", cycle).with("nearest", end)
}
