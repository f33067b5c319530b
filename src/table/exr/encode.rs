//! Tables as parts.

use super::attributes::Attributes;
use super::parts::Part;
use super::{COLORS, azimuths, error_channel, format_of, level_channel, part_name};
use crate::table::{Ledger, Mode, Nodes, PHOTON, Provenance, ScatterMaps, StructureTable};
use std::borrow::Cow;

/// The parts of a structure table.
pub(super) fn structure(table: &StructureTable) -> Vec<Part<'_>> {
    let (levels, texels) = (table.levels.len(), table.texels());
    let mut parts = parts(&table.nodes, table.res, |node, attributes| {
        let ledger = &table.ledger[node * levels..(node + 1) * levels];
        put_ledger(attributes, ledger);
        attributes.list("albedo", (0..levels).map(|l| table.albedo(node, l)));
        let mut channels: Vec<_> = (0..levels)
            .map(|level| (level_channel(level), table.map(node, level).into()))
            .collect();
        let error = &table.error[node * texels..(node + 1) * texels];
        channels.push(("error".to_owned(), error.into()));
        channels
    });
    let head = &mut parts[0].attributes;
    head.text("kind", "structure");
    head.list("levels", &table.levels);
    head.double("radius_um", table.radius_um);
    put_provenance(head, &table.provenance);
    parts
}

/// The parts of a dyed table.
pub(super) fn scatter(maps: &ScatterMaps) -> Vec<Part<'_>> {
    let texels = maps.texels();
    let mut parts = parts(&maps.nodes, maps.res, |node, attributes| {
        let errors = &maps.error[node * texels..(node + 1) * texels];
        let bakes = maps.bakes();
        put_ledger(attributes, &maps.ledger[node * bakes..(node + 1) * bakes]);
        attributes.list("albedo", maps.albedo(node));
        let channel = |texels: &[[f32; 3]], c: usize| -> Cow<'_, [f32]> {
            Cow::Owned(texels.iter().map(|rgb| rgb[c]).collect())
        };
        let colors = COLORS.iter().enumerate();
        let flux = colors
            .clone()
            .map(|(c, name)| ((*name).to_owned(), channel(maps.map(node), c)));
        let error = colors.map(|(c, name)| (error_channel(name), channel(errors, c)));
        flux.chain(error).collect()
    });
    let head = &mut parts[0].attributes;
    head.text("kind", "scatter");
    head.int("bakes", maps.bakes());
    head.list("absorption_per_um", maps.absorption_per_um);
    head.double("radius_um", maps.radius_um);
    put_provenance(head, &maps.provenance);
    parts
}

/// Parts with what both kinds have in common; `fill` adds a node's own attributes and gives its
/// channels.
fn parts<'a>(
    nodes: &Nodes,
    res: usize,
    fill: impl Fn(usize, &mut Attributes) -> Vec<(String, Cow<'a, [f32]>)>,
) -> Vec<Part<'a>> {
    let mut parts: Vec<Part<'a>> = (0..nodes.len())
        .map(|bin| {
            let node = nodes.node_of_part(bin);
            let mut attributes = Attributes::default();
            let [from, to] = nodes.theta_range(node);
            attributes.double("theta_deg", nodes.theta(node).to_degrees());
            attributes.double("theta_from_deg", from.to_degrees());
            attributes.double("theta_to_deg", to.to_degrees());
            azimuths::put_bin(&mut attributes, nodes, node);
            let channels = fill(node, &mut attributes);
            Part {
                name: part_name(nodes, bin),
                res,
                channels,
                attributes,
            }
        })
        .collect();
    let head = &mut parts[0].attributes;
    head.int("format", format_of(nodes) as usize);
    head.int("bins", nodes.inclinations());
    azimuths::put_head(head, &nodes.azimuths);
    head.int("face", res);
    head.text("warp", "unicube");
    put_mode(head, nodes.mode);
    parts
}

pub(super) fn put_mode(head: &mut Attributes, mode: Mode) {
    head.text(
        "mode",
        match mode {
            Mode::Paper => "paper",
            Mode::Cone => "cone",
        },
    );
}

fn put_ledger(attributes: &mut Attributes, ledger: &[Ledger]) {
    let photons = ledger[0].emitted as f64 / PHOTON as f64;
    attributes.double("photons", photons);
    attributes.list("emitted", ledger.iter().map(|l| l.emitted));
    attributes.list("escaped", ledger.iter().map(|l| l.escaped));
    attributes.list("absorbed", ledger.iter().map(|l| l.absorbed));
    attributes.list("truncated", ledger.iter().map(|l| l.truncated));
    attributes.list("lost", ledger.iter().map(|l| l.lost));
}

pub(super) fn put_provenance(head: &mut Attributes, provenance: &Provenance) {
    head.text("species", &provenance.species);
    head.text("class", &provenance.class);
    head.double("station", provenance.station);
    head.text("seed", provenance.seed.to_string());
    head.text("photon_seed", provenance.photon_seed.to_string());
    head.text("max_events", provenance.max_events.to_string());
    head.text("content", &provenance.content);
    head.text("species_text", &provenance.species_text);
    head.text("program", &provenance.program);
}
