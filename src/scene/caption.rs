//! Values of a parameter in words, so that neighbours can be told apart.

/// `name = 0.30` for each of the values.
pub(super) fn captions(name: &str, values: &[f64]) -> Vec<String> {
    let decimals = decimals(values);
    let caption = |&value: &f64| {
        let written = match decimals {
            Some(decimals) => format!("{value:.decimals$}"),
            None => format!("{value:e}"),
        };
        format!("{name} = {}", without_sign_of_zero(&written))
    };
    values.iter().map(caption).collect()
}

/// What is rounded to 0 has no sign.
fn without_sign_of_zero(written: &str) -> &str {
    let is_zero = !written.contains(|c| ('1'..='9').contains(&c));
    written.strip_prefix('-').filter(|_| is_zero).unwrap_or(written)
}

/// Decimals that show each value to a hundredth of the least step between two neighbours; none if the
/// numbers are too large or too small to be written out.
fn decimals(values: &[f64]) -> Option<usize> {
    const MOST: usize = 9;
    const LARGE: f64 = 1e9;
    let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    if largest >= LARGE {
        return None;
    }
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let least = steps.filter(|&step| step > 0.0).fold(f64::INFINITY, f64::min);
    let most = if least.is_finite() { 0.01 * least } else { 1e-6 * largest };
    let error = |value: f64, decimals: usize| {
        let written: Option<f64> = format!("{value:.decimals$}").parse().ok();
        written.map_or(f64::INFINITY, |written| (written - value).abs())
    };
    (0..=MOST).find(|&decimals| values.iter().all(|&value| error(value, decimals) <= most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_have_as_many_decimals_as_tell_values_apart() {
        for (values, expected) in [
            (&[0.0, 0.1, 0.2][..], "0.1"),
            (&[0.0, 1.0, 2.0], "1"),
            (&[1.69, 1.2, 3.0], "1.20"),
            (&[0.0, 1.0 / 3.0, 1.0], "0.33"),
            (&[-0.5, -1e-17, 0.5], "0.0"),
            (&[1e12, 2e12], "2e12"),
            (&[0.0, 1e-15], "1e-15"),
            (&[2.5, 2.5], "2.5"),
        ] {
            assert_eq!(captions("a", values)[1], format!("a = {expected}"));
        }
    }
}
