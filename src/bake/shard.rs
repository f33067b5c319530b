//! A part of a bake that one machine does.

use std::fmt;
use std::ops::Range;

/// Part `index` of `of` parts, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// 1 to `of`.
    index: u64,
    of: u64,
}

impl Shard {
    /// Most parts that a bake is cut into.
    const MOST: u64 = 1_000_000;

    /// Part `index`, 1 to `of`, of 1 to 1 000 000 parts; `None` for other numbers.
    pub fn new(index: u64, of: u64) -> Option<Self> {
        let is_one = (1..=of).contains(&index) && of <= Self::MOST;
        is_one.then_some(Self { index, of })
    }

    /// How many parts there are.
    pub(super) fn of(self) -> u64 {
        self.of
    }

    /// The shard's photons of so many: the shards of a bake cover it without gap or overlap.
    pub fn span(&self, photons: u64) -> Range<u64> {
        let cut =
            |index: u64| (u128::from(photons) * u128::from(index) / u128::from(self.of)) as u64;
        cut(self.index - 1)..cut(self.index)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// `2/3` is the second of three.
impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text
            .split_once('/')
            .and_then(|(index, of)| Self::new(index.trim().parse().ok()?, of.trim().parse().ok()?));
        parts.ok_or_else(|| format!("`{text}` is not a shard such as 2/3, the second of three"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_without_gap() {
        for photons in [10, 1_000_003, u64::MAX / 2] {
            for of in [1, 2, 3, 7] {
                let mut next = 0;
                for index in 1..=of {
                    let span = Shard { index, of }.span(photons);
                    assert_eq!(span.start, next);
                    next = span.end;
                }
                assert_eq!(next, photons);
            }
        }
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, of: 3 }));
        for wrong in ["0/3", "4/3", "1", "a/b", "1/0", "1/1000001"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
