//! Files that others name: layers and grids beside a stage, and those of its variants.

use super::FUR;
use std::fs;
use std::path::Path;
use vair::check::Severity::{Error, Note};
use vair::check::{CheckSettings, Finding, Rule, check};

/// What is found in one of some files.
fn in_folder(files: &[(&str, &str)], checked: &str) -> Vec<Finding> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let path: &Path = &folder.path().join(checked);
    let checked = check(&[path], &CheckSettings::default());
    assert!(checked.refused.is_empty(), "{:?}", checked.refused);
    checked.findings
}

/// A root layer that gets its content from files.
fn root(fields: &str, inside: &str) -> String {
    format!(
        "#usda 1.0\n( defaultPrim = \"fox\" metersPerUnit = 1 upAxis = \"Y\" )\n\
         def Xform \"fox\" ( kind = \"component\" {fields} )\n{{\n{inside}\n}}\n"
    )
}

/// The sound file is as sound two references away, and a fault in it is found there.
#[test]
fn references_of_references_are_followed() {
    let fox = root("references = @./parts/fur.usda@", "");
    let parts = root("references = @./deep/fur.usda@", "");
    let files = |fur: &str| {
        let files = [
            ("fox.usda", fox.as_str()),
            ("parts/fur.usda", &parts),
            ("parts/deep/fur.usda", fur),
        ];
        let mut all = in_folder(&files, "fox.usda");
        all.retain(|f| f.severity > Note);
        all
    };
    assert_eq!(files(FUR), []);
    let all = files(&FUR.replacen("</fox/mtl/guard>", "</fox/mtl/gard>", 1));
    assert!(
        all.iter().all(|f| f.rule == Rule::C12) && !all.is_empty(),
        "{all:?}"
    );
    // And where it stands below another prim.
    let fox = root("", "def \"a\" ( references = @./fur.usda@ ) {}");
    let mut all = in_folder(&[("fox.usda", &fox), ("fur.usda", FUR)], "fox.usda");
    all.retain(|f| f.severity > Note && f.rule == Rule::C12);
    assert_eq!(all, []);
}

/// Whatever is named and not followed is said, and why.
#[test]
fn files_that_are_not_followed_say_why() {
    for (named, severity, word) in [
        ("./gone.usda", Error, "is not there"),
        ("./torn.usda", Error, "line 2"),
        ("./look.mtlx", Note, "is not looked into"),
        ("./fur.abc", Note, "is not looked into"),
        ("./fur.usdz", Note, "is not looked into"),
        ("omniverse://host/fur.usd", Note, "is not looked into"),
        ("`${SHOT}`", Note, "is not looked into"),
        ("./gone.abc", Error, "is not there"),
    ] {
        let text = root(&format!("payload = @{named}@"), "");
        let files = [
            ("fox.usda", text.as_str()),
            ("torn.usda", "#usda 1.0\ndef {"),
            ("look.mtlx", "<materialx/>"),
            ("fur.abc", "Ogawa"),
            ("fur.usdz", "PK"),
        ];
        let all = in_folder(&files, "fox.usda");
        assert_eq!(all.len(), 1, "{named}: {all:?}");
        assert_eq!(
            (all[0].rule, all[0].severity),
            (Rule::C16, severity),
            "{all:?}"
        );
        assert!(all[0].message.contains(word), "{all:?}");
    }
    // Arguments for a reader are no part of the path.
    let text = root("references = @./fur.usda:SDF_FORMAT_ARGS:a=b@", "");
    let mut all = in_folder(&[("fox.usda", &text), ("fur.usda", FUR)], "fox.usda");
    all.retain(|f| f.severity > Note);
    assert_eq!(all, []);
}

/// Faults of a variant that is not the one shown.
#[test]
fn all_variants_are_looked_at() {
    let field = |file: &str| {
        format!(
            "def Volume \"v\" {{ float3[] extent = [(0, 0, 0), (1, 1, 1)] rel field:density = </fox/v/density>\n\
             def OpenVDBAsset \"density\" {{ token fieldClass = \"fogVolume\" token fieldDataType = \"float\" \
             token fieldName = \"density\" asset filePath = @{file}@ }} }}"
        )
    };
    let with = |content: &str| {
        let sets = format!("variantSet \"look\" = {{ \"plain\" {{}} \"other\" {content} }}");
        let fields = "variants = { string look = \"plain\" } prepend variantSets = [\"look\"]";
        in_folder(&[("fox.usda", &root(fields, &sets))], "fox.usda")
    };
    assert_eq!(with("{}"), []);
    let gone = with("( payload = @./gone.usda@ ) {}");
    assert_eq!(gone.len(), 1, "{gone:?}");
    assert_eq!((gone[0].rule, gone[0].severity), (Rule::C16, Error));
    for (content, rule, attribute) in [
        (field("./gone.vdb"), Rule::C13, "filePath"),
        (
            field("./gone.vdb").replace("token fieldName = \"density\"", ""),
            Rule::C14,
            "fieldName",
        ),
        ("def Volume \"v\" {}".to_owned(), Rule::C11, "extent"),
    ] {
        let all = with(&format!("{{ {content} }}"));
        assert_eq!(all.len(), 1, "{all:?}");
        assert_eq!(
            (all[0].rule, all[0].attribute.as_str()),
            (rule, attribute),
            "{all:?}"
        );
        assert_eq!(
            all[0].prim.split('/').nth(1),
            Some("fox{look=other}"),
            "{all:?}"
        );
    }
}

/// Sets of prims below the root, and sets that only a choice of another brings.
#[test]
fn sets_of_all_prims_are_looked_at() {
    let fault = "def Volume \"v\" {}";
    let set = |name: &str, content: &str| {
        format!("variantSet \"{name}\" = {{ \"plain\" {{}} \"other\" {{ {content} }} }}")
    };
    let below = format!(
        "def Xform \"a\" {{ def Xform \"b\" {{ {} }} }}",
        set("size", fault)
    );
    let within = set(
        "look",
        &format!("def Xform \"c\" {{ {} }}", set("size", fault)),
    );
    for (inside, view) in [
        (below, "/fox{size=other}/a/b/v"),
        (within, "/fox{look=other,size=other}/c/v"),
    ] {
        let all = in_folder(&[("fox.usda", &root("", &inside))], "fox.usda");
        assert_eq!(all.len(), 1, "{all:?}");
        assert_eq!((all[0].rule, all[0].prim.as_str()), (Rule::C11, view));
    }
}

/// Prims that are referred to and are not in a file that is there.
#[test]
fn prims_that_are_not_there_are_said() {
    let parts = "#usda 1.0\n( subLayers = [@./sub.usda@] )\ndef \"a\" { def \"b\" {} }\n\
                 def \"r\" ( references = @./sub.usda@</s> ) {}\n";
    let sub = "#usda 1.0\ndef \"s\" { def \"t\" {} }\n";
    for (reference, found) in [
        ("@./parts.usda@</a/b>", None),
        // By a sublayer, and by what the prim above refers to.
        ("@./parts.usda@</s/t>", None),
        (
            "@./parts.usda@</r/t>",
            Some((Note, "parts.usda</r/t> is not looked into")),
        ),
        (
            "@./parts.usda@</a/c>",
            Some((
                Error,
                "parts.usda</a/c> is not there: the file has no such prim",
            )),
        ),
        (
            "@./parts.usda@</c>",
            Some((Error, "parts.usda</c> is not there")),
        ),
        (
            "@./parts.usda@",
            Some((
                Error,
                "parts.usda is referred to by its default prim, but names none",
            )),
        ),
        ("</gone>", Some((Error, "fox.usda</gone> is not there"))),
        ("</fox/here>", None),
    ] {
        let inside = format!("def \"here\" {{}}\ndef \"x\" ( references = {reference} ) {{}}");
        let text = root("", &inside);
        let files = [
            ("fox.usda", text.as_str()),
            ("parts.usda", parts),
            ("sub.usda", sub),
        ];
        let all = in_folder(&files, "fox.usda");
        let Some((severity, said)) = found else {
            assert_eq!(all, [], "{reference}");
            continue;
        };
        assert_eq!(all.len(), 1, "{reference}: {all:?}");
        assert_eq!(
            (all[0].rule, all[0].severity),
            (Rule::C16, severity),
            "{all:?}"
        );
        assert!(all[0].message.contains(said), "{all:?}");
    }
}

/// What is too much to look at is said.
#[test]
fn what_is_left_out_is_said() {
    let many = |count: usize| {
        let variants: Vec<String> = (0..count).map(|i| format!("\"v{i}\" {{}}")).collect();
        let sets = format!("variantSet \"look\" = {{ {} }}", variants.join(" "));
        in_folder(&[("fox.usda", &root("", &sets))], "fox.usda")
    };
    assert_eq!(many(32), []);
    let all = many(33);
    assert_eq!(all.len(), 1, "{all:?}");
    assert!(
        all[0].message.contains("of 33 variants only the first 32"),
        "{all:?}"
    );
    // A prim of ten of itself, twenty levels deep.
    let itself = ["@./fox.usda@"; 10].join(", ");
    let text = root(&format!("references = [{itself}]"), "");
    let all = in_folder(&[("fox.usda", &text)], "fox.usda");
    assert_eq!(all.len(), 1, "{all:?}");
    assert_eq!((all[0].rule, all[0].severity), (Rule::C16, Note));
    assert!(all[0].message.contains("was not checked"), "{all:?}");
}
