//! Lines in space from files: `l` of Wavefront OBJ, curves of USD.
//!
//! Curves of any basis are read as lines through their control points.

mod obj;
mod usd;

use crate::io::{FileError, read_bounded};
use std::path::Path;

/// Longest file, bytes.
const MAX_FILE: u64 = 64 << 20;
/// Most points of all lines of a file.
const MAX_POINTS: usize = 4096;

/// What a file of lines holds.
#[derive(Debug)]
pub(crate) struct Lines {
    /// Two or more points each, finite; at least one line.
    pub(crate) lines: Vec<Vec<[f32; 3]>>,
    /// Whether the points are in meters, Y up: the file says its unit and axis. OBJ files do not.
    pub(crate) is_placed: bool,
}

/// Why a file of lines is not used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PolylineError {
    /// Not the name of a file of lines.
    #[error("{file}: unknown kind of lines, the name must end in .obj, .usd, .usda or .usdc")]
    UnknownKind { file: String },
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// It does not say what it should say.
    #[error("{file}, {place}: {reason}")]
    Invalid {
        file: String,
        /// Line, byte or prim.
        place: String,
        reason: String,
    },
    /// No line in it.
    #[error("{file}: no line of two or more points; {remedy}")]
    Empty { file: String, remedy: &'static str },
    /// More points than are taken.
    #[error("{file}: {count} points in lines, at most {limit} are possible")]
    TooLarge {
        file: String,
        count: usize,
        limit: usize,
    },
}

/// Reads a file of lines.
///
/// # Errors
/// [`PolylineError`] names the file, the place and what is wrong.
pub(crate) fn read(path: &Path) -> Result<Lines, PolylineError> {
    let file = path.to_string_lossy().into_owned();
    let ending = path.extension().and_then(|e| e.to_str());
    let ending = ending.unwrap_or_default().to_ascii_lowercase();
    let is_placed = match ending.as_str() {
        "obj" => false,
        "usd" | "usda" | "usdc" => true,
        _ => return Err(PolylineError::UnknownKind { file }),
    };
    let bytes = read_bounded(path, MAX_FILE)?;
    let (read, remedy) = match is_placed {
        false => (obj::lines(&bytes), "in OBJ lines begin with `l`"),
        true => (
            usd::lines(&bytes),
            "in USD lines are BasisCurves, NurbsCurves or HermiteCurves",
        ),
    };
    let mut lines = read.map_err(|(place, reason)| PolylineError::Invalid {
        file: file.clone(),
        place,
        reason,
    })?;
    lines.retain(|line| line.len() >= 2);
    if lines.is_empty() {
        return Err(PolylineError::Empty { file, remedy });
    }
    let count = lines.iter().map(Vec::len).sum();
    if count > MAX_POINTS {
        let limit = MAX_POINTS;
        return Err(PolylineError::TooLarge { file, count, limit });
    }
    Ok(Lines { lines, is_placed })
}

/// Where something is wrong, and what.
type Fault = (String, String);

#[cfg(test)]
mod tests {
    use super::*;

    fn written(name: &str, text: &str) -> Result<Lines, PolylineError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn lines_of_an_obj_file_count_from_its_ends() {
        let text = "# c\nv 0 0 0\nv 1 0 0 # x\nv 1 2 0\nl 1 2/1 3\nf 1 2 3\nl -1 -3\n";
        let lines = written("a.obj", text).unwrap();
        let [a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]];
        assert_eq!(lines.lines, [vec![a, b, c], vec![c, a]]);
        assert!(!lines.is_placed);
    }

    #[test]
    fn curves_of_a_usd_file_are_moved_into_meters_with_y_up() {
        let text = r#"#usda 1.0
(
    metersPerUnit = 0.01
    upAxis = "Z"
)
def Xform "a"
{
    double3 xformOp:translate = (10, 0, 0)
    float3 xformOp:rotateXYZ = (0, 0, 90)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]

    def BasisCurves "b"
    {
        int[] curveVertexCounts = [2, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 0, 5), (0, 0, 6), (0, 0, 7)]
        float xformOp:scale = 1
        float3 xformOp:scale:by = (2, 1, 1)
        uniform token[] xformOpOrder = ["xformOp:scale:by"]
    }
}
"#;
        let lines = written("a.usda", text).unwrap();
        assert_eq!(lines.lines.len(), 2);
        // 2 along X of the curve is along Y of the file, which is -Z here.
        let expected = [[0.1, 0.0, 0.0], [0.1, 0.0, -0.02]];
        for (point, expected) in lines.lines[0].iter().zip(expected) {
            let off = (0..3).map(|i| (point[i] - expected[i]).abs());
            assert!(off.fold(0.0, f32::max) < 1e-6, "{point:?}");
        }
        assert!((lines.lines[1][2][1] - 0.07).abs() < 1e-6);
        assert!(lines.is_placed);
    }

    #[test]
    fn broken_files_are_refused_with_the_place() {
        let message = |name: &str, text: &str| written(name, text).unwrap_err().to_string();
        assert!(message("a.obj", "v 0 0 0\nl 1 2\n").contains("line 2: vertex 2 of 1"));
        assert!(message("a.obj", "v 0 0 0\nl 0 1\n").contains("line 2: vertex 0 of 1"));
        assert!(message("a.obj", "v 0 nan 0\n").contains("line 1"));
        assert!(message("a.obj", "v 0 0\n").contains("line 1"));
        assert!(message("a.obj", "v 0 0 0\nl 1\n").contains("no line of two or more points"));
        assert!(message("a.txt", "").contains("must end in .obj"));
        let many = format!("v 0 0 0\nl{}\n", " 1".repeat(MAX_POINTS + 1));
        assert!(message("a.obj", &many).contains("at most 4096"));
        assert!(message("a.usda", "#usda 1.0\ndef Mesh \"m\" {\n}\n").contains("BasisCurves"));
        let short = "#usda 1.0\ndef BasisCurves \"c\" {\n int[] curveVertexCounts = [3]\n point3f[] points = [(0,0,0)]\n}\n";
        assert!(message("a.usda", short).contains("/c: 1 points, but curves of 3"));
        let skewed = "#usda 1.0\ndef Xform \"x\" {\n quatf xformOp:orient = (1,0,0,0)\n uniform token[] xformOpOrder = [\"xformOp:orient\"]\n def BasisCurves \"c\" {\n int[] curveVertexCounts = [2]\n point3f[] points = [(0,0,0),(1,0,0)]\n}\n}\n";
        assert!(written("a.usda", skewed).is_ok());
    }
}
