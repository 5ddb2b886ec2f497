//! Sine and cosine of many phases at once, in plain arithmetic that compilers turn into vector instructions.

use std::f32::consts::FRAC_2_PI;

/// Larger phases are left to the standard library: past it, the reduction would lose digits.
const LARGEST: f32 = 8192.0;
/// 1.5 · 2²³: added to a number below 2²², it leaves the nearest whole number in the last bits.
const ROUNDER: f32 = 12_582_912.0;
/// π/2 in three parts; the first two have so few digits that whole multiples of them are exact.
const HALF_PI: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];
/// sin r ≈ r + r³ (s₀ + r² (s₁ + r² s₂)) on ±π/4.
const SINE: [f32; 3] = [-1.666_665_5e-1, 8.332_161e-3, -1.951_529_6e-4];
/// cos r ≈ 1 − r²/2 + r⁴ (c₀ + r² (c₁ + r² c₂)) on ±π/4.
const COSINE: [f32; 3] = [4.166_664_6e-2, -1.388_731_6e-3, 2.443_315_7e-5];

/// Sine and cosine of each phase, in radians: `sines[k] = sin phases[k]`, `cosines[k] = cos phases[k]`.
///
/// Within 1.2e-7 of the true values: one unit in the last place of 1. The same bits on every machine for phases up to
/// 8192; where one is larger or not finite, the standard library computes them all.
/// Source: Moshier's Cephes library, `sinf` and `cosf` (reduction after Cody and Waite, polynomials).
pub(super) fn sin_cos(phases: &[f32], sines: &mut [f32], cosines: &mut [f32]) {
    let places = phases.iter().zip(sines.iter_mut().zip(cosines));
    if phases.iter().all(|phase| phase.abs() <= LARGEST) {
        places.for_each(|(&phase, (sine, cosine))| (*sine, *cosine) = reduced(phase));
    } else {
        places.for_each(|(&phase, (sine, cosine))| (*sine, *cosine) = phase.sin_cos());
    }
}

/// Sine and cosine of a phase of ±[`LARGEST`]: `phase = q π/2 + r` with q whole and r in ±π/4.
#[inline]
fn reduced(phase: f32) -> (f32, f32) {
    let rounded = phase * FRAC_2_PI + ROUNDER;
    let (turns, q) = (rounded - ROUNDER, rounded.to_bits());
    let r = HALF_PI.iter().fold(phase, |r, part| r - turns * part);

    let r2 = r * r;
    let sine = r + r * r2 * (SINE[0] + r2 * (SINE[1] + r2 * SINE[2]));
    let cosine = 1.0 - 0.5 * r2 + r2 * r2 * (COSINE[0] + r2 * (COSINE[1] + r2 * COSINE[2]));

    // An odd q swaps the two; the second bit of q is the sign of the sine, that of q + 1 the sign of the cosine.
    let is_swapped = (q & 1).wrapping_neg();
    let [sine, cosine] = [sine.to_bits(), cosine.to_bits()];
    let choose = |a: u32, b: u32| (a & !is_swapped) | (b & is_swapped);
    let sign = |q: u32| (q & 2) << 30;
    (
        f32::from_bits(choose(sine, cosine) ^ sign(q)),
        f32::from_bits(choose(cosine, sine) ^ sign(q.wrapping_add(1))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(phases: &[f32]) -> Vec<[f32; 2]> {
        let mut sines = vec![0.0; phases.len()];
        let mut cosines = sines.clone();
        sin_cos(phases, &mut sines, &mut cosines);
        sines
            .into_iter()
            .zip(cosines)
            .map(|(s, c)| [s, c])
            .collect()
    }

    #[test]
    fn values_are_within_a_unit_in_the_last_place_of_1() {
        let grid = |span: f32| (-20_000..=20_000).map(move |k| k as f32 * (span / 20_000.0));
        let phases: Vec<f32> = [1.0, 30.0, LARGEST].into_iter().flat_map(grid).collect();
        for (&phase, found) in phases.iter().zip(of(&phases)) {
            let (sine, cosine) = f64::from(phase).sin_cos();
            for (found, exact) in found.into_iter().zip([sine, cosine]) {
                let error = (f64::from(found) - exact).abs();
                assert!(error < 1.2e-7, "{phase}: {error}");
            }
        }
    }

    #[test]
    fn quarter_turns_have_their_signs() {
        let quarter = std::f32::consts::FRAC_PI_2;
        let turns = [-2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0];
        let found = of(&turns.map(|q| q * quarter));
        let signs = [[0, -1], [-1, 0], [0, 1], [1, 0], [0, -1], [-1, 0], [0, 1]];
        for (found, expected) in found.into_iter().zip(signs) {
            assert_eq!(found.map(|v| v.round() as i32), expected);
        }
    }

    #[test]
    fn phases_too_large_to_be_reduced_are_those_of_the_standard_library() {
        let phases = [0.5, 1e6, -3e9, f32::INFINITY];
        for (phase, [sine, cosine]) in phases.into_iter().zip(of(&phases)) {
            let expected = phase.sin_cos();
            assert_eq!(sine.to_bits(), expected.0.to_bits());
            assert_eq!(cosine.to_bits(), expected.1.to_bits());
        }
    }
}
