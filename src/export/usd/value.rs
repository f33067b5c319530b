//! Values of attributes and metadata. Large arrays are made piece by piece while they are written.

use std::ops::Range;
use std::sync::Arc;

/// Appends the elements of some rows to a buffer.
type Fill<'a, T> = dyn Fn(Range<usize>, &mut Vec<T>) + Send + Sync + 'a;

/// An array that is never whole in memory: rows (strands, faces) of elements, made when they are
/// needed. A row may hold any number of elements; making the same rows again gives the same elements.
pub struct Rows<'a, T> {
    rows: usize,
    elements: usize,
    fill: Box<Fill<'a, T>>,
}

impl<'a, T> Rows<'a, T> {
    /// * `elements`: of all rows together.
    /// * `fill`: appends the elements of a range of rows.
    pub fn new(
        rows: usize,
        elements: usize,
        fill: impl Fn(Range<usize>, &mut Vec<T>) + Send + Sync + 'a,
    ) -> Self {
        Self {
            rows,
            elements,
            fill: Box::new(fill),
        }
    }

    /// One element a row.
    pub fn each(rows: usize, at: impl Fn(usize) -> T + Send + Sync + 'a) -> Self {
        Self::new(rows, rows, move |range, out| out.extend(range.map(&at)))
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.elements
    }

    /// Appends the elements of a range of rows.
    pub fn fill(&self, rows: Range<usize>, out: &mut Vec<T>) {
        (self.fill)(rows, out);
    }
}

impl<T: Copy + Send + Sync + 'static> Rows<'_, T> {
    /// A few elements that are there already.
    pub fn of(elements: Vec<T>) -> Rows<'static, T> {
        Rows::each(elements.len(), move |i| elements[i])
    }
}

/// An array. What its elements mean (a point, a color) is said by the type of the attribute.
pub enum Array<'a> {
    /// `int[]`.
    Int(Rows<'a, i32>),
    /// `float[]`.
    Float(Rows<'a, f32>),
    /// `float2[]`, `texCoord2f[]`.
    Vec2(Rows<'a, [f32; 2]>),
    /// `float3[]`, `point3f[]`, `color3f[]` and the like.
    Vec3(Rows<'a, [f32; 3]>),
}

impl Array<'_> {
    /// Number of elements.
    pub fn elements(&self) -> usize {
        match self {
            Self::Int(rows) => rows.elements(),
            Self::Float(rows) => rows.elements(),
            Self::Vec2(rows) => rows.elements(),
            Self::Vec3(rows) => rows.elements(),
        }
    }

    /// Bytes of the elements.
    pub fn bytes(&self) -> u64 {
        let each = match self {
            Self::Int(_) | Self::Float(_) => 4,
            Self::Vec2(_) => 8,
            Self::Vec3(_) => 12,
        };
        each * self.elements() as u64
    }
}

/// A value.
#[derive(Clone)]
pub enum Value<'a> {
    /// `bool`.
    Bool(bool),
    /// `int`.
    Int(i32),
    /// `float`.
    Float(f32),
    /// `double`.
    Double(f64),
    /// `float2` and the like.
    Vec2([f32; 2]),
    /// `float3`, `color3f` and the like.
    Vec3([f32; 3]),
    /// `string`.
    String(String),
    /// `token`.
    Token(String),
    /// `asset`: a path, relative ones begin with `./`.
    Asset(String),
    /// `string[]`.
    Strings(Vec<String>),
    /// Numbers in an array. Where two attributes hold the same [`Arc`], a crate file stores it once.
    Array(Arc<Array<'a>>),
    /// A dictionary; only as metadata. Keys are identifiers, in order.
    Dictionary(Dictionary<'a>),
}

/// Keys and values of a dictionary.
pub type Dictionary<'a> = Vec<(String, Value<'a>)>;

impl Value<'_> {
    /// As files name the type of such a value; attributes have one of their own, which says more.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Bool(_) => "bool",
            Self::Int(_) => "int",
            Self::Float(_) => "float",
            Self::Double(_) => "double",
            Self::Vec2(_) => "float2",
            Self::Vec3(_) => "float3",
            Self::String(_) => "string",
            Self::Token(_) => "token",
            Self::Asset(_) => "asset",
            Self::Strings(_) => "string[]",
            Self::Dictionary(_) => "dictionary",
            Self::Array(array) => match **array {
                Array::Int(_) => "int[]",
                Array::Float(_) => "float[]",
                Array::Vec2(_) => "float2[]",
                Array::Vec3(_) => "float3[]",
            },
        }
    }

    /// A string.
    pub fn string(text: impl Into<String>) -> Self {
        Self::String(text.into())
    }

    /// A token.
    pub fn token(text: impl Into<String>) -> Self {
        Self::Token(text.into())
    }
}

impl<'a> From<Array<'a>> for Value<'a> {
    fn from(array: Array<'a>) -> Self {
        Self::Array(Arc::new(array))
    }
}
