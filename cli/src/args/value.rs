//! Values of flags that are more than a number.

use std::path::PathBuf;

/// The address of a server, as far as it can be told without asking there.
pub(super) fn endpoint(text: &str) -> Result<String, String> {
    let wanted = "give http://HOST:PORT or https://HOST:PORT, as http://127.0.0.1:50051, or unix:/PATH";
    if text.strip_prefix("unix:/").is_some_and(|path| !path.is_empty() && !path.starts_with('/')) {
        return Ok(text.to_owned());
    }
    let authority = text.strip_prefix("http://").or_else(|| text.strip_prefix("https://")).ok_or(wanted)?;
    let authority = authority.strip_suffix('/').unwrap_or(authority);
    let (host, port) = match authority.rsplit_once(':') {
        Some((host, port)) if !port.ends_with(']') => (host, Some(port)),
        _ => (authority, None),
    };
    // What resolves is for the resolver to say; what could not be a name or a number is a slip of the finger.
    let of_host = |c: char| c.is_ascii_alphanumeric() || "-._~[]:%".contains(c);
    if host.is_empty() || !host.chars().all(of_host) {
        return Err(format!("{host:?} is not a host: {wanted}"));
    }
    match port.map(str::parse::<u16>) {
        Some(Err(_)) => Err(format!("{:?} is not a port: {wanted}", port.unwrap_or_default())),
        Some(Ok(_)) | None => Ok(text.to_owned()),
    }
}

/// A file for a plot: of a format that is written, so that no file holds what its name does not say.
pub(super) fn figure(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is = |format| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(format));
    if is("svg") || is("png") {
        return Ok(path);
    }
    let [svg, png] = ["svg", "png"].map(|format| path.with_extension(format));
    Err(format!("plots are SVG or PNG: name a file such as {} or {}", svg.display(), png.display()))
}

/// A file for a recording: of a format that is written.
pub(super) fn recording(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is = |format| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(format));
    if is("mcap") || is("csv") {
        return Ok(path);
    }
    let [mcap, csv] = ["mcap", "csv"].map(|format| path.with_extension(format));
    Err(format!(
        "recordings are MCAP, or cycles as CSV: name a file such as {} or {}",
        mcap.display(),
        csv.display()
    ))
}

/// How many of one unit make another: above 0, and such that numbers of the planner stay numbers in either.
pub(super) fn scale(text: &str) -> Result<f64, String> {
    const ALLOWED: std::ops::RangeInclusive<f64> = 1e-12..=1e12;
    let number: f64 = text.trim().parse().map_err(|_| format!("{text:?} is not a number"))?;
    if ALLOWED.contains(&number) { Ok(number) } else { Err("give 1e-12 to 1e12".to_owned()) }
}

/// A time with its unit, in whole nanoseconds. Whether it is long enough is for the planner to say.
pub(super) fn nanoseconds(text: &str) -> Result<i128, String> {
    const UNITS: [(&str, f64); 5] = [("ns", 1.0), ("us", 1e3), ("µs", 1e3), ("ms", 1e6), ("s", 1e9)];
    let (number, scale) = UNITS
        .iter()
        .find_map(|(unit, scale)| Some((text.strip_suffix(unit)?, *scale)))
        .ok_or("give its unit as well: 1ms, 250us or 0.002s")?;
    let number: f64 = number.trim().parse().map_err(|_| format!("{number:?} is not a number"))?;
    let ns = (number * scale).round();
    // Beyond this a double does not count nanoseconds any more, and no plan lasts as long.
    const LONGEST_NS: f64 = 9e15;
    if ns.abs() <= LONGEST_NS { Ok(ns as i128) } else { Err("give at most 9000000s".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endpoints_are_addresses() {
        let good = [
            "http://127.0.0.1:50051",
            "http://cell-7.local:80/",
            "http://[::1]:50051",
            "http://host",
            "unix:/run/p.sock",
        ];
        for text in good {
            assert_eq!(endpoint(text), Ok(text.to_owned()));
        }
        let bad =
            ["foo bar", "localhost:50051", "http://", "http://a b:1", "http://h:99999", "ftp://h:1", ""];
        for text in bad {
            assert!(endpoint(text).is_err_and(|why| why.contains("http://127.0.0.1:50051")), "{text}");
        }
    }

    #[test]
    fn plots_are_named_for_what_they_are() {
        for text in ["a/b.SVG", "b.png"] {
            assert_eq!(figure(text), Ok(PathBuf::from(text)));
        }
        for (text, named) in [("x.pdf", "x.svg"), ("plot", "plot.svg"), ("a.svg/b", "a.svg/b.svg")] {
            let way_out = format!("{named} or {}", named.replace(".svg", ".png").replace("a.png/", "a.svg/"));
            assert!(figure(text).is_err_and(|why| why.ends_with(&way_out)), "{text}");
        }
    }

    #[test]
    fn scales_are_positive() {
        assert_eq!((scale("1e6"), scale(" 0.5")), (Ok(1e6), Ok(0.5)));
        for text in ["0", "-1", "NaN", "inf", "1e13", "a", ""] {
            assert!(scale(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_have_units() {
        let rows = [("1ms", 1_000_000), ("250us", 250_000), ("0.002s", 2_000_000), ("-1 ms", -1_000_000)];
        for (text, ns) in rows {
            assert_eq!(nanoseconds(text), Ok(ns), "{text}");
        }
        for text in ["1", "ms", "NaNs", "1e300s"] {
            assert!(nanoseconds(text).is_err(), "{text}");
        }
    }
}
