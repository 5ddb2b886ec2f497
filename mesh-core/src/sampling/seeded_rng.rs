//! Random numbers that depend on a seed alone.

use std::ops::Range;

use rand::seq::SliceRandom;
use rand::{Rng, RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Random numbers from a seed: the stream cipher ChaCha with 8 rounds, read as a sequence of 32-bit words.
///
/// The sequence is part of this crate's promise: the same seed gives the same numbers on every platform, with every
/// thread count and in every release with the same major version. The seed becomes a key of 256 bits by the PCG32
/// generator of `rand_core` 0.9; each method says how it makes its numbers of words. Not for cryptography.
///
/// Source: Bernstein 2008, "ChaCha, a variant of Salsa20".
///
/// ```
/// use mesh_core::sampling::SeededRng;
/// let mut rng = SeededRng::new(7);
/// let start = rng.word_position();
/// let first = rng.uniform();
/// assert!((0.0..1.0).contains(&first));
/// rng.set_word_position(start);
/// assert_eq!(rng.uniform(), first);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeededRng {
    words: ChaCha8Rng,
}

impl SeededRng {
    /// The sequence of this seed, at its start.
    pub fn new(seed: u64) -> Self {
        Self {
            words: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// How many words have been used up: with the seed, all there is to know about the sequence's state.
    pub fn word_position(&self) -> u128 {
        self.words.get_word_pos()
    }

    /// Goes on after this many words of the sequence, forwards or backwards.
    pub fn set_word_position(&mut self, position: u128) {
        self.words.set_word_pos(position);
    }

    /// A uniform whole number: two words, the lower half first.
    pub fn next_u64(&mut self) -> u64 {
        self.words.next_u64()
    }

    /// Uniform in 0..1: the upper 53 bits of [`Self::next_u64`] over 2⁵³.
    pub fn uniform(&mut self) -> f64 {
        self.words.random()
    }

    /// Uniform in `range`: the upper 52 bits of [`Self::next_u64`] over 2⁵², scaled and moved.
    ///
    /// # Panics
    /// If `range` is empty or not finite.
    pub fn uniform_in(&mut self, range: Range<f64>) -> f64 {
        self.words.random_range(range)
    }

    /// A uniform row of `n`, 0..n: one word times `n`, the upper half, mended by a second word where the lower half says
    /// that the row would come too often (Lemire 2019); two words instead of one each where `n` has more than 32 bits.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        self.words.random_range(0..n)
    }

    /// Puts `items` into a uniformly random order: the shuffle of Fisher and Yates as `rand` 0.9 does it, with several
    /// swaps from one word.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        items.shuffle(&mut self.words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Computed apart from this code, from the definitions of ChaCha and PCG32. A change of these numbers changes every
    // result there is.
    #[test]
    fn the_sequence_of_a_seed_is_fixed() {
        let mut rng = SeededRng::new(0);
        let expected = [13_080_132_717_333_068_652, 8_594_738_769_458_413_623];
        assert_eq!([0; 2].map(|_| rng.next_u64()), expected);
        let expected = [0.699_143_242_674_731_7, 0.060_171_165_634_171_8];
        assert_eq!([0; 2].map(|_| rng.uniform()), expected);
        let expected = [0.758_221_435_917_237_2, 0.099_062_537_578_892_94];
        assert_eq!([0; 2].map(|_| rng.uniform_in(-1.0..1.0)), expected);
        assert_eq!([0; 6].map(|_| rng.below(10)), [4, 8, 8, 9, 4, 8]);
        let mut order = [0, 1, 2, 3, 4, 5, 6, 7];
        rng.shuffle(&mut order);
        assert_eq!(order, [2, 6, 3, 4, 5, 0, 1, 7]);
        assert_eq!(rng.word_position(), 19);
    }

    #[test]
    fn a_position_is_where_the_sequence_goes_on() {
        let mut rng = SeededRng::new(3);
        rng.below(5);
        let (position, next) = (rng.word_position(), rng.clone().next_u64());
        let mut other = SeededRng::new(3);
        other.set_word_position(position);
        assert_eq!(other, rng);
        assert_eq!(other.next_u64(), next);
    }

    #[test]
    fn numbers_stay_in_their_range() {
        let mut rng = SeededRng::new(1);
        for _ in 0..1000 {
            assert!((0.0..1.0).contains(&rng.uniform()));
            assert!((-2.0..5.0).contains(&rng.uniform_in(-2.0..5.0)));
            assert!(rng.below(3) < 3);
        }
    }
}
