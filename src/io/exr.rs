//! Reproducible OpenEXR headers, in any script.

use exr::prelude::{SmallVec, Text};

/// UTF-8 bytes as they are: OpenEXR does not care, and Python decodes them. The crate's own conversion panics
/// beyond Latin letters.
pub fn exr_text(value: &str) -> Text {
    Text::from_bytes_unchecked(SmallVec::from_slice(value.as_bytes()))
}

/// Sorts the attributes of every header of a finished EXR file by name, in place.
///
/// The `exr` crate keeps custom attributes in a hash map and writes them in a different order every
/// time; sorted, the same content gives the same bytes. Nothing moves but the attributes inside
/// their header, so no offset changes. Bytes that are not an EXR header are left alone.
pub fn sort_exr_attributes(bytes: &mut [u8]) {
    const MULTI_PART: u8 = 0x10;
    if bytes.len() < 8 {
        return;
    }
    let multi_part = bytes[5] & MULTI_PART != 0;
    let mut at = 8;
    while let Some((attributes, end)) = header(bytes, at) {
        let mut order = attributes.clone();
        order.sort_by(|a, b| name(bytes, a.start).cmp(name(bytes, b.start)));
        let sorted: Vec<u8> = order
            .iter()
            .flat_map(|r| &bytes[r.clone()])
            .copied()
            .collect();
        bytes[at..at + sorted.len()].copy_from_slice(&sorted);
        at = end;
        // A multi-part file ends its list of headers with an empty one.
        if !multi_part || bytes.get(at) == Some(&0) {
            return;
        }
    }
}

/// The byte ranges of the attributes of the header at `at`, and where the header ends.
fn header(bytes: &[u8], at: usize) -> Option<(Vec<std::ops::Range<usize>>, usize)> {
    let mut attributes = Vec::new();
    let mut start = at;
    while *bytes.get(start)? != 0 {
        let kind = start + name(bytes, start).len() + 1;
        let size = kind + name(bytes, kind).len() + 1;
        let length = u32::from_le_bytes(bytes.get(size..size + 4)?.try_into().ok()?);
        let end = size + 4 + length as usize;
        bytes.get(start..end)?;
        attributes.push(start..end);
        start = end;
    }
    Some((attributes, start + 1))
}

/// The bytes up to the next zero.
fn name(bytes: &[u8], at: usize) -> &[u8] {
    let rest = bytes.get(at..).unwrap_or_default();
    rest.split(|&b| b == 0).next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attribute(name: &str, value: &[u8]) -> Vec<u8> {
        let mut out = name.as_bytes().to_vec();
        out.extend(b"\0string\0");
        out.extend((value.len() as u32).to_le_bytes());
        out.extend(value);
        out
    }

    #[test]
    fn two_headers_are_sorted_and_the_rest_stays() {
        let (a, b, c) = (
            attribute("a", b"1\0"),
            attribute("bb", b"22"),
            attribute("c", b""),
        );
        let build = |first: [&[u8]; 3], second: [&[u8]; 2]| {
            let head: &[u8] = &[0x76, 0x2f, 0x31, 0x01, 2, 0x10, 0, 0];
            [
                head,
                &first.concat(),
                b"\0",
                &second.concat(),
                b"\0\0pixels",
            ]
            .concat()
        };
        let mut bytes = build([&c, &a, &b], [&b, &a]);
        sort_exr_attributes(&mut bytes);
        assert_eq!(bytes, build([&a, &b, &c], [&a, &b]));
        for cut in 0..bytes.len() {
            sort_exr_attributes(&mut bytes[..cut].to_vec());
        }
    }
}
