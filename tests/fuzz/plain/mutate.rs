//! Damage to files: the same number, the same damage.

use mesh_core::sampling::SeededRng;

/// Whole numbers at random.
struct Dice(SeededRng);

impl Dice {
    fn new(seed: u64) -> Self {
        Self(SeededRng::new(seed))
    }

    /// From 0 to less than `n`; 0 where `n` is 0.
    fn below(&mut self, n: usize) -> usize {
        (self.0.next_u64() % n.max(1) as u64) as usize
    }

    fn byte(&mut self) -> u8 {
        self.below(256) as u8
    }
}

/// Words that readers have stumbled over.
const WORDS: [&[u8]; 24] = [
    b"0",
    b"-1",
    b"1e308",
    b"-1e308",
    b"1e-320",
    b"nan",
    b"inf",
    b"4294967295",
    b"2147483648",
    b"99999999999999999999",
    b"1e9",
    b"0.5",
    b",",
    b"\n",
    b"\r\n",
    b" ",
    b"[",
    b"{",
    b"\"",
    b"#",
    b"\0\0\0\0",
    b"\xff\xff\xff\xff",
    b"-",
    b"/",
];

/// The input with number `k`: a seed, in a role of its own, with up to eight pieces of damage.
pub(crate) fn input(seeds: &[Vec<u8>], k: u64) -> Vec<u8> {
    let mut dice = Dice::new(k);
    let mut bytes = seeds[dice.below(seeds.len())].clone();
    let other = &seeds[dice.below(seeds.len())];
    choose_role(&mut bytes, &mut dice);
    for _ in 0..dice.below(9) {
        damage(&mut bytes, other, &mut dice);
    }
    bytes
}

/// What is done with the file, and what it is called: mostly what its format would be.
fn choose_role(bytes: &mut [u8], dice: &mut Dice) {
    if let [role, kind, ..] = bytes {
        let is_mesh = *role == 0 && *kind < 8;
        match (is_mesh, *role) {
            (true, _) => {
                *role = dice.byte();
                let is_plain = u8::from(dice.below(8) > 0);
                *kind = (*kind + 8 * (dice.byte() % 32)) | (is_plain << 6);
            }
            (false, 0) => *role = [0, 2][dice.below(2)],
            _ => (),
        }
    }
}

/// One piece of damage, behind the bytes that choose the role.
fn damage(bytes: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    let (at, length) = (2 + dice.below(bytes.len() - 2), 1 + dice.below(24));
    let at = at.min(bytes.len());
    let end = (at + length).min(bytes.len());
    match dice.below(9) {
        0 if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
        1 if at < bytes.len() => bytes[at] = dice.byte(),
        2 => drop(bytes.drain(at..end)),
        3 => {
            let piece = bytes[at..end].to_vec();
            let to = 2 + dice.below(bytes.len() - 2);
            bytes.splice(to..to, piece);
        }
        4 => bytes.truncate(at),
        5 => {
            let word = WORDS[dice.below(WORDS.len())];
            bytes.splice(at..at, word.iter().copied());
        }
        6 => replace_number(bytes, at, dice),
        7 => {
            let from = dice.below(other.len());
            let piece = &other[from..(from + 8 * length).min(other.len())];
            bytes.splice(at..at, piece.iter().copied());
        }
        _ => {
            let lines = bytes[at..].iter().take_while(|&&b| b != b'\n').count();
            let line = bytes[at..at + lines].to_vec();
            for _ in 0..dice.below(20) {
                bytes.splice(at..at, line.iter().copied().chain([b'\n']));
            }
        }
    }
}

/// Puts a word in the place of the number of a text at or behind a place.
fn replace_number(bytes: &mut Vec<u8>, at: usize, dice: &mut Dice) {
    let is_digit = |b: &u8| b.is_ascii_digit() || *b == b'.';
    let Some(start) = bytes[at..].iter().position(is_digit).map(|n| at + n) else {
        return;
    };
    let n = bytes[start..].iter().take_while(|b| is_digit(b)).count();
    let word = WORDS[dice.below(12)];
    bytes.splice(start..start + n, word.iter().copied());
}
