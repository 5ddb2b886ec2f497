//! Text of files for people to look at.

use std::borrow::Cow;
use std::fmt::Write;

/// `text` with what would not be seen, or would change how a terminal shows what surrounds it, written out: control
/// characters such as the escape that begins a terminal's command, and marks that turn the direction of writing.
///
/// Names in a file are whatever their author likes: every message goes through here before it quotes one.
///
/// ```
/// assert_eq!(mesh_core::io::printable("arm\u{1b}[31m"), "arm\\u{1b}[31m");
/// assert_eq!(mesh_core::io::printable("Ärmel 2"), "Ärmel 2");
/// ```
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_hidden(c) {
            write!(shown, "{}", c.escape_default()).expect("a string takes all characters");
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

fn is_hidden(c: char) -> bool {
    let turns_direction = matches!(
        c,
        '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{2069}' | '\u{FEFF}'
    );
    c.is_control() || turns_direction
}
