//! The prims of a skin's file, with what it refers to in files beside it.

use super::super::MAX_FILE;
use crate::io::read_bounded;
use crate::usd_file::{
    Files, Layer, Prim, Unfollowed, UsdFileError, compose, is_resolved_elsewhere, members, parse,
};
use std::path::{Component, Path};

/// What makes one file of several.
pub(super) const REMEDY: &str = "one file of all is written by `usdcat --flatten -o flat.usdc`";

/// Stands between the path of a layer and arguments for its reader.
const ARGUMENTS: &str = ":SDF_FORMAT_ARGS:";

/// Prims put together.
pub(super) struct Stage {
    /// The file itself: it says units and axes.
    pub(super) layer: Layer,
    pub(super) roots: Vec<Prim>,
    /// What was not followed, a sentence each.
    pub(super) remarks: Vec<String>,
}

/// Sublayers, chosen variants, references and payloads are followed into the file's folder and those in it, and
/// within a package.
pub(super) fn open(file: &str, bytes: &[u8]) -> Result<Stage, UsdFileError> {
    let layer = parse(bytes)?;
    let path = Path::new(file);
    let folder = path.parent().unwrap_or(Path::new(""));
    let is_package = bytes.starts_with(b"PK");
    let open = |named: &Path| {
        let name = named.to_string_lossy();
        let named = Path::new(name.split(ARGUMENTS).next().unwrap_or_default());
        if is_resolved_elsewhere(&name) {
            return Err(Unfollowed::Foreign);
        }
        let broken = |error: &dyn ToString| Unfollowed::Broken(error.to_string());
        let within = (named.strip_prefix(folder).ok())
            .filter(|way| way.components().all(|c| matches!(c, Component::Normal(_))))
            .ok_or_else(|| broken(&"it lies outside of the folder of the skin"))?;
        if is_package {
            let all = members(bytes).map_err(|error| broken(&error))?;
            let member = all.iter().find(|m| Path::new(&m.name) == within);
            let member = member.filter(|m| !m.is_packed).ok_or(Unfollowed::Gone)?;
            return parse(&bytes[member.data.clone()]).map_err(|error| broken(&error));
        }
        if !std::fs::metadata(named).is_ok_and(|m| m.is_file()) {
            return Err(Unfollowed::Gone);
        }
        let bytes = read_bounded(named, MAX_FILE).map_err(|error| broken(&error))?;
        parse(&bytes).map_err(|error| broken(&error))
    };
    let mut files = Files::new(&open);
    let roots = compose(&layer, path, &mut files, &[]);
    let mut remarks: Vec<String> = (files.unfollowed.iter())
        .map(|(named, why)| {
            let why = match why {
                Unfollowed::Gone => "it is not there",
                Unfollowed::Broken(what) => what,
                Unfollowed::Foreign => "it is no path of a file, or comes from elsewhere",
                Unfollowed::NoPrim => "the file has no such prim",
                Unfollowed::NoDefault => "the file names no default prim",
            };
            format!("{named} is referred to but not read: {why}; {REMEDY}")
        })
        .collect();
    if files.is_cut {
        let what = "more prims, or more files in a row, than are read: some are left out";
        remarks.push(format!("there are {what}"));
    }
    Ok(Stage {
        layer,
        roots,
        remarks,
    })
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use crate::mesh_file::{MeshFileError, RawMesh};
    use std::path::Path;

    const SQUARE: &str = r#"#usda 1.0
(
    defaultPrim = "square"
)
def Mesh "square"
{
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
}
"#;

    fn of(folder: &Path, text: &str) -> Result<RawMesh, MeshFileError> {
        let file = folder.join("skin.usda");
        read(&file.to_string_lossy(), text.as_bytes())
    }

    #[test]
    fn what_lies_beside_the_file_is_read() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("parts")).unwrap();
        std::fs::write(folder.path().join("parts/square.usda"), SQUARE).unwrap();
        let whole = SQUARE.replace("(1, 1, 0)", "(1, 2, 0)");
        std::fs::write(folder.path().join("sub.usda"), whole).unwrap();
        for (text, name, top) in [
            (
                "#usda 1.0\ndef \"a\" (\n references = @./parts/square.usda@\n)\n{\n}\n",
                "/a",
                0.01,
            ),
            (
                "#usda 1.0\ndef \"a\" {\n def \"b\" (\n payload = @parts/square.usda@</square>\n)\n{\n}\n}\n",
                "/a/b",
                0.01,
            ),
            (
                "#usda 1.0\n(\n subLayers = [@sub.usda@]\n)\n",
                "/square",
                0.02,
            ),
            (
                "#usda 1.0\ndef \"a\" (\n variants = { string size = \"large\" }\n prepend variantSets = \"size\"\n)\n{\n\
                 variantSet \"size\" = {\n \"small\" (\n references = @parts/square.usda@\n) {\n}\n\
                 \"large\" (\n references = @sub.usda@\n) {\n}\n}\n}\n",
                "/a",
                0.02,
            ),
        ] {
            let mesh = of(folder.path(), text).unwrap();
            assert_eq!((mesh.faces, &mesh.names[..]), (1, &[name.to_owned()][..]));
            let highest = mesh.positions.iter().fold(0.0f32, |y, p| y.max(p.y));
            assert!((highest - top).abs() < 1e-6, "{text}: {highest}");
            assert!(mesh.remarks.is_empty(), "{:?}", mesh.remarks);
        }
    }

    #[test]
    fn what_is_not_read_is_named_with_its_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let within = folder.path().join("within");
        std::fs::create_dir(&within).unwrap();
        std::fs::write(folder.path().join("square.usda"), SQUARE).unwrap();
        std::fs::write(within.join("broken.usda"), "no layer").unwrap();
        for (named, why) in [
            (
                "gone.usda",
                "gone.usda is referred to but not read: it is not there",
            ),
            (
                "../square.usda",
                "it lies outside of the folder of the skin",
            ),
            ("/etc/passwd", "it lies outside of the folder of the skin"),
            ("broken.usda", "it is no USD file"),
            ("ar://square", "it is no path of a file"),
        ] {
            let text = format!("#usda 1.0\ndef \"a\" (\n references = @{named}@\n)\n{{\n}}\n");
            let error = of(&within, &text).unwrap_err().to_string();
            assert!(
                error.contains("there is no Mesh with faces in it"),
                "{error}"
            );
            assert!(
                error.contains(why) && error.contains("usdcat --flatten"),
                "{error}"
            );
            // Beside a mesh it is a remark.
            let mesh = of(&within, &format!("{SQUARE}{}", &text[9..])).unwrap();
            assert_eq!((mesh.faces, mesh.remarks.len()), (1, 1));
            assert!(mesh.remarks[0].contains(why), "{:?}", mesh.remarks);
        }
        let text = "#usda 1.0\nclass Mesh \"c\" {\n}\ndef \"a\" (\n inherits = </c>\n)\n{\n}\n";
        let error = of(&within, text).unwrap_err().to_string();
        assert!(
            error.contains("what /a inherits or specializes is not read: one file"),
            "{error}"
        );
    }

    #[test]
    fn members_of_a_package_are_read_where_they_are_referred_to() {
        let root = "#usda 1.0\ndef \"a\" (\n references = @./square.usda@\n)\n{\n}\n";
        let mut package = Vec::new();
        for (name, text) in [("root.usda", root), ("square.usda", SQUARE)] {
            let size = (text.len() as u32).to_le_bytes();
            package.extend(b"PK\x03\x04\x0a\0\0\0\0\0\0\0\0\0\0\0\0\0");
            package.extend([size, size].concat());
            package.extend((name.len() as u16).to_le_bytes());
            package.extend([0, 0]);
            package.extend(name.as_bytes());
            package.extend(text.as_bytes());
        }
        let mesh = read("some/skin.usdz", &package).unwrap();
        assert_eq!((mesh.faces, &mesh.names[..]), (1, &["/a".to_owned()][..]));
    }
}
