//! ARCHITECTURE.md tells where each thing of the paper is in the code: it must be there.

use std::fs;
use std::path::Path;

/// The rows of the table: what, file and definition.
fn rows(text: &str) -> Vec<[String; 3]> {
    let table = text.split("## The paper in the code").nth(1);
    let table = table.and_then(|rest| rest.split("\n## ").next());
    let lines = table.expect("the table is there").lines();
    let cells = lines.filter(|line| line.starts_with('|')).skip(2);
    cells
        .map(|line| {
            let mut cells = line.trim_matches('|').split(" | ");
            [(); 3].map(|()| {
                let cell = cells.next().expect("three cells").trim();
                cell.trim_matches('`').to_owned()
            })
        })
        .collect()
}

#[test]
fn everything_of_the_paper_is_where_the_table_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let rows = rows(&text);
    assert!(rows.len() >= 14, "{} rows", rows.len());
    for [what, file, definition] in rows {
        let code =
            fs::read_to_string(root.join(&file)).unwrap_or_else(|_| panic!("{what}: {file}"));
        let is_there = code.lines().any(|line| {
            let after = line.split_once(&definition).map(|(_, after)| after);
            after.is_some_and(|after| after.starts_with(['(', '<', ' ', '{', ';']))
        });
        assert!(is_there, "{what}: {file} has no `{definition}`");
    }
}
