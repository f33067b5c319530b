//! What varies over the skin, as files say it.

use super::*;

/// A fox with an entry of `vary`.
fn with(entry: &str) -> Result<Species, SpeciesErrors> {
    read(&format!(
        "{}\n[[under.groom.vary]]\n{entry}",
        text_of("fox")
    ))
}

#[test]
fn entries_are_read_with_what_is_left_out() {
    let species = with("what = \"frizz\"\nby = \"noise\"\nsize_mm = 12\nto = 3").unwrap();
    let vary = &species.classes[1].groom.vary;
    assert_eq!(vary.len(), 1);
    assert_eq!(
        (vary[0].what, vary[0].from, vary[0].to),
        (VaryWhat::Frizz, 0.0, 3.0)
    );
    let by = VaryBy::Noise {
        size_mm: 12.0,
        rough: 0.4,
        seed: 0,
    };
    assert_eq!(vary[0].by, by);
    assert!(species.classes[0].groom.vary.is_empty());
}

#[test]
fn names_are_in_the_order_of_what_varies() {
    for (choice, what) in fields::VARIED.iter().zip(VaryWhat::ALL) {
        let name = serde_json::to_value(what).unwrap();
        assert_eq!(name, choice.name);
    }
}

#[test]
fn what_is_wrong_is_said_with_its_key() {
    for (entry, expected) in [
        (
            "what = \"size\"\nby = \"noise\"\nsize_mm = 3",
            "`under.groom.vary.0.what` is \"size\"",
        ),
        (
            "what = \"length\"\nby = \"noise\"",
            "`under.groom.vary.0.size_mm` is missing",
        ),
        (
            "what = \"length\"\nby = \"map\"",
            "`under.groom.vary.0.file` is missing",
        ),
        (
            "what = \"length\"\nby = \"map\"\nfile = \"no.png\"",
            "`under.groom.vary.0.file`: ",
        ),
        (
            "what = \"density\"\nby = \"noise\"\nsize_mm = 3\nto = 2",
            "`under.groom.vary.0.to` is 2, expected 0 to 1",
        ),
        (
            "what = \"width\"\nby = \"noise\"\nsize_mm = 3\nfrom = -1",
            "`under.groom.vary.0.from` is -1, expected 0 to 10",
        ),
        (
            "what = \"width\"\nby = \"noise\"\nsize_mm = 3\nfile = \"a.png\"",
            "`under.groom.vary.0.file` has no meaning with by \"noise\"",
        ),
    ] {
        let said = refusals(with(entry)).join("\n");
        assert!(said.contains(expected), "{entry}: {said}");
    }
}
