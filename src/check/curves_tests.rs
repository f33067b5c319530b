//! Limits that files of a test would be too long for.

use super::*;
use crate::check::finding::{Finding, Severity};
use crate::usd_file::{Prim, Property, Value};

/// What is found of so many prims, of the same group or each of its own, that have the same strands.
fn found(prims: i64, counts: &[i64], points: &[f32], is_one_group: bool) -> Vec<Finding> {
    let prim = |i: i64| Prim {
        name: format!("p{i}"),
        properties: vec![Property {
            name: "primvars:groom_group_id".into(),
            value: Some(Value::Ints([if is_one_group { 7 } else { i }].into())),
            ..Property::default()
        }],
        ..Prim::default()
    };
    let prims: Vec<Prim> = (0..prims).map(prim).collect();
    let item = |prim| Item {
        path: String::new(),
        prim,
        purpose: "render",
        is_groom: true,
        is_bound: true,
        is_moved: false,
    };
    let items: Vec<Item<'_>> = prims.iter().map(item).collect();
    let curves = |item| Curves {
        item,
        counts,
        points,
        is_cubic: true,
        basis: "catmullRom",
        wrap: "pinned",
    };
    let all: Vec<Curves<'_>> = items.iter().map(curves).collect();
    let mut findings = Findings::new("x", &[]);
    check_limits(&all, &mut findings);
    findings.all
}

#[test]
fn groups_hold_as_much_as_unreal_does() {
    let (counts, points) = (vec![3; 300_000], vec![0.0; 3_000_000]);
    for (prims, counts) in [(14, &counts[..]), (17, &[3])] {
        assert_eq!(found(prims - 1, counts, &points, true), []);
        assert_eq!(found(prims, counts, &points, false), []);
        let all = found(prims, counts, &points, true);
        assert_eq!(all.len(), 1, "{all:?}");
        assert_eq!((all[0].rule, all[0].severity), (Rule::C05, Severity::Error));
    }
}

#[test]
fn strands_have_255_points_at_most() {
    assert_eq!(found(1, &[255], &[], true), []);
    assert_eq!(found(1, &[256], &[], true).len(), 1);
}

#[test]
fn numbers_of_points_are_those_of_the_kind() {
    let prim = Prim::default();
    let item = Item {
        path: String::new(),
        prim: &prim,
        purpose: "render",
        is_groom: true,
        is_bound: true,
        is_moved: false,
    };
    let fits = |is_cubic, basis, wrap| {
        let curves = Curves {
            item: &item,
            counts: &[],
            points: &[],
            is_cubic,
            basis,
            wrap,
        };
        (0..9)
            .filter(|count| curves.fits(*count))
            .collect::<Vec<i64>>()
    };
    assert_eq!(fits(false, "bezier", "nonperiodic"), [2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(fits(true, "bezier", "nonperiodic"), [4, 7]);
    assert_eq!(fits(true, "bezier", "periodic"), [3, 6]);
    assert_eq!(fits(true, "bspline", "nonperiodic"), [4, 5, 6, 7, 8]);
    assert_eq!(fits(true, "catmullRom", "pinned"), [2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(fits(true, "catmullRom", "periodic"), [3, 4, 5, 6, 7, 8]);
}
