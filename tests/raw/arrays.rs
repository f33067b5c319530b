//! Arrays of a groom as plain numbers, for other programs to compare with: a .raw file.
//!
//! A sequence of arrays: path of the attribute (length as u32, bytes), `f` or `i`, the number of numbers
//! (u32), the numbers (4 bytes each). They are taken from grooms, not from what the writer of an asset
//! was given.

use vair::groom::Groom;

#[derive(Default)]
pub(crate) struct Raw(pub(crate) Vec<u8>);

impl Raw {
    fn head(&mut self, path: &str, kind: u8, count: usize) {
        self.0.extend((path.len() as u32).to_le_bytes());
        self.0.extend(path.as_bytes());
        self.0.push(kind);
        self.0.extend((count as u32).to_le_bytes());
    }

    fn floats(&mut self, path: &str, values: &[f32]) {
        self.head(path, b'f', values.len());
        self.0.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    }

    fn ints(&mut self, path: &str, values: &[i32]) {
        self.head(path, b'i', values.len());
        self.0.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    }

    /// The numbers of one class of a groom, with `turn` from its frame to that of the file.
    pub(crate) fn class(
        &mut self,
        groom: &Groom,
        class: usize,
        prim: &str,
        turn: impl Fn([f32; 3]) -> [f32; 3],
        scale: f32,
    ) {
        let (mut points, mut widths, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        let (mut ids, mut uvs, mut triangles, mut places) = (vec![], vec![], vec![], vec![]);
        for strand in (0..groom.strands()).filter(|&i| usize::from(groom.class[i]) == class) {
            for i in groom.offsets[strand] as usize..groom.offsets[strand + 1] as usize {
                points.extend(turn(groom.points[i].to_array()));
                widths.push(groom.widths[i] * scale);
            }
            counts.push((groom.offsets[strand + 1] - groom.offsets[strand]) as i32);
            ids.push(groom.id[strand] as i32);
            uvs.extend(groom.root_uv[strand].to_array());
            triangles.push(groom.root_triangle[strand] as i32);
            let [u, v] = groom.root_barycentric[strand].to_array();
            places.extend([u, v, 0.0]);
        }
        self.floats(&format!("{prim}.points"), &points);
        self.floats(&format!("{prim}.widths"), &widths);
        self.ints(&format!("{prim}.curveVertexCounts"), &counts);
        for name in ["curve_id", "groom_id"] {
            self.ints(&format!("{prim}.primvars:{name}"), &ids);
        }
        for name in ["st", "groom_root_uv", "surface_uv_coordinate"] {
            self.floats(&format!("{prim}.primvars:{name}"), &uvs);
        }
        self.ints(&format!("{prim}.primvars:skinprim"), &triangles);
        self.floats(&format!("{prim}.primvars:skinprimuv"), &places);
    }
}
