//! Parts as tables.

use super::attributes::Attributes;
use super::parts::Part;
use super::{COLORS, FORMAT, FORMAT_AZIMUTHS, TableFile, azimuths, error_channel, level_channel};
use crate::table::{
    Azimuths, Ledger, Mode, Nodes, Provenance, ScatterMaps, StructureTable, TableError,
};
use std::f64::consts::FRAC_PI_2;

/// The table that the parts hold; every contradiction is refused.
pub(super) fn table(parts: Vec<Part>) -> Result<TableFile, TableError> {
    let Some(first) = parts.first() else {
        return Err(wrong("it has no parts"));
    };
    let head = first.attributes.clone();
    let format: i32 = head.get_int("format")?;
    let azimuths = match format {
        FORMAT => Azimuths::AVERAGED,
        FORMAT_AZIMUTHS => azimuths::of_head(&head)?,
        _ => {
            return Err(wrong(format!(
                "it has format version {format}; this program reads versions {FORMAT}, packed 2 and \
                 {FORMAT_AZIMUTHS}"
            )));
        }
    };
    let warp = head.get_text("warp")?;
    if warp != "unicube" {
        return Err(wrong(format!(
            "its texel warp is {warp:?}, not \"unicube\""
        )));
    }
    let mode = mode(&head)?;
    let res = first.res;
    let (bins, face): (usize, usize) = (head.get_int("bins")?, head.get_int("face")?);
    if bins.checked_mul(azimuths.count) != Some(parts.len()) || face != res {
        return Err(wrong(format!(
            "it has {} parts of width {res} but claims {bins} of width {face}{}",
            parts.len(),
            match azimuths.count {
                1 => String::new(),
                count => format!(" for each of {count} azimuths"),
            }
        )));
    }
    for (bin, part) in parts.iter().enumerate() {
        let name = azimuths::part_name(&azimuths, bin, bins);
        if part.name != name || part.res != res {
            return Err(wrong(format!(
                "part {bin} is called {:?} and {} texels wide; expected {name} and {res}",
                part.name, part.res
            )));
        }
    }
    azimuths::check_parts(&azimuths, &parts)?;
    // From here on everything is by node.
    let mut by_node = parts;
    if mode == Mode::Paper {
        by_node.reverse();
    }
    let nodes = nodes(mode, &by_node[..bins])?.at_azimuths(azimuths);
    match head.get_text("kind")? {
        "structure" => structure(nodes, by_node, &head).map(TableFile::Structure),
        "scatter" => scatter(nodes, by_node, &head).map(TableFile::Scatter),
        other => Err(wrong(format!(
            "its kind is {other:?}, neither structure nor scatter"
        ))),
    }
}

fn structure(
    nodes: Nodes,
    parts: Vec<Part>,
    head: &Attributes,
) -> Result<StructureTable, TableError> {
    let levels: Vec<f64> = head.get_numbers("levels")?;
    let names: Vec<String> = (0..levels.len()).map(level_channel).collect();
    let res = parts[0].res;
    let mut table = StructureTable {
        nodes,
        res,
        radius_um: head.get_double("radius_um")?,
        flux: Vec::with_capacity(parts.len() * levels.len() * 6 * res * res),
        error: Vec::with_capacity(parts.len() * 6 * res * res),
        ledger: Vec::with_capacity(parts.len() * levels.len()),
        provenance: provenance(head)?,
        levels,
    };
    for mut part in parts {
        table
            .ledger
            .extend(ledger(&part.attributes, table.levels.len())?);
        expect_channels(&part, names.len() + 1)?;
        for name in &names {
            table.flux.extend(take_channel(&mut part, name)?);
        }
        table.error.extend(take_channel(&mut part, "error")?);
    }
    table.check()?;
    Ok(table)
}

fn scatter(nodes: Nodes, parts: Vec<Part>, head: &Attributes) -> Result<ScatterMaps, TableError> {
    let absorption: Vec<f64> = head.get_list("absorption_per_um", 3)?;
    let bakes: usize = head.get_int("bakes")?;
    if bakes != 1 && bakes != 3 {
        return Err(wrong(format!("it comes from {bakes} bakes, not 1 or 3")));
    }
    let mut maps = ScatterMaps {
        nodes,
        res: parts[0].res,
        rgb: Vec::new(),
        error: Vec::new(),
        absorption_per_um: [absorption[0], absorption[1], absorption[2]],
        radius_um: head.get_double("radius_um")?,
        ledger: Vec::new(),
        provenance: provenance(head)?,
    };
    for mut part in parts {
        maps.ledger.extend(ledger(&part.attributes, bakes)?);
        expect_channels(&part, 6)?;
        maps.rgb.extend(take_colors(&mut part, str::to_owned)?);
        maps.error.extend(take_colors(&mut part, error_channel)?);
    }
    maps.check()?;
    Ok(maps)
}

/// Angles are degrees in files. The program's own nodes come back to the last bit; others as close
/// as degrees allow.
fn nodes(mode: Mode, parts: &[Part]) -> Result<Nodes, TableError> {
    let (mut edges, mut centers) = (Vec::<f64>::new(), Vec::new());
    for part in parts {
        let from = part.attributes.get_double("theta_from_deg")?.to_radians();
        match edges.last() {
            Some(&last) if f64::abs(last - from) > 1e-9 => {
                return Err(wrong(format!(
                    "{} begins at {:.6} degrees where its neighbor ends at {:.6}",
                    part.name,
                    from.to_degrees(),
                    last.to_degrees()
                )));
            }
            Some(_) => {}
            None => edges.push(from.max(-FRAC_PI_2)),
        }
        let to = part.attributes.get_double("theta_to_deg")?.to_radians();
        let center = part.attributes.get_double("theta_deg")?.to_radians();
        edges.push(to.min(FRAC_PI_2));
        centers.push(center);
    }
    Ok(own_nodes(mode, edges, centers))
}

/// Nodes of the angles, the program's own to the last bit if they are that.
pub(super) fn own_nodes(mode: Mode, edges: Vec<f64>, centers: Vec<f64>) -> Nodes {
    let own = Nodes::new(mode, centers.len());
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    if near(&edges, &own.edges) && near(&centers, &own.centers) {
        return own;
    }
    Nodes {
        mode,
        edges,
        centers,
        azimuths: Azimuths::AVERAGED,
    }
}

pub(super) fn mode(head: &Attributes) -> Result<Mode, TableError> {
    match head.get_text("mode")? {
        "paper" => Ok(Mode::Paper),
        "cone" => Ok(Mode::Cone),
        other => Err(wrong(format!("its mode is {other:?}"))),
    }
}

fn ledger(attributes: &Attributes, count: usize) -> Result<Vec<Ledger>, TableError> {
    let [emitted, escaped, absorbed, truncated, lost] =
        ["emitted", "escaped", "absorbed", "truncated", "lost"]
            .map(|name| attributes.get_list::<u64>(name, count));
    let (emitted, escaped, absorbed) = (emitted?, escaped?, absorbed?);
    let (truncated, lost) = (truncated?, lost?);
    let entry = |i: usize| Ledger {
        emitted: emitted[i],
        escaped: escaped[i],
        absorbed: absorbed[i],
        truncated: truncated[i],
        lost: lost[i],
    };
    Ok((0..count).map(entry).collect())
}

pub(super) fn provenance(head: &Attributes) -> Result<Provenance, TableError> {
    Ok(Provenance {
        species: head.get_text("species")?.to_owned(),
        class: head.get_text("class")?.to_owned(),
        station: head.get_double("station")?,
        seed: head.get_parsed("seed")?,
        photon_seed: head.get_parsed("photon_seed")?,
        max_events: head.get_parsed("max_events")?,
        content: head.get_text("content")?.to_owned(),
        species_text: head.get_text("species_text")?.to_owned(),
        program: head.get_text("program")?.to_owned(),
    })
}

fn expect_channels(part: &Part, count: usize) -> Result<(), TableError> {
    if part.channels.len() == count {
        return Ok(());
    }
    let names: Vec<&str> = part
        .channels
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    Err(wrong(format!(
        "part {} has {} channels ({}), not {count}",
        part.name,
        names.len(),
        names.join(" ")
    )))
}

fn take_channel(part: &mut Part, name: &str) -> Result<Vec<f32>, TableError> {
    let found = part.channels.iter_mut().find(|(n, _)| n == name);
    let (_, samples) =
        found.ok_or_else(|| wrong(format!("part {} has no channel {name}", part.name)))?;
    Ok(std::mem::take(samples).into_owned())
}

/// Three channels as one value a texel.
fn take_colors(
    part: &mut Part,
    name: impl Fn(&str) -> String,
) -> Result<Vec<[f32; 3]>, TableError> {
    let [r, g, b] = COLORS.map(|color| take_channel(part, &name(color)));
    let (r, g, b) = (r?, g?, b?);
    let texels = r.iter().zip(&g).zip(&b);
    Ok(texels.map(|((&r, &g), &b)| [r, g, b]).collect())
}

pub(super) fn wrong(what: impl Into<String>) -> TableError {
    TableError::Inconsistent(what.into())
}
