//! What is wrong with a request: where ([`Field`]), what ([`Why`]), and everything at once ([`InvalidFields`]).

mod why;

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

pub use why::Why;

/// Where in a request something is wrong, written as the caller would write it: `axes[2].limits.max_jerk`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Field(String);

impl Field {
    /// A field by its name.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self(name.into())
    }

    /// Element `index` of a list.
    #[must_use]
    pub fn element(list: &str, index: usize) -> Self {
        Self(alloc::format!("{list}[{index}]"))
    }

    /// This field as part of `outer`.
    #[must_use]
    pub fn within(&self, outer: &Self) -> Self {
        if self.0.is_empty() || outer.0.is_empty() {
            return Self(alloc::format!("{}{}", outer.0, self.0));
        }
        Self(alloc::format!("{}.{}", outer.0, self.0))
    }

    /// The path as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// One field and what is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub struct InvalidField {
    /// Where.
    pub field: Field,
    /// What, and the way out.
    pub why: Why,
}

impl InvalidField {
    /// `why`, said of `field`.
    #[must_use]
    pub fn new(field: Field, why: Why) -> Self {
        Self { field, why }
    }
}

impl fmt::Display for InvalidField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.field.as_str().is_empty() {
            return write!(f, "{}", self.why);
        }
        write!(f, "{}: {}", self.field, self.why)
    }
}

/// Everything that is wrong with a request: never empty when it is an error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InvalidFields(Vec<InvalidField>);

impl InvalidFields {
    /// One thing that is wrong.
    #[must_use]
    pub fn one(field: Field, why: Why) -> Self {
        Self(alloc::vec![InvalidField::new(field, why)])
    }

    /// Adds one more.
    pub fn push(&mut self, invalid: InvalidField) {
        self.0.push(invalid);
    }

    /// Adds what is wrong with the field called `name`, if anything is.
    pub fn note(&mut self, name: &str, why: Option<Why>) {
        if let Some(why) = why {
            self.0.push(InvalidField::new(Field::named(name), why));
        }
    }

    /// Adds all of `inner`, as parts of the field `outer`.
    pub fn extend_within(&mut self, outer: &Field, inner: Self) {
        self.0.extend(
            inner
                .0
                .into_iter()
                .map(|InvalidField { field, why }| InvalidField { field: field.within(outer), why }),
        );
    }

    /// Keeps the value of a result, or adds its errors as parts of `outer`.
    pub fn take<T>(&mut self, outer: &Field, result: Result<T, Self>) -> Option<T> {
        result.map_err(|inner| self.extend_within(outer, inner)).ok()
    }

    /// The same, where `outer` is element `index` of a list: of what is right there is no path to be written.
    pub fn take_element<T>(&mut self, list: &str, index: usize, result: Result<T, Self>) -> Option<T> {
        result.map_err(|inner| self.extend_within(&Field::element(list, index), inner)).ok()
    }

    /// What is wrong, in the order in which it was found.
    #[must_use]
    pub fn as_slice(&self) -> &[InvalidField] {
        &self.0
    }

    /// Is nothing wrong?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// `value` if nothing is wrong.
    ///
    /// # Errors
    /// `self`, if anything is.
    pub fn into_result<T>(self, value: T) -> Result<T, Self> {
        if self.0.is_empty() { Ok(value) } else { Err(self) }
    }
}

impl fmt::Display for InvalidFields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, invalid) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str("; ")?;
            }
            write!(f, "{invalid}")?;
        }
        Ok(())
    }
}

impl core::error::Error for InvalidFields {}
