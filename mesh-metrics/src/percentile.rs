//! Percentiles: the one definition of every figure and explanation.

/// Percentiles of `values` at the given shares, interpolated linearly between neighbours.
///
/// Of n values in ascending order `v₀ ≤ … ≤ vₙ₋₁`, the percentile at share s is at the place `p = s (n − 1)`:
/// `v_⌊p⌋ + (p − ⌊p⌋) (v_⌊p⌋₊₁ − v_⌊p⌋)`. At 0 it is the smallest value, at 0.5 the median, at 1 the largest.
///
/// `shares`: each in 0..=1; one outside gives the value at the nearer end. Units are those of the values. Degenerate input: 0 where
/// there is no value. Source: definition 7 of Hyndman and Fan 1996. Departures: none.
///
/// ```
/// use mesh_metrics::percentiles;
/// assert_eq!(percentiles([4.0, 1.0, 3.0, 2.0], [0.0, 0.5, 1.0]), [1.0, 2.5, 4.0]);
/// ```
pub fn percentiles<const N: usize>(
    values: impl IntoIterator<Item = f64>,
    shares: [f64; N],
) -> [f64; N] {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    shares.map(|share| {
        let at = share.clamp(0.0, 1.0) * sorted.len().saturating_sub(1) as f64;
        let below = sorted.get(at as usize).copied().unwrap_or(0.0);
        let above = sorted.get(at as usize + 1).copied().unwrap_or(below);
        below + (above - below) * at.fract()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_between_values_are_interpolated() {
        // 1, 2, …, 11: the place of share s is 10 s.
        let values = || (1..=11).rev().map(f64::from);
        let got = percentiles(values(), [0.0, 0.25, 0.5, 0.9, 0.99, 1.0]);
        for (got, expected) in got.into_iter().zip([1.0, 3.5, 6.0, 10.0, 10.9, 11.0]) {
            assert!((got - expected).abs() < 1e-12, "{got} {expected}");
        }
        assert_eq!(percentiles(values(), [-1.0, 2.0]), [1.0, 11.0]);
    }

    #[test]
    fn few_values_have_percentiles_too() {
        assert_eq!(percentiles([7.0], [0.0, 0.5, 1.0]), [7.0; 3]);
        assert_eq!(percentiles([], [0.5]), [0.0]);
        assert_eq!(
            percentiles([4.0, 1.0, 3.0, 2.0], [0.0, 0.5, 1.0]),
            [1.0, 2.5, 4.0]
        );
    }
}
