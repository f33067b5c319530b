//! Combing curves and whorls, as files say them.

use super::*;
use crate::skin::Landmark;

/// A fox with a table of combing.
fn with(entry: &str) -> Result<Species, SpeciesErrors> {
    read(&format!("{}\n{entry}", text_of("fox")))
}

#[test]
fn curves_and_whorls_are_read_with_what_is_left_out() {
    let species = with(
        "[[groom.comb.curve]]\npoints = [[0, 1, 2], [-0.5, 1e-3, 0]]\nradius_mm = 20\n\
                        [[groom.comb.whorl]]\nlandmark = \"tail-tip\"\nradius_mm = 30\nhand = \"clockwise\"\n\
                        spiral_deg = 80\n[[groom.comb.whorl]]\ncenter = [1, 0, 0]\nradius_mm = 5\nrim_deg = 0",
    );
    let comb = species.unwrap().groom.comb;
    let curve = CombCurve {
        lines: vec![vec![[0.0, 1.0, 2.0], [-0.5, 1e-3, 0.0]]],
        is_placed: false,
        radius_mm: 20.0,
        strength: 1.0,
    };
    assert_eq!(comb.curves, [curve]);
    let first = Whorl {
        center: WhorlCenter::Landmark(Landmark::TailTip),
        radius_mm: 30.0,
        strength: 1.0,
        hand: Hand::Clockwise,
        spiral_deg: 80.0,
        rim_deg: 80.0,
    };
    let second = Whorl {
        center: WhorlCenter::Point([1.0, 0.0, 0.0]),
        radius_mm: 5.0,
        hand: Hand::CounterClockwise,
        spiral_deg: 60.0,
        rim_deg: 0.0,
        ..first.clone()
    };
    assert_eq!(comb.whorls, [first, second]);
    let json = serde_json::to_value(with("").unwrap()).unwrap();
    assert!(json.get("groom").is_none(), "nothing is said of nothing");
}

#[test]
fn combing_can_be_set_without_a_file() {
    let set = |text: &str| set("fox", &[text]);
    let species = set("groom.comb.whorl=[{landmark=\"crown\", radius_mm=30}]").unwrap();
    assert_eq!(species.groom.comb.whorls.len(), 1);
    let refused = refusals(set("groom.comb.whorl.0.radius_mm=3"));
    assert!(
        refused[0].contains("there is no list `groom.comb.whorl` in the file"),
        "{refused:?}"
    );
}

#[test]
fn what_is_wrong_is_said_with_its_key() {
    for (entry, expected) in [
        (
            "[[groom.comb.curve]]\nradius_mm = 3",
            "`groom.comb.curve.0.points` is missing",
        ),
        (
            "[[groom.comb.curve]]\npoints = [[0, 0, 0]]\nradius_mm = 3",
            "`groom.comb.curve.0.points` is an array of 1, expected 2 to 1000 points",
        ),
        (
            "[[groom.comb.curve]]\npoints = [[0, 0, 0], [1, 2]]\nradius_mm = 3",
            "`groom.comb.curve.0.points.1` is an array of 2, expected 3 numbers from",
        ),
        (
            "[[groom.comb.curve]]\npoints = [[0, 0, 0], [1, 2, nan]]\nradius_mm = 3",
            "`groom.comb.curve.0.points.1.2` is NaN, expected a number from",
        ),
        (
            "[[groom.comb.curve]]\npoints = [[0, 0, 0], [1, 2, 3]]\nfile = \"a.obj\"\nradius_mm = 3",
            "`groom.comb.curve.0.file` beside `groom.comb.curve.0.points`",
        ),
        (
            "[[groom.comb.curve]]\nfile = \"no.obj\"\nradius_mm = 3",
            "`groom.comb.curve.0.file`: cannot read no.obj",
        ),
        (
            "[[groom.comb.curve]]\nfile = \"a.txt\"\nradius_mm = 3",
            "must end in .obj, .usd, .usda or .usdc",
        ),
        (
            "[[groom.comb.whorl]]\nradius_mm = 3",
            "`groom.comb.whorl.0.center` is missing",
        ),
        (
            "[[groom.comb.whorl]]\nlandmark = \"spine\"\nradius_mm = 3",
            "`groom.comb.whorl.0.landmark` is \"spine\", expected one of",
        ),
        (
            "[[groom.comb.whorl]]\nlandmark = \"nose\"\nradius_mm = 0",
            "`groom.comb.whorl.0.radius_mm` is 0, expected a number from 0.1",
        ),
        (
            "[[under.groom.vary]]\nwhat = \"comb\"\nby = \"noise\"\nsize_mm = 3\nto = 2",
            "`under.groom.vary.0.to` is 2, expected 0 to 1",
        ),
    ] {
        let said = refusals(with(entry)).join("\n");
        assert!(said.contains(expected), "{entry}: {said}");
    }
}
