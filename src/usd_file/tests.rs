//! Both forms are read as the writer meant them, and broken files are refused.

#![allow(clippy::unwrap_used, clippy::panic)]

use super::*;
use crate::export::usd::{self, Array, Attribute, Form, Rows, Value as Written, VariantSet as Set};
use std::io::Cursor;
use std::path::Path;

fn sample() -> usd::Layer<'static> {
    let mut curves = usd::Prim::new("BasisCurves", "hair");
    let points = (0..40).map(|i| [i as f32, 0.5 * i as f32, -1.0]).collect();
    curves.set("point3f[]", "points", Array::Vec3(Rows::of(points)).into());
    let counts = vec![2; 20];
    curves.set(
        "int[]",
        "curveVertexCounts",
        Array::Int(Rows::of(counts)).into(),
    );
    let few = Array::Int(Rows::of(vec![-7, 9]));
    curves.primvar("int[]", "few", "uniform", few.into());
    let uv = Array::Vec2(Rows::of(vec![[0.25, 0.75]; 20]));
    curves.primvar("texCoord2f[]", "st", "uniform", uv.into());
    curves.add(Attribute {
        name: "widths".into(),
        type_name: "float[]",
        interpolation: "vertex",
        value: Some(Array::Float(Rows::of(vec![1e-4; 40])).into()),
        ..Attribute::default()
    });
    curves.api_schemas.push("MaterialBindingAPI".into());
    curves.relate("material:binding", "/fox/mtl/hair");
    curves.primvar(
        "string[]",
        "names",
        "constant",
        Written::Strings(vec!["a \"b\"\n".into()]),
    );
    let mut root = usd::Prim::new("Xform", "fox");
    root.kind = "component";
    root.custom_data = vec![(
        "vair".into(),
        Written::Dictionary(vec![
            ("share".into(), Written::Double(0.1)),
            ("strands".into(), Written::Int(20)),
        ]),
    )];
    root.asset_info = vec![("identifier".into(), Written::Asset("./a@b.usda".into()))];
    root.payload = Some("./fox@2x.payload.usdc".into());
    root.selections.push(("lod".into(), "full".into()));
    let mut full = usd::Prim::over("full");
    full.children.push(usd::Prim::over("hair"));
    let low = usd::Prim::over("low");
    root.variant_sets.push(Set {
        name: "lod".into(),
        variants: vec![full, low],
    });
    root.set("double", "third", Written::Double(1.0 / 3.0));
    root.set("color3f", "tint", Written::Vec3([0.1, 0.2, 0.3]));
    root.add(Attribute {
        name: "outputs:surface".into(),
        type_name: "token",
        connection: Some("/fox/mtl/hair.outputs:out".into()),
        ..Attribute::default()
    });
    root.children.push(curves);
    usd::Layer {
        documentation: "two\nlines".into(),
        default_prim: "fox".into(),
        meters_per_unit: 0.01,
        up_axis: "Z",
        custom_data: Vec::new(),
        prims: vec![root],
    }
}

fn written(form: Form) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    usd::write(&sample(), form, &mut out, &mut |_| Ok(())).unwrap();
    out.into_inner()
}

#[test]
fn both_forms_are_the_same_layer() {
    let text = parse(&written(Form::Text)).unwrap();
    let binary = parse(&written(Form::Binary)).unwrap();
    assert_eq!(text.field("defaultPrim"), Some(&Value::Text("fox".into())));
    assert_eq!(binary.field("metersPerUnit"), Some(&Value::Number(0.01)));
    for layer in [&text, &binary] {
        let fox = &layer.prims[0];
        assert_eq!(
            (fox.type_name.as_str(), fox.specifier),
            ("Xform", Specifier::Def)
        );
        let recipe = fox.field("customData").unwrap().get("vair").unwrap();
        assert_eq!(recipe.get("strands"), Some(&Value::Number(20.0)));
        let payload = Reference {
            asset: "./fox@2x.payload.usdc".into(),
            prim: String::new(),
        };
        assert_eq!(
            fox.field("payload"),
            Some(&Value::References(vec![payload]))
        );
        assert_eq!(fox.value("third"), Some(&Value::Number(1.0 / 3.0)));
        assert_eq!(
            fox.property("outputs:surface").unwrap().targets,
            ["/fox/mtl/hair.outputs:out"]
        );
        let names: Vec<&str> = fox.variant_sets[0]
            .variants
            .iter()
            .map(|v| &*v.name)
            .collect();
        assert_eq!(names, ["full", "low"]);
        let hair = fox.child("hair").unwrap();
        assert!(hair.has_api("MaterialBindingAPI"));
        assert_eq!(
            hair.property("material:binding").unwrap().targets,
            ["/fox/mtl/hair"]
        );
        assert_eq!(
            hair.property("widths").unwrap().word("interpolation"),
            "vertex"
        );
        assert_eq!(
            hair.value("primvars:few"),
            Some(&Value::Ints([-7, 9].into()))
        );
        assert_eq!(
            hair.value("primvars:names"),
            Some(&Value::Texts(vec!["a \"b\"\n".into()]))
        );
        let Some(Value::Floats { values, width: 3 }) = hair.value("points") else {
            panic!("{:?}", hair.value("points"));
        };
        assert_eq!(values[3 * 39..], [39.0, 19.5, -1.0]);
    }
    // All properties, in order, with their types, values and metadata.
    let (a, b) = (&text.prims[0], &binary.prims[0]);
    assert_eq!(
        a.child("hair").unwrap().properties,
        b.child("hair").unwrap().properties
    );
    let names = |prim: &Prim| {
        prim.properties
            .iter()
            .map(|p| p.name.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(a), names(b));
}

#[test]
fn text_of_other_hands_is_read() {
    let layer = parse(
        br#"#usda 1.0
(
    "a comment"   # and another
    defaultPrim = 'a'
    subLayers = [@./b.usda@ (offset = 1; scale = 2), @c.usda@]
    timeCodesPerSecond = 24
)
/* several
lines */
def Xform "a" (
    add references = [@x.usda@</b> (offset = 2), </class>]
    delete apiSchemas = ["Gone"]
    prepend apiSchemas = ["One"]
    append apiSchemas = ["Two"]
    instanceable = true
    variants = { string look = "red" }
    doc = """two
"lines" """
)
{
    custom double3 xformOp:translate = (1, -2e3, .5)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    matrix4d m = ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1) )
    point3f[] points.timeSamples = {
        0: [(0, 0, 0), (1, 1, nan)],
        1.5: None,
    }
    bool[] flags = [1, true, false]
    float inputs:x.connect = [</a.y>, </a.z>]
    prepend rel things = </a/b>
    rel nothing
    int[] empty = []
    uint64[] hashes = [18446744073709551615, 3]
    double bent.spline = { bezier, pre: held, 1: 8; post curve (1, 2); 2: 9, { int x = 1 } }
    reorder properties = ["m"]
    class "b" {}
    variantSet "look" = {
        "red" ( kind = "group" ) { def Scope "s" {} }
        "blue" {}
    }
}
"#,
    )
    .unwrap();
    let a = &layer.prims[0];
    assert!(a.has_api("One") && a.has_api("Two") && !a.has_api("Gone"));
    assert_eq!(
        a.value("xformOp:translate"),
        Some(&Value::Tuple(vec![1.0, -2000.0, 0.5]))
    );
    assert_eq!(a.value("flags"), Some(&Value::Ints([1, 1, 0].into())));
    assert_eq!(a.value("empty"), Some(&Value::Ints([].into())));
    assert_eq!(a.value("hashes"), Some(&Value::Ints([-1, 3].into())));
    assert_eq!(a.property("inputs:x").unwrap().targets, ["/a.y", "/a.z"]);
    let points = a.property("points").unwrap();
    assert_eq!(
        (points.samples[1].0, &points.samples[1].1),
        (1.5, &Value::Block)
    );
    assert!(
        matches!(&points.samples[0].1, Value::Floats { values, width: 3 } if values[5].is_nan())
    );
    let Some(Value::References(references)) = a.field("references") else {
        panic!();
    };
    assert_eq!(references[1].prim, "/class");
    assert_eq!(a.children[0].specifier, Specifier::Class);
}

#[test]
fn files_beside_a_layer_and_variants_are_put_together() {
    let text = |text: &str| parse(text.as_bytes()).unwrap();
    let root = text(
        r#"#usda 1.0
def "a" (payload = @./b.usda@ variants = {string lod = "low"}) { int x = 1 }
def "z" (payload = @./z.usda@) {}"#,
    );
    let open = |path: &Path| match path == Path::new("folder/b.usda") {
        false => Err(Unfollowed::Gone),
        true => Ok(text(
            r#"#usda 1.0
( defaultPrim = "b" )
def Xform "b" (variants = {string lod = "full"}) {
    int x = 2
    rel r = </b/c.y>
    def Scope "c" { int y = 3 }
    variantSet "lod" = { "full" { over "c" { int n = 9 } } "low" { over "c" { int n = 1 } } }
}"#,
        )),
    };
    let mut files = Files::new(&open);
    let number = |prims: &[Prim]| prims[0].child("c").unwrap().value("n").unwrap().number();
    let prims = compose(&root, Path::new("folder/a.usda"), &mut files, &[]);
    assert_eq!(prims[0].value("x"), Some(&Value::Number(1.0)));
    assert_eq!(prims[0].type_name, "Xform");
    assert_eq!(prims[0].property("r").unwrap().targets, ["/a/c.y"]);
    assert_eq!(number(&prims), Some(1.0));
    let full = [("lod".to_owned(), "full".to_owned())];
    let prims = compose(&root, Path::new("folder/a.usda"), &mut files, &full);
    assert_eq!(number(&prims), Some(9.0));
    assert_eq!(
        files.unfollowed,
        [("folder/z.usda".to_owned(), Unfollowed::Gone)]
    );
    assert!(!files.is_cut);
}

/// Targets move with what they are of, once for each reference, and files are found beside the layer that names them.
#[test]
fn targets_and_files_follow_two_references() {
    let text = |text: &str| Ok(parse(text.as_bytes()).unwrap());
    let open = |path: &Path| match path.to_str().unwrap() {
        "a/b.usda" => text(
            r#"#usda 1.0
def "fox" { def "skin" ( references = @./c/c.usda@</fox> ) {} rel here = </fox/skin/mtl> }"#,
        ),
        "a/c/c.usda" => text(
            r#"#usda 1.0
def "fox" {
    rel to = [</fox/mtl>, </other>]
    def "mtl" {}
    asset file = @./x.vdb@
    asset far = @http://x/y@
    asset none = @@
}"#,
        ),
        _ => Err(Unfollowed::Gone),
    };
    let root = parse(b"#usda 1.0\ndef 'fox' { def 'fur' ( references = @./b.usda@</fox> ) {} }");
    let mut files = Files::new(&open);
    let prims = compose(&root.unwrap(), Path::new("a/a.usda"), &mut files, &[]);
    let fur = prims[0].child("fur").unwrap();
    let skin = fur.child("skin").unwrap();
    assert_eq!(
        skin.property("to").unwrap().targets,
        ["/fox/fur/skin/mtl", "/other"]
    );
    assert_eq!(fur.property("here").unwrap().targets, ["/fox/fur/skin/mtl"]);
    let asset = |name: &str| skin.value(name).cloned();
    assert_eq!(asset("file"), Some(Value::Asset("a/c/x.vdb".into())));
    assert_eq!(asset("far"), Some(Value::Asset("http://x/y".into())));
    assert_eq!(asset("none"), Some(Value::Asset(String::new())));
    assert_eq!(files.unfollowed, []);
}

/// A layer of ten of itself would be 10^16 layers.
#[test]
fn layers_of_themselves_end() {
    let itself = ["@./a.usda@"; 10].join(", ");
    let text = format!("#usda 1.0\n( subLayers = [{itself}] )\ndef \"a\" {{}}\n");
    let layer = parse(text.as_bytes()).unwrap();
    let open = |_: &Path| Ok(layer.clone());
    let mut files = Files::new(&open);
    let prims = compose(&layer, Path::new("a.usda"), &mut files, &[]);
    assert_eq!(prims.len(), 1);
    assert!(files.is_cut);
}

/// A prim of half a megabyte that a thousand others refer to would be half a gigabyte.
#[test]
fn prims_that_are_referred_to_are_counted_each_time() {
    let attributes: String = (0..50)
        .map(|i| format!("string a{i} = \"{}\"\n", "x".repeat(20_000)))
        .collect();
    let many = |count: usize| {
        let refer = |i| format!("def \"b{i}\" ( references = </a> ) {{}}\n");
        let others: String = (0..count).map(refer).collect();
        let text = format!("#usda 1.0\ndef \"a\" {{ {attributes} }}\n{others}");
        let layer = parse(text.as_bytes()).unwrap();
        let open = |_: &Path| Err(Unfollowed::Gone);
        let mut files = Files::new(&open);
        compose(&layer, Path::new("a.usda"), &mut files, &[]);
        files.is_cut
    };
    assert!(!many(20));
    assert!(many(800));
}

/// No panic and no great allocation, whatever is changed; every prefix of a crate file is refused.
#[test]
fn broken_files_are_refused() {
    for form in [Form::Binary, Form::Text] {
        let whole = written(form);
        for length in 0..whole.len() {
            let read = parse(&whole[..length]);
            assert!(
                form == Form::Text || read.is_err(),
                "{length} bytes of {}",
                whole.len()
            );
        }
        let mut state = 1u32;
        for _ in 0..4000 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let at = (state >> 8) as usize % bytes.len();
                bytes[at] ^= 1 << (state & 7);
            }
            if let Ok(layer) = parse(&bytes) {
                let mut files = Files::new(&|_| Err(Unfollowed::Gone));
                compose(&layer, Path::new("x"), &mut files, &[]);
            }
        }
    }
    let deep = format!("#usda 1.0\n{}", "def \"a\" {".repeat(1_000_000));
    assert!(parse(deep.as_bytes()).is_err());
    let deep = format!("#usda 1.0\n(x = {}", "[".repeat(1_000_000));
    assert!(parse(deep.as_bytes()).is_err());
}
