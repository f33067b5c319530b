//! Mattes by name as layers of an EXR, after the Cryptomatte specification 1.2 (Friedman, Jones 2015;
//! Psyop, <https://github.com/Psyop/Cryptomatte>).
//!
//! An id is the hash of a name, kept as the bits of a 32-bit float. A layer holds two pairs of id and coverage
//! a pixel, `R` `G` and `B` `A`, the greatest coverage first; the header tells names and ids.

use crate::render::{Film, Mattes};
use exr::prelude::{AnyChannel, FlatSamples, Text};

/// Layers that are always there: three, as compositing programs expect.
const LEAST_LAYERS: usize = 3;

/// One set of names as channels and attributes.
pub(super) struct Cryptomatte {
    name: &'static str,
    /// Ids of the names, each with the counts that it stands for.
    ids: Vec<(String, u32, usize)>,
}

impl Cryptomatte {
    /// The two sets of a film's mattes: hair classes and zones of the coat.
    pub(super) fn of(mattes: &Mattes) -> [Self; 2] {
        let set = |name, names: Vec<(&str, usize)>| Self {
            name,
            ids: (names.into_iter())
                .map(|(name, column)| (name.to_owned(), id(name), column))
                .collect(),
        };
        [
            set("CryptoClass", mattes.classes()),
            set("CryptoZone", mattes.zones()),
        ]
    }

    /// Names and texts of the header.
    pub(super) fn attributes(&self) -> [(Text, String); 4] {
        let key = format!("{:08x}", murmur3(self.name.as_bytes()));
        let manifest: serde_json::Map<String, serde_json::Value> = (self.ids.iter())
            .map(|(name, id, _)| (name.clone(), format!("{id:08x}").into()))
            .collect();
        [
            ("name", self.name.to_owned()),
            ("hash", "MurmurHash3_32".to_owned()),
            ("conversion", "uint32_to_float32".to_owned()),
            ("manifest", serde_json::Value::Object(manifest).to_string()),
        ]
        .map(|(what, value)| {
            let name = format!("cryptomatte/{}/{what}", &key[..7]);
            (Text::new_or_panic(&name), value)
        })
    }

    /// The layers: as many as there are pairs of names, so that nothing is left out, but at least
    /// [`LEAST_LAYERS`].
    pub(super) fn channels(&self, film: &Film, mattes: &Mattes) -> Vec<AnyChannel<FlatSamples>> {
        let ranks = 2 * self.ids.len().div_ceil(2).max(LEAST_LAYERS);
        // Id and coverage of each rank.
        let mut planes = vec![Vec::with_capacity(film.pixels.len()); 2 * ranks];
        for (index, pixel) in film.pixels.iter().enumerate() {
            let ranked = self.ranked(mattes.of_pixel(index));
            let none = std::iter::repeat((0, 0));
            let pairs = ranked.into_iter().chain(none);
            for (planes, (id, count)) in planes.chunks_exact_mut(2).zip(pairs) {
                planes[0].push(f32::from_bits(id));
                planes[1].push((f64::from(count) / f64::from(pixel.samples.max(1))) as f32);
            }
        }
        let name = |plane: usize| {
            format!(
                "{}{:02}.{}",
                self.name,
                plane / 4,
                ["R", "G", "B", "A"][plane % 4]
            )
        };
        (planes.into_iter().enumerate())
            .map(|(i, plane)| AnyChannel::new(name(i).as_str(), FlatSamples::F32(plane)))
            .collect()
    }

    /// Ids that a pixel shows and their samples, most first. Names with one id are one.
    fn ranked(&self, counts: &[u32]) -> Vec<(u32, u32)> {
        let mut ranked: Vec<(u32, u32)> = Vec::with_capacity(self.ids.len());
        for (_, id, column) in &self.ids {
            match ranked.iter_mut().find(|(other, _)| other == id) {
                _ if counts[*column] == 0 => {}
                Some((_, count)) => *count += counts[*column],
                None => ranked.push((*id, counts[*column])),
            }
        }
        ranked.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        ranked
    }
}

/// The id of a name: its hash, made a number that no program changes when it handles it as a float. Those
/// with an exponent of all zeros or all ones (denormal, infinite, not a number) have its lowest bit turned.
fn id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    match hash >> 23 & 255 {
        0 | 255 => hash ^ 1 << 23,
        _ => hash,
    }
}

/// MurmurHash3_x86_32 (Appleby 2011) with seed 0.
fn murmur3(bytes: &[u8]) -> u32 {
    let scrambled = |word: u32| {
        word.wrapping_mul(0xcc9e_2d51)
            .rotate_left(15)
            .wrapping_mul(0x1b87_3593)
    };
    let (words, tail) = bytes.as_chunks::<4>();
    let mut hash = 0u32;
    for word in words {
        hash ^= scrambled(u32::from_le_bytes(*word));
        hash = hash
            .rotate_left(13)
            .wrapping_mul(5)
            .wrapping_add(0xe654_6b64);
    }
    let mut last = [0; 4];
    last[..tail.len()].copy_from_slice(tail);
    hash ^= scrambled(u32::from_le_bytes(last));
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that other implementations of the hash publish.
    #[test]
    fn the_hash_is_that_of_others() {
        for (text, hash) in [
            ("", 0),
            ("test", 0xba6b_d213),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text:?}");
        }
    }

    #[test]
    fn every_id_is_a_normal_number() {
        let mut mended = 0;
        for i in 0..20_000 {
            let name = format!("name {i}");
            assert!(f32::from_bits(id(&name)).is_normal(), "{name}");
            mended += u32::from(id(&name) != murmur3(name.as_bytes()));
        }
        // One in 128 needs it.
        assert!((100..220).contains(&mended), "{mended}");
    }

    #[test]
    fn names_are_ranked_by_coverage_and_those_with_one_id_are_one() {
        let ids = [("skin", 0), ("guard", 1), ("under", 2), ("skin", 3)];
        let set = Cryptomatte {
            name: "CryptoClass",
            ids: ids.map(|(name, at)| (name.to_owned(), id(name), at)).into(),
        };
        let ranked = set.ranked(&[2, 0, 4, 3]);
        assert_eq!(ranked, [(id("skin"), 5), (id("under"), 4)]);
    }
}
