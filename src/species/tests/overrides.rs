//! `--set` on every kind of field, and what it says when it cannot.

use super::super::*;
use super::{refusals, set};

#[test]
fn overrides_reach_every_kind_of_field() {
    let fox = set(
        "fox",
        &[
            "name=Blue fox",
            "latin = \"Vulpes sp.\"",
            "skin.color=[0, 0.5, 1]",
            "skin.color.2=0.25",
            "structure.medulla.void_ior=1.33",
            "guard.stations.0.cuticle.pattern=smooth",
            "guard.stations.1.medulla.kind=none",
            "guard.stations.1.medulla.ratio=0",
            "guard.stations.1.ior=1.6",
            "guard.groom.length_mm.value=44",
            "under.pigment=[{ eumelanin = 7, pheomelanin = 0 }]",
            "under.structure.aspect=1.3",
        ],
    )
    .unwrap();
    assert_eq!(
        (fox.name.as_str(), fox.latin.as_str()),
        ("Blue fox", "Vulpes sp.")
    );
    assert_eq!(fox.skin_color, [0.0, 0.5, 0.25]);
    let [guard, under] = &fox.classes[..] else {
        panic!("two classes");
    };
    let [stalk, shield] = &guard.stations[..] else {
        panic!("two stations");
    };
    assert_eq!(stalk.structure.medulla.void_ior, 1.33);
    assert_eq!(stalk.structure.cuticle.pattern, CuticlePattern::Smooth);
    assert_eq!(shield.structure.medulla.kind, MedullaKind::None);
    assert_eq!((stalk.structure.ior, shield.structure.ior), (1.55, 1.6));
    assert_eq!(guard.groom.length_mm, 44.0);
    assert_eq!(under.pigment.len(), 1);
    assert_eq!(under.pigment[0].eumelanin, 7.0);
    // The station's own value wins over the class's.
    assert_eq!(under.stations[0].structure.aspect, 1.05);
}

#[test]
fn a_wrong_override_is_named_as_the_user_wrote_it() {
    let cases = [
        (
            "guard.fo=1",
            "--set guard.fo=1: unknown key `guard.fo` (known here: ",
        ),
        (
            "gaurd.groom.clump=1",
            "unknown key `gaurd` (did you mean `guard`?)",
        ),
        (
            "guard.groom.clmp=1",
            "unknown key `guard.groom.clmp` (did you mean `clump`?)",
        ),
        (
            "guard.stations.2.ior=1.5",
            "`guard.stations` has no item `2`",
        ),
        (
            "guard.stations.x.ior=1.5",
            "`guard.stations` has no item `x`",
        ),
        (
            "guard.groom.shield.2=1",
            "`guard.groom.shield` has no item `2`",
        ),
        (
            "guard.groom.clump.x=1",
            "`guard.groom.clump` is a single value",
        ),
        (
            "guard.groom.clump=lots",
            "`guard.groom.clump` is the text \"lots\", expected a number",
        ),
        ("guard.groom.clump", "no `=`: expected key.path=value"),
        ("guard.groom=3", "`guard.groom` is 3, expected a table"),
        ("=3", "unknown key ``"),
        (
            "guard.stations.0.cuticle.pattern=mosiac",
            "(did you mean \"mosaic\"?)",
        ),
        ("classes=[\"guard\"]", "unknown key `under`"),
    ];
    for (text, expected) in cases {
        let lines = refusals(set("fox", &[text]));
        assert_eq!(lines.len(), 1, "{text}: {lines:?}");
        assert!(lines[0].contains(expected), "{text}: {lines:?}");
    }
}
