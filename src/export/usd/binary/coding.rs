//! How a crate file packs bytes and integers.

use rayon::prelude::*;

/// Longest input that one block of LZ4 may have.
const LONGEST_BLOCK: usize = 0x7e00_0000;

/// LZ4 with Pixar's head: a zero and one block, or the number of blocks and each with its length.
pub(super) fn compress(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    if bytes.len() <= LONGEST_BLOCK {
        out.push(0);
        out.extend(lz4_flex::block::compress(bytes));
        return out;
    }
    out.push(bytes.len().div_ceil(LONGEST_BLOCK) as u8);
    for block in bytes.chunks(LONGEST_BLOCK) {
        let packed = lz4_flex::block::compress(block);
        out.extend((packed.len() as i32).to_le_bytes());
        out.extend(packed);
    }
    out
}

/// Packs integers: differences, of which the most frequent takes two bits and the others two bits and
/// one, two or four bytes.
pub(super) fn compress_ints(values: &[i32]) -> Vec<u8> {
    let common = most_frequent_step(values);
    let mut out = common.to_le_bytes().to_vec();
    let codes_at = out.len();
    out.resize(codes_at + values.len().div_ceil(4), 0);
    let mut last = 0i32;
    for (index, &value) in values.iter().enumerate() {
        let step = value.wrapping_sub(last);
        last = value;
        let code = if step == common {
            0
        } else if let Ok(byte) = i8::try_from(step) {
            out.extend(byte.to_le_bytes());
            1
        } else if let Ok(short) = i16::try_from(step) {
            out.extend(short.to_le_bytes());
            2
        } else {
            out.extend(step.to_le_bytes());
            3
        };
        out[codes_at + index / 4] |= code << (2 * (index % 4));
    }
    compress(&out)
}

/// The difference of neighbors that occurs most often; of several the largest.
fn most_frequent_step(values: &[i32]) -> i32 {
    let before = std::iter::once(&0).chain(values);
    let steps = values.iter().zip(before).map(|(v, b)| v.wrapping_sub(*b));
    // What makes up more than half is found by pairing it off (Boyer and Moore 1991, "MJRTY").
    let (mut likely, mut lead) = (0, 0usize);
    for step in steps.clone() {
        if lead == 0 {
            likely = step;
        }
        lead = if step == likely { lead + 1 } else { lead - 1 };
    }
    if 2 * steps.clone().filter(|step| *step == likely).count() > values.len() {
        return likely;
    }
    let mut steps: Vec<i32> = steps.collect();
    steps.par_sort_unstable();
    let runs = steps.chunk_by(|a, b| a == b);
    runs.max_by_key(|run| run.len()).map_or(0, |run| run[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What Pixar's reader does.
    fn unpack(bytes: &[u8], count: usize) -> Vec<i32> {
        assert_eq!(bytes[0], 0);
        let room = 4 + count.div_ceil(4) + 4 * count;
        let plain = lz4_flex::block::decompress(&bytes[1..], room).unwrap();
        let common = i32::from_le_bytes(plain[..4].try_into().unwrap());
        let mut at = 4 + count.div_ceil(4);
        let mut value = 0i32;
        (0..count)
            .map(|i| {
                let code = plain[4 + i / 4] >> (2 * (i % 4)) & 3;
                let step = match code {
                    0 => common,
                    1 => i32::from(plain[at] as i8),
                    2 => i32::from(i16::from_le_bytes([plain[at], plain[at + 1]])),
                    _ => i32::from_le_bytes(plain[at..at + 4].try_into().unwrap()),
                };
                at += [0, 1, 2, 4][code as usize];
                value = value.wrapping_add(step);
                value
            })
            .collect()
    }

    #[test]
    fn integers_come_back() {
        let cases: [Vec<i32>; 6] = [
            vec![],
            vec![7],
            vec![8; 1000],
            (0..777).collect(),
            vec![
                0,
                127,
                128,
                -128,
                -129,
                32_767,
                32_768,
                i32::MIN,
                i32::MAX,
                -1,
            ],
            (0..1000i32)
                .map(|i| i.wrapping_mul(2_654_435) ^ (i << 17))
                .collect(),
        ];
        for case in cases {
            assert_eq!(unpack(&compress_ints(&case), case.len()), case);
        }
        // A constant array costs its codes only, and LZ4 folds those.
        assert!(compress_ints(&vec![8; 100_000]).len() < 200);
    }
}
