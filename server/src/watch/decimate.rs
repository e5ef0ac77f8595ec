//! Which cycles of many say most.

use std::collections::BTreeSet;

/// At most `most` of `rows` places, ascending: both ends, then the extremes of each column in turn as far as there is room,
/// then those of the first column in equal spans. All of them where they fit.
pub(super) fn kept(columns: &[Vec<f64>], rows: usize, most: usize) -> Vec<usize> {
    if rows <= most {
        return (0..rows).collect();
    }
    let mut kept = BTreeSet::new();
    let mut keep = |place: Option<usize>| {
        if let Some(place) = place
            && kept.len() < most
        {
            kept.insert(place);
        }
        kept.len()
    };
    // The newest says where the axis is now.
    keep(Some(rows - 1));
    for column in columns {
        let (least, greatest) = extremes(column, 0, rows);
        keep(least);
        keep(greatest);
    }
    let used = keep(Some(0));
    let spans = most.saturating_sub(used) / 2;
    for span in 0..spans {
        let (from, to) = (span * rows / spans, (span + 1) * rows / spans);
        let (least, greatest) = columns.first().map_or((None, None), |column| extremes(column, from, to));
        keep(least.or(Some(from)));
        keep(greatest);
    }
    kept.into_iter().collect()
}

/// The places of the least and of the greatest value from `from` to before `to`; what is not a number is neither.
fn extremes(column: &[f64], from: usize, to: usize) -> (Option<usize>, Option<usize>) {
    let numbers = || (from..to.min(column.len())).filter(|&place| !column[place].is_nan());
    let by_value = |a: &usize, b: &usize| column[*a].total_cmp(&column[*b]);
    (numbers().min_by(by_value), numbers().max_by(by_value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_kept_and_there_is_an_end() {
        let mut error = vec![0.0; 10_000];
        error[1234] = 1.0;
        error[4321] = -1.0;
        let mut jerk = vec![0.0; 10_000];
        jerk[77] = 5.0;
        jerk[78] = f64::NAN;
        let places = kept(&[error, jerk], 10_000, 50);
        assert!(places.len() <= 50 && places.len() > 30, "{}", places.len());
        assert!(places.is_sorted());
        for place in [0, 77, 1234, 4321, 9999] {
            assert!(places.contains(&place), "{place}: {places:?}");
        }
    }

    #[test]
    fn what_fits_is_kept_whole() {
        assert_eq!(kept(&[vec![3.0, 1.0, 2.0]], 3, 3), [0, 1, 2]);
        assert_eq!(kept(&[vec![3.0, 1.0, 2.0]], 3, 2), [1, 2]);
        assert_eq!(kept(&[], 0, 5), Vec::<usize>::new());
    }
}
