//! The reader printed in the docs is the one that the client checks run.

#[test]
fn docs_show_the_tested_reader() {
    let docs = include_str!("../docs/table-format.md");
    for reader in [
        include_str!("clients/read_table.py"),
        include_str!("clients/read_packed.py"),
    ] {
        let (_, code) = reader.split_once('\n').unwrap_or_default();
        assert!(docs.contains(&format!("```python\n{}```", code.trim_start())));
    }
}
