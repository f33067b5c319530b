//! The rules: what each wants, why, and who suffers where it is broken.

/// A rule, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "RULES says what each is")]
pub enum Rule {
    C01,
    C02,
    C03,
    C04,
    C05,
    C06,
    C07,
    C08,
    C09,
    C10,
    C11,
    C12,
    C13,
    C14,
    C15,
    C16,
    C17,
    C18,
    C19,
    C20,
}

/// What a rule says.
#[derive(Clone, Copy, Debug)]
pub struct Described {
    /// Which.
    pub rule: Rule,
    /// `C07`.
    pub id: &'static str,
    /// In a few words.
    pub title: &'static str,
    /// Why, what happens otherwise, and what to do.
    pub explanation: &'static str,
    /// Where that is known from.
    pub evidence: &'static str,
}

const fn described(
    rule: Rule,
    id: &'static str,
    title: &'static str,
    explanation: &'static str,
    evidence: &'static str,
) -> Described {
    Described {
        rule,
        id,
        title,
        explanation,
        evidence,
    }
}

/// All rules in order.
pub const RULES: [Described; 20] = [
    described(
        Rule::C01,
        "C01",
        "widths: one per control point, interpolation vertex, above zero",
        "`widths` are full diameters. One value a control point with the interpolation `vertex` is what \
         every reader takes, and one `constant` value. Blender copies `uniform` widths flat into the first \
         points and leaves the rest to chance; `varying` is refused by Unreal, ignored by Cycles and \
         miscounted by Storm on pinned curves. Where there are none Arnold draws strands of 0.5 units, \
         Unreal of 1 cm. Write as many `vertex` widths as there are points.",
        "Blender 4.5 to 5.2 measured; OpenUSD issue 2775; sources of Cycles' Hydra delegate, arnold-usd and Unreal's importer",
    ),
    described(
        Rule::C02,
        "C02",
        "widths: a diameter of hair in the units of the file",
        "Hair is 1 micrometer to 5 millimeters thick. Widths beyond that are mostly in another unit than \
         `metersPerUnit` says, or radii. Multiply the widths, or mend `metersPerUnit`.",
        "Unreal and Arnold scale by metersPerUnit; maya-usd issue 3018, vray-for-houdini issue 138",
    ),
    described(
        Rule::C03,
        "C03",
        "no number that is infinite or none",
        "One bad point has Arnold drop the whole prim, and boxes around it become infinite everywhere. Find \
         where it comes from; leave the strand out.",
        "arnold-usd issue 645",
    ),
    described(
        Rule::C04,
        "C04",
        "curves: counts that fit their type, and strands with a length",
        "The sum of `curveVertexCounts` is the number of points. A pinned or linear curve has two points at \
         least, other cubic ones four, Bezier curves four and then three more each. Where that does not \
         hold prims are skipped without a word. A strand whose points are all the same has no direction.",
        "UsdGeomBasisCurves' documentation",
    ),
    described(
        Rule::C05,
        "C05",
        "no more strands and points than Unreal holds",
        "Unreal cuts strands after 255 points, and groups after 4,194,303 strands or 16,777,215 points. \
         Write fewer points a strand, or more groups (`groom_group_id`).",
        "Unreal's groom importer and documentation",
    ),
    described(
        Rule::C06,
        "C06",
        "texture coordinates have the type texCoord2f[]",
        "Cycles finds texture coordinates by their role and does not see `float2[]`; coordinates of three \
         numbers arrive in Blender as zeros. Write `texCoord2f[]`, one a strand (`uniform`).",
        "sources of Cycles' Hydra delegate; Blender 5.0 measured",
    ),
    described(
        Rule::C07,
        "C07",
        "groom_color has the type float3[]",
        "Unreal takes `groom_color` as float3[] only; of color3f[] it makes nothing and shades black. \
         `displayColor` stays color3f[].",
        "source of Unreal's groom translator",
    ),
    described(
        Rule::C08,
        "C08",
        "GroomAPI stands above the curves for Unreal",
        "Unreal makes a groom of curves only where they or a prim above them have the applied schema \
         GroomAPI; otherwise they are not imported. `prepend apiSchemas = [\"GroomAPI\"]` on the root.",
        "source of Unreal's USD importer",
    ),
    described(
        Rule::C09,
        "C09",
        "type, basis and wrap that readers draw alike",
        "Cubic, catmullRom, pinned is drawn through all its points by Blender, Cycles and Storm. RenderMan \
         up to 25 takes pinned for nonperiodic and loses both end pieces: for it write a point beyond each \
         end (`vair export --curves phantom`), which Blender, Cycles and Unreal draw as hair. Points of B-splines are off the curve, so readers that \
         ignore the basis (Unreal, Cycles) draw another shape; the handles of Bezier curves become points \
         of the strand there.",
        "Blender 4.5 to 5.2 and Storm measured; source of RenderMan's Hydra delegate; OpenUSD issue 2445",
    ),
    described(
        Rule::C10,
        "C10",
        "primvars are arrays of types that arrive, as long as their interpolation says",
        "Blender imports arrays of bool, uchar, int, float, float2, float3, vector, normal, point, color, quatf \
         and texCoord2f. It drops scalars in silence and other types with a warning, and refuses faceVarying. \
         `uniform` is one value a strand, `vertex` one a point. No primvar may be called `id`: Arnold takes it \
         for a parameter of its own; `curve_id` is free.",
        "Blender 4.2 to 5.2 measured; arnold-usd issue 802",
    ),
    described(
        Rule::C11,
        "C11",
        "extent: the box around the points and half the widest width",
        "`extent` is what is culled by. Too small a box makes fur vanish at the edge of a view, none has the reader \
         compute one, and validators refuse either. Write it for every time at which there are points.",
        "NVIDIA's validator 1.22 and Pixar's UsdValidation measured",
    ),
    described(
        Rule::C12,
        "C12",
        "materials: bound with MaterialBindingAPI, there, and without helper nodes of hair",
        "A `material:binding` counts only where MaterialBindingAPI is applied, and the material must be in the \
         stage. MaterialX's helper nodes for hair (chiang_hair_roughness and the two absorptions) are \
         stubs in its OSL backend, 0 and 1 whatever goes in: write numbers on the chiang_hair_bsdf.",
        "UsdValidation and NVIDIA's validator measured; MaterialX 1.39's genosl sources",
    ),
    described(
        Rule::C13,
        "C13",
        "OpenVDB: version 224, whole metadata, one file a volume, no negative fog",
        "Files of version 225 are read by few, those before 221 not by OpenVDB 13. RenderMan wants \
         file_bbox_min and file_bbox_max; hdPrman and Arnold go by `class`. Arnold reads all grids of a \
         volume from one file. A fog volume with negative density makes light where it should take it.",
        "RenderManForBlender issue 380; OpenVDB pull requests 1730, 2087, 2193; arnold-usd's source",
    ),
    described(
        Rule::C14,
        "C14",
        "fields say their type and class",
        "Without `fieldDataType` and `fieldClass` hdPrman guesses by name, and Arnold reports an error. Without \
         `filePath` or `fieldName` there is nothing to show.",
        "sources of hdPrman and arnold-usd",
    ),
    described(
        Rule::C15,
        "C15",
        "packages hold what packages may",
        "A .usdz may hold layers, pictures and sound, neither .vdb nor anything deflated, each beginning at \
         a multiple of 64 bytes. Viewers on telephones know no curves and no volumes: send them a mesh.",
        "USDZ specification; Pixar's compliance checker with ARKit rules measured",
    ),
    described(
        Rule::C16,
        "C16",
        "the layer says what it is: default prim, kind, units, up axis, anchored paths",
        "A reference means the `defaultPrim`; `kind` makes it a component; without `metersPerUnit` and `upAxis` \
         each reader assumes its own (centimeters, Y). Paths of other files begin with ./ so that they are \
         looked for beside the layer and nowhere else.",
        "UsdValidation's StageMetadataChecker, NVIDIA's KindChecker and AnchoredAssetPathsChecker",
    ),
    described(
        Rule::C17,
        "C17",
        "ids are unique, and levels of detail nest",
        "Strands of a coarser level must be among those of the finer one, or hair pops when levels are switched; \
         that is known by ids, which must be unique in a prim.",
        "usdGen, Yeti and Houdini thin by id",
    ),
    described(
        Rule::C18,
        "C18",
        "as many strands as were asked for",
        "Exporters that write only guides, or nothing, are the commonest complaint there is. What a file says of \
         itself (customData vair.strands) or what --expect-strands says is held against what is there.",
        "BlenderTools issues 640, 668, 704, 718; OpenUSD issue 867",
    ),
    described(
        Rule::C19,
        "C19",
        "roots stand on the skin",
        "`skinprim` is a face of the skin's mesh and `skinprimuv` a place on it (weights of the second and third \
         corner); the root of the strand is there. Houdini and Blender move hair with the skin by these.",
        "Houdini's documentation of hair procedurals; usdGen",
    ),
    described(
        Rule::C20,
        "C20",
        "volumes and curves lie in the same place",
        "Grids and strands of one animal are in the same unit and axes. Where their boxes do not meet, or one is \
         many times as large as the other, the transform of the grid has another unit or axis.",
        "BlenderTools issue 136, poly-hammer/BlenderTools issue 186",
    ),
];

impl Rule {
    /// What the rule says.
    pub fn described(self) -> &'static Described {
        &RULES[self as usize]
    }

    /// `C07`.
    pub fn id(self) -> &'static str {
        self.described().id
    }

    /// The rule of an id; `c7` and `C7` are good too.
    pub fn of_id(id: &str) -> Option<Self> {
        let number: usize = id.trim_start_matches(['c', 'C']).parse().ok()?;
        let described = RULES.get(number.checked_sub(1)?)?;
        Some(described.rule)
    }
}
