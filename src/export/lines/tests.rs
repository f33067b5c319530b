//! Hair files there and back, and files that lie.

use super::*;
use crate::sampling::Rng;

fn sample() -> LineSet {
    let mut rng = Rng::new(2, 0);
    let mut set = LineSet {
        offsets: vec![0],
        ..LineSet::default()
    };
    for strand in 0..50 {
        for _ in 0..2 + strand % 9 {
            let mut vec = || Vec3::from_array(std::array::from_fn(|_| rng.uniform_f32()));
            set.points.push(vec());
            set.colors.push(vec());
            set.widths.push(1e-4 * rng.uniform_f32());
        }
        set.offsets.push(set.points.len() as u32);
    }
    set
}

fn bytes(format: LineFormat, set: &LineSet) -> Vec<u8> {
    let mut out = Vec::new();
    assert!(write_to(&mut out, format, &set.lines("test")).is_ok());
    out
}

#[test]
fn hair_files_come_back_as_they_were() {
    let set = sample();
    let file = bytes(LineFormat::Hair, &set);
    assert_eq!(hair::parse(&file).unwrap(), set);
}

#[test]
fn headers_may_stand_for_arrays() {
    let set = LineSet {
        points: (0..6).map(|i| Vec3::splat(i as f32)).collect(),
        widths: vec![0.25; 6],
        offsets: vec![0, 3, 6],
        colors: vec![Vec3::new(0.1, 0.2, 0.3); 6],
    };
    let mut file = b"HAIR".to_vec();
    for word in [2u32, 6, 2, 2] {
        file.extend(word.to_le_bytes());
    }
    for number in [0.25f32, 0.0, 0.1, 0.2, 0.3] {
        file.extend(number.to_le_bytes());
    }
    file.resize(128, 0);
    for p in &set.points {
        file.extend(p.to_array().into_iter().flat_map(f32::to_le_bytes));
    }
    assert_eq!(hair::parse(&file).unwrap(), set);
}

/// Every cut, and every byte of the header replaced, is an error or strands that hold together.
#[test]
fn broken_hair_files_are_refused_in_words() {
    let file = bytes(LineFormat::Hair, &sample());
    for end in (0..file.len()).step_by(7) {
        assert!(hair::parse(&file[..end]).is_err(), "{end}");
    }
    let mut rng = Rng::new(4, 0);
    for i in 0..40 {
        for _ in 0..20 {
            let mut bad = file.clone();
            bad[i] = rng.bits() as u8;
            if let Ok(set) = hair::parse(&bad) {
                assert_eq!(set.offsets.last().copied(), Some(set.points.len() as u32));
                assert_eq!(set.widths.len(), set.points.len());
            }
        }
    }
    let patched = |at: usize, word: u32| {
        let mut bad = file.clone();
        bad[at..at + 4].copy_from_slice(&word.to_le_bytes());
        hair::parse(&bad).unwrap_err()
    };
    assert!(patched(4, 100_000_000).contains("100000000 strands"));
    assert!(patched(8, u32::MAX).contains("4294967295 points"));
    assert!(patched(4, 0).contains("no strands"));
    assert!(patched(12, 1).contains("no points"));
    assert!(patched(12, 0xff).contains("unknown kind"));
    assert!(patched(4, 49).contains("points"));
    // The first coordinate comes after 50 numbers of segments.
    assert!(patched(128 + 100, f32::NAN.to_bits()).contains("point 0 of strand 0"));
    // Hair without an array of segments takes no bytes for its strands.
    let mut tiny = file[..1024].to_vec();
    tiny[4..8].copy_from_slice(&100_000_000u32.to_le_bytes());
    tiny[8..12].copy_from_slice(&0u32.to_le_bytes());
    tiny[12..16].copy_from_slice(&2u32.to_le_bytes());
    assert!(hair::parse(&tiny).unwrap_err().contains("need"));
}

#[test]
fn formats_hold_what_they_can() {
    let set = sample();
    let text = String::from_utf8(bytes(LineFormat::Pbrt, &set)).unwrap();
    let spans = set.points.len() - 50;
    assert_eq!(text.matches("Shape \"curve\"").count(), spans);
    // Two more points than a strand has, and an empty line after it.
    let text = String::from_utf8(bytes(LineFormat::Mitsuba, &set)).unwrap();
    let strands: Vec<usize> = text
        .trim_end()
        .split("\n\n")
        .map(|s| s.lines().count())
        .collect();
    let points = set.offsets.windows(2).map(|o| (o[1] - o[0]) as usize + 2);
    assert_eq!(strands, points.collect::<Vec<_>>());
    let glb = bytes(LineFormat::Glb, &set);
    assert_eq!(
        u32::from_le_bytes(glb[8..12].try_into().unwrap()) as usize,
        glb.len()
    );
    let long = LineSet {
        points: vec![Vec3::ZERO; 70_000],
        widths: vec![1.0; 70_000],
        offsets: vec![0, 70_000],
        colors: Vec::new(),
    };
    let mut out = Vec::new();
    let refused = write_to(&mut out, LineFormat::Hair, &long.lines(""));
    assert!(matches!(refused, Err(WriteError::Format(_))));
    let none = LineSet::default();
    assert!(write_to(&mut out, LineFormat::Npz, &none.lines("")).is_err());
}
