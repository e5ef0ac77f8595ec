use std::error::Error;

type Failed = Box<dyn Error + Send + Sync>;

/// CPU time that the threads of a process have used so far, without those that have ended \[s\]. Source: proc(5), `schedstat`, whose
/// first number is in nanoseconds; `stat` counts in ticks of 10 ms, as much as a hundred streams open in.
///
/// # Errors
/// Where there is no such process.
pub fn cpu(process: u32) -> Result<f64, Failed> {
    let mut nanoseconds = 0;
    for thread in std::fs::read_dir(format!("/proc/{process}/task"))? {
        // A thread may end between being listed and being read.
        let Ok(line) = std::fs::read_to_string(thread?.path().join("schedstat")) else { continue };
        nanoseconds += line.split_whitespace().next().unwrap_or_default().parse::<u64>()?;
    }
    Ok(nanoseconds as f64 * 1e-9)
}

/// The same with the threads that have ended, in ticks of 10 ms. Source: proc(5), fields 14 and 15 of `stat`.
///
/// # Errors
/// Where there is no such process.
pub fn cpu_with_ended(process: u32) -> Result<f64, Failed> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat"))?;
    let after_name = stat.rsplit_once(')').ok_or("stat has no name")?.1;
    let ticks =
        after_name.split_whitespace().skip(11).take(2).map(str::parse::<u64>).sum::<Result<u64, _>>()?;
    Ok(ticks as f64 / 100.0)
}

/// Memory that a process has in use \[KiB\].
///
/// # Errors
/// Where there is no such process.
pub fn resident_kib(process: u32) -> Result<u64, Failed> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status"))?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).ok_or("status has no VmRSS")?;
    Ok(line.split_whitespace().next().unwrap_or_default().parse()?)
}

/// What has gone over the loopback interface so far, both ways.
#[derive(Clone, Copy, Debug)]
pub struct Traffic {
    /// With the headers of Ethernet, IP and TCP \[bytes\].
    pub bytes: u64,
    /// How many packets that was.
    pub packets: u64,
}

/// Reads the loopback interface. Source: proc(5), the first two columns of `/proc/net/dev`.
///
/// # Errors
/// Where there is none.
pub fn loopback() -> Result<Traffic, Failed> {
    let table = std::fs::read_to_string("/proc/net/dev")?;
    let line =
        table.lines().find_map(|line| line.trim_start().strip_prefix("lo:")).ok_or("there is no lo")?;
    let mut columns = line.split_whitespace().map(str::parse);
    let mut next = || columns.next().ok_or("the line of lo is too short");
    Ok(Traffic { bytes: next()??, packets: next()?? })
}
