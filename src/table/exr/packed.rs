//! Packed tables as files: format version 2.
//!
//! Five parts, each a plain image: `packed` (the ledger, and all attributes), `albedo`, `mix`, `trees`
//! and `values`.

use super::attributes::Attributes;
use super::raw::{self, RawPart};
use super::{decode, encode};
use crate::table::check::{MAX_BINS, MAX_LEVELS, MAX_RES, MAX_SAMPLES};
use crate::table::pack::{Code, Kind, Layout, PackedTable, Trees};
use crate::table::{Ledger, TableError};
use exr::meta::header::Header;
use exr::prelude::{Compression, FlatSamples, Vec2, f16};
use std::path::Path;

/// Version of the packed format.
pub(super) const FORMAT: i32 = 2;

/// Width of the parts that hold a mere row of numbers.
const WIDTH: usize = 1024;

/// The columns of the ledger that are stored; the absorbed share is what they leave.
const LEDGER: [&str; 4] = ["emitted", "escaped", "truncated", "lost"];

/// Refuses what no packed table claims before memory is set aside for it.
pub(super) fn check_headers(headers: &[Header]) -> Result<(), TableError> {
    let mut samples = 0usize;
    for (i, header) in headers.iter().enumerate() {
        let Vec2(width, height) = header.layer_size;
        let plain = header
            .channels
            .list
            .iter()
            .all(|c| c.sampling == Vec2(1, 1));
        let numbers = width
            .checked_mul(height)
            .and_then(|n| n.checked_mul(header.channels.list.len()));
        match numbers {
            Some(n) if plain && !header.deep && n <= MAX_SAMPLES => samples += n,
            _ => {
                return Err(wrong(format!(
                    "part {i} is no plain image of sensible size"
                )));
            }
        }
    }
    if headers.len() > 16 || samples > MAX_SAMPLES {
        return Err(wrong(format!(
            "it claims {} parts and {samples} numbers; 5 and {MAX_SAMPLES} are allowed",
            headers.len()
        )));
    }
    Ok(())
}

/// The bytes of a packed table.
pub(in crate::table) fn encode_packed(
    table: &PackedTable,
    path: &Path,
) -> Result<Vec<u8>, TableError> {
    let (nodes, channels) = (table.nodes.len(), table.kind.channels());
    let code = &table.code;
    let mut head = Attributes::default();
    head.int("format", FORMAT as usize);
    head.text("warp", "unicube");
    encode::put_mode(&mut head, table.nodes.mode);
    head.int("bins", nodes);
    head.int("face", code.layout.res);
    match &table.kind {
        Kind::Structure { levels } => {
            head.text("kind", "structure");
            head.list("levels", levels);
        }
        Kind::Scatter { absorption_per_um } => {
            head.text("kind", "scatter");
            head.list("absorption_per_um", absorption_per_um);
        }
    }
    head.double("radius_um", table.radius_um);
    let degrees = |angles: &[f64]| angles.iter().map(|a| a.to_degrees()).collect::<Vec<_>>();
    head.list("theta_deg", degrees(&table.nodes.centers));
    head.list("edges_deg", degrees(&table.nodes.edges));
    head.int("folded", usize::from(code.layout.folded));
    head.int("aligned", usize::from(code.aligned));
    head.int("images", code.images);
    head.int("bits", code.trees.bits.len());
    head.int("values", code.trees.leaves.len());
    encode::put_provenance(&mut head, &table.provenance);

    let column = |of: fn(&Ledger) -> u64, shift: u32| {
        let words = table.ledger.iter().map(|l| (of(l) >> shift) as u32);
        FlatSamples::U32(words.collect())
    };
    let columns: [fn(&Ledger) -> u64; 4] =
        [|l| l.emitted, |l| l.escaped, |l| l.truncated, |l| l.lost];
    let ledger = LEDGER.iter().zip(columns).flat_map(|(name, of)| {
        [
            (format!("{name}.hi"), column(of, 32)),
            (format!("{name}.lo"), column(of, 0)),
        ]
    });
    let words = code.trees.bits.chunks(32).map(|bits| {
        let bit = |(i, &bit): (usize, &bool)| u32::from(bit) << i;
        bits.iter().enumerate().map(bit).sum::<u32>()
    });
    let values = code.trees.leaves.iter().map(|&v| f16::from_f32(v));
    let rows = code.mix.len() / code.images.max(1);
    let parts = vec![
        RawPart {
            name: "packed".to_owned(),
            width: table.ledger.len() / nodes.max(1),
            height: nodes,
            channels: ledger.collect(),
            attributes: head,
        },
        plain(
            "albedo",
            channels,
            nodes,
            FlatSamples::F32(table.albedo.clone()),
        ),
        plain("mix", code.images, rows, FlatSamples::F32(code.mix.clone())),
        line("trees", words.collect(), FlatSamples::U32),
        line("values", values.collect(), FlatSamples::F16),
    ];
    raw::encode(parts, Compression::ZIP16, path)
}

fn plain(name: &str, width: usize, height: usize, samples: FlatSamples) -> RawPart {
    RawPart {
        name: name.to_owned(),
        width,
        height,
        channels: vec![("Y".to_owned(), samples)],
        attributes: Attributes::default(),
    }
}

/// Numbers in rows of [`WIDTH`], the last one filled up with zeros; at least one row.
fn line<T: Copy + Default>(
    name: &str,
    mut numbers: Vec<T>,
    samples: impl Fn(Vec<T>) -> FlatSamples,
) -> RawPart {
    let width = numbers.len().clamp(1, WIDTH);
    let height = numbers.len().div_ceil(width).max(1);
    numbers.resize(width * height, T::default());
    plain(name, width, height, samples(numbers))
}

/// The packed table that the parts hold.
pub(super) fn decode_packed(parts: Vec<RawPart>) -> Result<PackedTable, TableError> {
    let names: Vec<&str> = parts.iter().map(|p| p.name.as_str()).collect();
    if names != ["packed", "albedo", "mix", "trees", "values"] {
        return Err(wrong(format!(
            "its parts are {}; packed, albedo, mix, trees and values were expected",
            names.join(", ")
        )));
    }
    let head = parts[0].attributes.clone();
    let mode = decode::mode(&head)?;
    let (bins, res): (usize, usize) = (head.get_int("bins")?, head.get_int("face")?);
    if bins == 0 || bins > MAX_BINS || res == 0 || res > MAX_RES || !res.is_power_of_two() {
        return Err(wrong(format!(
            "it claims {bins} nodes and faces of {res}; up to {MAX_BINS} and powers of two up to {MAX_RES} \
             are possible"
        )));
    }
    let radians = |name: &str, count: usize| {
        let degrees: Vec<f64> = head.get_list(name, count)?;
        Ok::<_, TableError>(
            degrees
                .into_iter()
                .map(f64::to_radians)
                .collect::<Vec<f64>>(),
        )
    };
    let nodes = decode::own_nodes(
        mode,
        radians("edges_deg", bins + 1)?,
        radians("theta_deg", bins)?,
    );
    let kind = match head.get_text("kind")? {
        "structure" => Kind::Structure {
            levels: head.get_numbers("levels")?,
        },
        "scatter" => {
            let absorption: Vec<f64> = head.get_list("absorption_per_um", 3)?;
            Kind::Scatter {
                absorption_per_um: [absorption[0], absorption[1], absorption[2]],
            }
        }
        other => return Err(wrong(format!("its kind is {other:?}"))),
    };
    if kind.channels() > MAX_LEVELS {
        return Err(wrong(format!("it claims {} levels", kind.channels())));
    }
    let flag = |name: &str| match head.get_int::<usize>(name)? {
        0 => Ok(false),
        1 => Ok(true),
        other => Err(wrong(format!(
            "attribute vair:{name} is {other}, not 0 or 1"
        ))),
    };
    let layout = Layout {
        res,
        folded: flag("folded")?,
    };
    if layout.folded && res < 2 {
        return Err(wrong("faces of one texel cannot be folded"));
    }
    let (bits, values): (usize, usize) = (head.get_int("bits")?, head.get_int("values")?);
    let mut code = Code {
        layout,
        aligned: flag("aligned")?,
        images: head.get_int("images")?,
        mix: Vec::new(),
        trees: Trees::default(),
    };
    if code.images == 0 || code.images > bins * kind.channels() {
        return Err(wrong(format!("it claims {} images", code.images)));
    }
    let (tiles, side) = code.tiles(bins);
    if tiles * side * side > MAX_SAMPLES || bins * kind.channels() * 6 * res * res > MAX_SAMPLES {
        return Err(wrong("it claims more numbers than any table may hold"));
    }
    if values < tiles {
        return Err(wrong(format!("it holds {values} values for {tiles} tiles")));
    }
    let radius_um = head.get_double("radius_um")?;
    let provenance = decode::provenance(&head)?;
    let mut parts = parts.into_iter();
    let mut next = || parts.next().ok_or_else(|| wrong("a part is missing"));
    let ledger = ledger(next()?, bins, &kind)?;
    let albedo = floats(next()?, kind.channels(), bins)?;
    let rows = kind.channels() * if code.aligned { bins } else { 1 };
    code.mix = floats(next()?, code.images, rows)?;
    code.trees.bits = match only(next()?)? {
        FlatSamples::U32(words) if words.len() * 32 >= bits => {
            let all = words
                .iter()
                .flat_map(|w| (0..32).map(move |i| w >> i & 1 == 1));
            all.take(bits).collect()
        }
        _ => return Err(wrong(format!("part trees does not hold {bits} bits"))),
    };
    code.trees.leaves = match only(next()?)? {
        FlatSamples::F16(all) if all.len() >= values => {
            all[..values].iter().map(|v| v.to_f32()).collect()
        }
        _ => {
            return Err(wrong(format!(
                "part values does not hold {values} half floats"
            )));
        }
    };
    let finite = |all: &[f32]| all.iter().all(|v| v.is_finite());
    if !finite(&code.mix)
        || !finite(&code.trees.leaves)
        || !albedo.iter().all(|a| (0.0..=1e3).contains(a))
    {
        return Err(wrong("a value is no finite number, or an albedo negative"));
    }
    Ok(PackedTable {
        kind,
        nodes,
        radius_um,
        provenance,
        ledger,
        albedo,
        code,
    })
}

fn ledger(mut part: RawPart, bins: usize, kind: &Kind) -> Result<Vec<Ledger>, TableError> {
    let possible: &[usize] = match kind {
        Kind::Structure { levels } => &[levels.len()],
        Kind::Scatter { .. } => &[1, 3],
    };
    if part.height != bins || !possible.contains(&part.width) {
        return Err(wrong(format!(
            "its ledger is {} x {}, not {possible:?} x {bins}",
            part.width, part.height
        )));
    }
    let mut word = |name: String| {
        let found = part.channels.iter_mut().find(|(n, _)| *n == name);
        match found.map(|(_, samples)| std::mem::replace(samples, FlatSamples::U32(Vec::new()))) {
            Some(FlatSamples::U32(words)) if !words.is_empty() => Ok(words),
            _ => Err(wrong(format!("its ledger lacks the integers {name}"))),
        }
    };
    let mut columns = Vec::new();
    for name in LEDGER {
        let (high, low) = (word(format!("{name}.hi"))?, word(format!("{name}.lo"))?);
        let pairs = high.iter().zip(&low);
        columns.push(
            pairs
                .map(|(&h, &l)| u64::from(h) << 32 | u64::from(l))
                .collect::<Vec<u64>>(),
        );
    }
    let entry = |i: usize| {
        let [emitted, escaped, truncated, lost] = [0, 1, 2, 3].map(|c| columns[c][i]);
        let rest = [escaped, truncated, lost]
            .iter()
            .try_fold(emitted, |rest, &part| rest.checked_sub(part));
        let absorbed = rest.ok_or_else(|| wrong("its ledger gives out more light than came in"))?;
        Ok(Ledger {
            emitted,
            escaped,
            absorbed,
            truncated,
            lost,
        })
    };
    (0..columns[0].len()).map(entry).collect()
}

fn floats(part: RawPart, width: usize, height: usize) -> Result<Vec<f32>, TableError> {
    let (name, found) = (part.name.clone(), (part.width, part.height));
    match only(part)? {
        FlatSamples::F32(samples) if found == (width, height) => Ok(samples),
        _ => Err(wrong(format!(
            "part {name} is {} x {}, not {width} x {height} floats",
            found.0, found.1
        ))),
    }
}

/// The samples of a part of one channel.
fn only(mut part: RawPart) -> Result<FlatSamples, TableError> {
    match part.channels.pop() {
        Some((_, samples)) if part.channels.is_empty() => Ok(samples),
        _ => Err(wrong(format!(
            "part {} has not exactly one channel",
            part.name
        ))),
    }
}

fn wrong(what: impl Into<String>) -> TableError {
    TableError::Inconsistent(what.into())
}
