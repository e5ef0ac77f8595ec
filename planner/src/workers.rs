use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// Who does the independent parts of a large piece of work.
///
/// There are no threads here, so whoever has some lends them: axes of a plan through points are planned and judged without
/// regard to each other. What comes out is the same to the last bit, whoever works.
pub trait Workers {
    /// Calls `work` with ranges that follow each other and make up `0..count`, maybe at the same time; what each gave, in order.
    ///
    /// One range at least, so that there is a result; of no items it is empty.
    fn each_range<R: Send>(&self, count: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R>;
}

/// The caller's thread alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Alone;

impl Workers for Alone {
    fn each_range<R: Send>(&self, count: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
        vec![work(0..count)]
    }
}
