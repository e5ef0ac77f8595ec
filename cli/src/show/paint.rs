//! Where output goes, and how it is emphasised there.

use std::io::{self, IsTerminal, Write};

use clap::ColorChoice;
use clap::builder::styling::{AnsiColor, Style};

use crate::failure::Failure;
use crate::show::json;

/// What tables and paragraphs are at most [characters].
pub(crate) const WIDTH: usize = 80;

/// The two ways out of a command.
pub(crate) struct Screen<'a> {
    /// Standard output: the answer.
    pub(crate) out: &'a mut dyn Write,
    /// Standard error: what is said beside it.
    pub(crate) notes: &'a mut dyn Write,
    /// How the answer is emphasised.
    pub(crate) paint: Paint,
    /// How what is said beside it is emphasised.
    pub(crate) notes_paint: Paint,
    /// Is the answer for a program?
    pub(crate) json: bool,
}

/// Emphasis, or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    on: bool,
}

impl Paint {
    /// By what was asked, and where the text goes.
    pub(crate) fn new(choice: ColorChoice, to: &impl IsTerminal) -> Self {
        let wanted = || std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        let on = match choice {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => to.is_terminal() && wanted(),
        };
        Self { on }
    }

    pub(crate) fn heading(self, text: &str) -> String {
        self.with(Style::new().bold(), text)
    }

    pub(crate) fn quiet(self, text: &str) -> String {
        self.with(Style::new().dimmed(), text)
    }

    pub(crate) fn good(self, text: &str) -> String {
        self.with(AnsiColor::Green.on_default().bold(), text)
    }

    pub(crate) fn bad(self, text: &str) -> String {
        self.with(AnsiColor::Red.on_default().bold(), text)
    }

    fn with(self, style: Style, text: &str) -> String {
        if self.on { format!("{style}{text}{style:#}") } else { text.to_owned() }
    }
}

impl Screen<'_> {
    /// Says why a command ended early: one paragraph for people, an object for programs.
    pub(crate) fn tell(&mut self, failure: &Failure) -> io::Result<()> {
        match failure {
            // Nobody is left to hear it.
            Failure::ReaderGone => return Ok(()),
            // The answer says so.
            Failure::Differ => return Ok(()),
            Failure::NotPassed if self.json => return Ok(()),
            Failure::Refused(rejected) if self.json => {
                writeln!(self.out, "{}", json::error(rejected))?;
                return self.out.flush();
            }
            _ => {}
        }
        let (text, more) = match failure {
            Failure::Refused(rejected) => {
                (refusal(rejected), Some(format!("portamento explain {}", rejected.reason)))
            }
            Failure::NotPassed => {
                (failure.to_string(), Some(format!("portamento explain {}", proto::Reason::PlanRejected)))
            }
            other => (clean(&other.to_string()), None),
        };
        let code = failure.exit_code();
        let tail = match more {
            Some(command) => format!("(exit code {code}; `{command}` says more)"),
            None => format!("(exit code {code})"),
        };
        let error = self.notes_paint.bad("error:");
        let paragraph = wrapped(&format!("error: {text}. {tail}"), "");
        writeln!(self.notes, "{}", paragraph.replacen("error:", &error, 1))
    }
}

/// A refusal in words: every field, not only the first.
pub(crate) fn refusal(rejected: &proto::Rejected) -> String {
    let all: Vec<String> =
        rejected.fields.iter().map(|field| format!("{}: {}", field.field, field.description)).collect();
    let text = if all.is_empty() { rejected.message.clone() } else { all.join("; ") };
    clean(&format!("{}: {text}", rejected.reason))
}

/// Text from elsewhere, so that it cannot steer a terminal.
pub(crate) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

/// Words in lines of at most [`WIDTH`], each after `indent`. A no-break space holds two of them together and is
/// written as a space.
pub(crate) fn wrapped(text: &str, indent: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        let used = indent.len() + visible(&line);
        if !line.is_empty() && used + 1 + visible(word) > WIDTH {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.push(line);
    let lines: Vec<_> = lines.iter().map(|line| format!("{indent}{line}")).collect();
    lines.join("\n").replace('\u{a0}', " ")
}

/// What a text takes of a line [characters]: emphasis takes nothing.
fn visible(text: &str) -> usize {
    let mut parts = text.split('\x1b');
    let first = parts.next().map_or(0, |part| part.chars().count());
    // Each sequence of ours ends with the `m` of "select graphic rendition".
    let after = |part: &str| part.split_once('m').map_or(0, |(_, rest)| rest.chars().count());
    first + parts.map(after).sum::<usize>()
}
