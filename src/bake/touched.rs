//! Which texels of a map hold anything.

/// A set of texels as bits.
#[derive(Clone, Debug)]
pub(super) struct Touched {
    words: Vec<u64>,
    texels: usize,
}

impl Touched {
    /// The empty set.
    pub(super) fn new(texels: usize) -> Self {
        Self {
            words: vec![0; texels.div_ceil(64)],
            texels,
        }
    }

    #[inline]
    pub(super) fn insert(&mut self, texel: usize) {
        self.words[texel / 64] |= 1 << (texel % 64);
    }

    #[inline]
    pub(super) fn has(&self, texel: usize) -> bool {
        self.words[texel / 64] >> (texel % 64) & 1 == 1
    }

    /// All texels of the map.
    pub(super) fn insert_all(&mut self) {
        self.words.fill(u64::MAX);
        if let (Some(last), rest @ 1..) = (self.words.last_mut(), self.texels % 64) {
            *last = (1 << rest) - 1;
        }
    }

    pub(super) fn insert_those(&mut self, others: &Self) {
        for (word, other) in self.words.iter_mut().zip(&others.words) {
            *word |= other;
        }
    }

    pub(super) fn clear(&mut self) {
        self.words.fill(0);
    }

    /// The set in ascending order.
    pub(super) fn iter(&self) -> impl Iterator<Item = usize> {
        self.words.iter().enumerate().flat_map(|(i, &word)| {
            let mut left = word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                let next = left.checked_sub(1)?;
                left &= next;
                Some(64 * i + bit)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_what_was_put_in() {
        let (mut set, mut other) = (Touched::new(96), Touched::new(96));
        for texel in [95, 0, 63, 64] {
            set.insert(texel);
        }
        other.insert(7);
        other.insert(64);
        set.insert_those(&other);
        assert_eq!(set.iter().collect::<Vec<_>>(), [0, 7, 63, 64, 95]);
        assert!(set.has(7) && !set.has(6));
        set.insert_all();
        assert_eq!(set.iter().collect::<Vec<_>>(), (0..96).collect::<Vec<_>>());
        set.clear();
        assert_eq!(set.iter().count(), 0);
    }
}
