use std::fs::File;
use std::io::Write as _;

use proto::Chunk;
use proto::Digest;

use crate::args::SampleArgs;
use crate::failure::Failure;
use crate::service::{Server, Service};
use crate::show::paint::Screen;
use crate::show::{csv, json};
use crate::source;

/// `portamento sample`
pub(crate) fn run(args: &SampleArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let plan = source::plan(args.source.path())?;
    let service = Service::open(server)?;
    let names: Vec<String> = plan.axes().iter().map(|axis| axis.axis.clone()).collect();
    let cycle_time = plan.cycle_time();
    let mut file: Option<File> = None;
    let mut text: Vec<u8> = Vec::new();
    let mut last = (args.first_cycle, Digest::ZERO);
    let mut first = true;
    service.sample(plan, args.first_cycle, args.cycles, &mut |chunk| {
        let Chunk { first_cycle, columns, digest } = chunk;
        last = ((first_cycle + columns.cycles() as u64).saturating_sub(1), digest);
        let first = std::mem::take(&mut first);
        text.clear();
        if screen.json {
            writeln!(text, "{}", json::sample_response(first_cycle, columns, digest)?)?;
        } else {
            if first {
                csv::header(&mut text, names.iter().map(String::as_str))?;
            }
            csv::rows(&mut text, cycle_time, first_cycle, &columns)?;
        }
        let Some(path) = &args.output else { return Ok(screen.out.write_all(&text)?) };
        // Made with the first setpoints: a plan that is refused leaves no file behind.
        if first {
            file = Some(File::create(path).map_err(Failure::unwritable(path))?);
        }
        file.as_mut().map_or(Ok(()), |file| file.write_all(&text)).map_err(Failure::unwritable(path))
    })?;
    let (cycle, digest) = last;
    writeln!(screen.notes, "digest {} (0x{digest}) through cycle {cycle}", u64::from(digest))?;
    Ok(())
}
