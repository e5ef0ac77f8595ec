//! Settings in a file: under the names of the flags, below them and the environment. A key is a flag's default, so that the
//! three are read in one way, and nothing can be set in one that cannot in the others.

use std::fmt::Write as _;
use std::path::Path;

use clap::{Arg, Command};
use toml::{Table, Value};

use crate::settings::Misfits;

/// `command` with the defaults that the file at `path` says. What is wrong with the file is noted.
pub(crate) fn with_defaults(command: Command, path: &Path, misfits: &mut Misfits) -> Command {
    match std::fs::read_to_string(path) {
        Ok(text) => with_settings(command, &text, &path.display().to_string(), misfits),
        Err(error) => {
            misfits.note("config", format!("{} cannot be read: {error}", path.display()));
            command
        }
    }
}

/// `command` with the defaults that a text says, which is called `name` where it is wrong.
pub fn with_settings(command: Command, text: &str, name: &str, misfits: &mut Misfits) -> Command {
    let table = match text.parse::<Table>() {
        Ok(table) => table,
        Err(error) => {
            misfits.note("config", format!("{name} is no TOML: {}", error.to_string().trim()));
            return command;
        }
    };
    table.into_iter().fold(command, |command, (key, value)| {
        let known = settings(&command).any(|arg| arg.get_id() == key.as_str());
        if !known {
            let keys: Vec<&str> = settings(&command).map(|arg| arg.get_id().as_str()).collect();
            let nearest = nearest(&key, &keys);
            misfits.note(key, format!("in {name} is no setting{nearest}"));
            return command;
        }
        match text_of(&value) {
            Some(text) => command.mut_arg(key, |arg| arg.default_value(text)),
            None => {
                misfits.note(key, format!("in {name} is neither text, number, truth nor a list of texts"));
                command
            }
        }
    })
}

/// Everything that can be set, as a file with its defaults: what is set by nothing stands there as a comment.
#[must_use]
pub fn settings_file(command: &Command) -> String {
    let mut text = format!(
        "# Settings of {name}: --config FILE.toml. Environment and flags go before what stands here.\n\
         # Written by `{name} settings`; every line has its default.\n",
        name = command.get_name()
    );
    let mut heading = None;
    for arg in settings(command) {
        if arg.get_help_heading() != heading {
            heading = arg.get_help_heading();
            // Writing to a string does not fail.
            let _ = writeln!(text, "\n# ---- {}", heading.unwrap_or("Ports and ways"));
        }
        // Help texts of one paragraph have lost their full stop.
        let help = arg.get_help().map(|help| format!("{help}.")).unwrap_or_default();
        let variable = arg.get_env().and_then(|name| name.to_str()).unwrap_or_default();
        let key = arg.get_id().as_str();
        let default = arg.get_default_values().first().and_then(|value| value.to_str());
        let line = match default {
            Some(value) if value.parse::<f64>().is_ok() || value.parse::<bool>().is_ok() => {
                format!("{key} = {value}")
            }
            Some(value) => format!("{key} = {}", Value::from(value)),
            None => {
                let shape =
                    arg.get_value_names().and_then(|names| names.first()).map_or("", |name| name.as_str());
                format!("# {key} = {}", Value::from(shape))
            }
        };
        let _ = writeln!(text, "\n{}# {variable}\n{line}", commented(&help));
    }
    text
}

/// The flags that a file may set.
fn settings(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|arg| !["help", "version", "config"].contains(&arg.get_id().as_str()))
}

/// What a flag would be given.
fn text_of(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Integer(number) => Some(number.to_string()),
        Value::Float(number) => Some(number.to_string()),
        Value::Boolean(truth) => Some(truth.to_string()),
        Value::Array(items) => {
            let items: Option<Vec<&str>> = items.iter().map(Value::as_str).collect();
            items.map(|items| items.join(","))
        }
        Value::Datetime(_) | Value::Table(_) => None,
    }
}

/// What may have been meant.
fn nearest(key: &str, keys: &[&str]) -> String {
    let alike = |known: &&&str| {
        let letters = |text: &str| text.replace(['-', '_'], "").to_lowercase();
        let (given, known) = (letters(key), letters(known));
        given == known || (given.len() > 3 && (known.contains(&given) || given.contains(&known)))
    };
    match keys.iter().find(alike) {
        Some(known) => format!(": {known} is"),
        None => ": the flags of --help are, with _ for -".to_owned(),
    }
}

/// As lines of a comment, of a width that is read well.
fn commented(text: &str) -> String {
    let mut lines = String::new();
    let mut line = String::from("#");
    for word in text.split_whitespace() {
        if line.len() + 1 + word.len() > WIDTH {
            lines.push_str(&line);
            lines.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line.push_str(word);
    }
    lines + &line + "\n"
}

const WIDTH: usize = 118;
