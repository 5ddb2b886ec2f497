//! Messages of the readers of TOML and JSON, in words of whoever writes such files.

/// What types of this language are called.
const TYPES: [(&str, &str); 12] = [
    ("usize", "a whole number from 0"),
    ("u64", "a whole number from 0"),
    ("u32", "a whole number from 0"),
    ("u16", "a whole number from 0"),
    ("u8", "a whole number from 0"),
    ("i64", "a whole number"),
    ("i128", "a whole number"),
    ("f64", "a number"),
    ("f32", "a number"),
    ("bool", "true or false"),
    ("sequence", "list"),
    ("map", "table"),
];

/// `message` without the names of types: whoever wrote the file has never heard of them.
///
/// ```
/// let told = mesh_draping::plain_words("invalid type: string \"x\", expected usize in `n`");
/// assert_eq!(told, "invalid type: string \"x\", expected a whole number from 0 in `n`");
/// ```
pub fn plain_words(message: &str) -> String {
    let mut plain: Vec<String> = Vec::new();
    let mut words = message.split_whitespace();
    while let Some(word) = words.next() {
        match word {
            "internally" | "adjacently" | "externally" | "untagged" | "tagged" | "tuple" => (),
            "struct" => {
                words.next();
                plain.push("a table".to_owned());
            }
            "enum" => {
                words.next();
                plain.push("a choice".to_owned());
            }
            _ => plain.push(named(word)),
        }
    }
    plain.join(" ")
}

/// A word, or what the type of that name is called; what stands behind it stays.
fn named(word: &str) -> String {
    let core = word.trim_end_matches([',', '.', ':', ';']);
    let rest = &word[core.len()..];
    let known = TYPES.iter().find(|(name, _)| *name == core);
    known.map_or_else(|| word.to_owned(), |(_, plain)| format!("{plain}{rest}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_called_what_they_are() {
        for (message, plain) in [
            (
                "invalid type: integer `5`, expected struct InputRecord at line 1",
                "invalid type: integer `5`, expected a table at line 1",
            ),
            (
                "invalid type: map, expected internally tagged enum Kind",
                "invalid type: table, expected a choice",
            ),
            (
                "invalid type: string \"f64\", expected f64",
                "invalid type: string \"f64\", expected a number",
            ),
        ] {
            assert_eq!(plain_words(message), plain);
        }
    }
}
