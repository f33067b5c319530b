//! Values of one node as bytes: inactive ones left out where two values or fewer say all of them,
//! the rest deflated.

use super::value::{Value, put};
use flate2::{Compress, Compression as Level, FlushCompress};

/// How values are stored. Inactive values are left out in either case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// As they are.
    None,
    /// By zlib, node by node.
    #[default]
    Zip,
}

impl Compression {
    /// Flags of the format: 1 zip, 2 active values only.
    pub(super) fn flags(self) -> u32 {
        match self {
            Self::None => 2,
            Self::Zip => 3,
        }
    }

    /// The words of the metadata.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "active values",
            Self::Zip => "zip + active values",
        }
    }
}

/// Which values of a node are stored.
pub(super) struct Masks<'a> {
    /// One bit a value: active.
    pub(super) active: &'a [u64],
    /// One bit a value: a child is here and the value means nothing. Empty for leaves.
    pub(super) child: &'a [u64],
}

impl Masks<'_> {
    fn is_active(&self, i: usize) -> bool {
        bit(self.active, i)
    }

    fn is_inactive(&self, i: usize) -> bool {
        !self.is_active(i) && !(bit(self.child, i))
    }
}

fn bit(mask: &[u64], i: usize) -> bool {
    mask.get(i >> 6)
        .is_some_and(|word| word >> (i & 63) & 1 == 1)
}

/// Packs the values of nodes, with its buffers kept between them.
pub(super) struct Packer<T> {
    background: T,
    half: bool,
    zip: Option<Compress>,
    raw: Vec<u8>,
    zipped: Vec<u8>,
}

/// What a reader needs to know to put inactive values back, as the format numbers it.
enum Inactive<T> {
    /// All are the background.
    Background,
    /// All are the background's negative.
    Negative,
    /// All are this.
    One(T),
    /// The background where the mask has a bit, its negative elsewhere.
    Signs,
    /// The background where the mask has a bit, this elsewhere.
    BackgroundOr(T),
    /// The second where the mask has a bit, the first elsewhere.
    Two(T, T),
    /// More than two: all values are stored.
    All,
}

impl<T: Value> Packer<T> {
    pub(super) fn new(background: T, half: bool, compression: Compression) -> Self {
        let zip = match compression {
            Compression::None => None,
            Compression::Zip => Some(Compress::new(Level::new(LEVEL), true)),
        };
        Self {
            background,
            half,
            zip,
            raw: Vec::new(),
            zipped: Vec::new(),
        }
    }

    /// Appends the values of one node.
    pub(super) fn pack(&mut self, values: &[T], masks: &Masks<'_>, out: &mut Vec<u8>) {
        let inactive = self.inactive(values, masks);
        let (number, given): (u8, &[T]) = match &inactive {
            Inactive::Background => (0, &[]),
            Inactive::Negative => (1, &[]),
            Inactive::One(a) => (2, &[*a]),
            Inactive::Signs => (3, &[]),
            Inactive::BackgroundOr(a) => (4, &[*a]),
            Inactive::Two(a, b) => (5, &[*a, *b]),
            Inactive::All => (6, &[]),
        };
        out.push(number);
        for value in given {
            // These stay floats in grids of halves.
            let value = if self.half { value.to_half() } else { *value };
            put(value, false, out);
        }
        let second = match inactive {
            Inactive::Signs | Inactive::BackgroundOr(_) => Some(self.background),
            Inactive::Two(_, b) => Some(b),
            _ => None,
        };
        if let Some(second) = second {
            for first in (0..values.len()).step_by(64) {
                let chosen = |i: &usize| masks.is_inactive(*i) && values[*i] == second;
                let bits = (first..first + 64)
                    .filter(chosen)
                    .map(|i| 1u64 << (i - first));
                out.extend(bits.sum::<u64>().to_le_bytes());
            }
        }
        self.raw.clear();
        let all = matches!(inactive, Inactive::All);
        for (i, &value) in values.iter().enumerate() {
            if all || masks.is_active(i) {
                put(value, self.half, &mut self.raw);
            }
        }
        self.deflate(out);
    }

    fn inactive(&self, values: &[T], masks: &Masks<'_>) -> Inactive<T> {
        let (mut first, mut second) = (None, None);
        for (i, &value) in values.iter().enumerate() {
            if !masks.is_inactive(i) || first == Some(value) || second == Some(value) {
                continue;
            }
            match (first, second) {
                (None, _) => first = Some(value),
                (_, None) => second = Some(value),
                _ => return Inactive::All,
            }
        }
        let (plus, minus) = (self.background, self.background.negated());
        match (first, second) {
            (None, _) => Inactive::Background,
            (Some(a), None) if a == plus => Inactive::Background,
            (Some(a), None) if a == minus => Inactive::Negative,
            (Some(a), None) => Inactive::One(a),
            (Some(a), Some(b)) if a == plus || b == plus => match if a == plus { b } else { a } {
                other if other == minus => Inactive::Signs,
                other => Inactive::BackgroundOr(other),
            },
            (Some(a), Some(b)) => Inactive::Two(a, b),
        }
    }

    /// Appends the stored values: length and zlib stream, or minus the length and the bytes where
    /// that is shorter. The library writes no length for no halves, but one for no floats.
    fn deflate(&mut self, out: &mut Vec<u8>) {
        let Some(zip) = &mut self.zip else {
            out.extend(&self.raw);
            return;
        };
        if self.half && self.raw.is_empty() {
            return;
        }
        self.zipped.clear();
        self.zipped.reserve(self.raw.len() + 64);
        zip.reset();
        let shorter = zip
            .compress_vec(&self.raw, &mut self.zipped, FlushCompress::Finish)
            .is_ok_and(|status| status == flate2::Status::StreamEnd)
            && self.zipped.len() < self.raw.len();
        if shorter {
            out.extend((self.zipped.len() as i64).to_le_bytes());
            out.extend(&self.zipped);
        } else {
            out.extend((-(self.raw.len() as i64)).to_le_bytes());
            out.extend(&self.raw);
        }
    }
}

/// Leaves are short: higher levels find nothing more in them.
const LEVEL: u32 = 6;
