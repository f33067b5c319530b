//! The reader printed in the docs is the one that the client checks run.

#[test]
fn docs_show_the_tested_reader() {
    let tables = include_str!("../docs/table-format.md");
    let sums = include_str!("../docs/sums-format.md");
    for (docs, reader) in [
        (tables, include_str!("clients/read_table.py")),
        (tables, include_str!("clients/read_packed.py")),
        (sums, include_str!("clients/read_sums.py")),
        (tables, include_str!("clients/read_azimuths.py")),
    ] {
        let (_, code) = reader.split_once('\n').unwrap_or_default();
        assert!(docs.contains(&format!("```python\n{}```", code.trim_start())));
    }
}
