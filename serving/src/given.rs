use std::convert::Infallible;
use std::fmt::Display;
use std::str::FromStr;
use std::time::Duration;

use crate::process::seconds;
use crate::settings::Misfits;

/// What was given for a setting: a value, or what is wrong with it, which is said together with all the rest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Given<T>(Result<T, String>);

impl<T: FromStr<Err: Display>> FromStr for Given<T> {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self(text.parse().map_err(|error| format!("is {text:?}: {error}"))))
    }
}

impl<T> Given<T> {
    /// The value; where there is none, what is wrong is noted.
    pub(crate) fn noted(self, setting: &'static str, misfits: &mut Misfits) -> Option<T> {
        self.0.map_err(|problem| misfits.note(setting, problem)).ok()
    }

    /// The value; where there is none, `instead`, and what is wrong is noted.
    pub fn or_note(self, setting: &'static str, instead: T, misfits: &mut Misfits) -> T {
        self.0.unwrap_or_else(|problem| {
            misfits.note(setting, problem);
            instead
        })
    }
}

/// A time, as a number of seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seconds(pub Duration);

impl FromStr for Seconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number: f64 = text.trim().parse().map_err(|_| GIVE_SECONDS.to_owned())?;
        seconds(number).map(Self).map_err(|_| GIVE_SECONDS.to_owned())
    }
}

const GIVE_SECONDS: &str = "give seconds, 0 or more";

/// Several values, with commas between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct List(pub Vec<String>);

impl FromStr for List {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        let items = text.split(',').map(str::trim).filter(|item| !item.is_empty());
        Ok(Self(items.map(str::to_owned).collect()))
    }
}
