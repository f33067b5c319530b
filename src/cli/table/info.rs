//! `vair table info`: a table file in words and numbers.

use crate::cli::Failure;
use crate::cli::stdout::{print, print_json};
use crate::table::{Ledger, Mode, Nodes, PHOTON, Provenance, TableFile, format_of, part_name};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Options of `vair table info`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  vair table info red-fox.exr\n  \
    vair table info red-fox.exr --json | jq '.bins[0].albedo'")]
pub(super) struct Args {
    /// The table file.
    file: PathBuf,
    /// Print JSON: all of it, the species text and the exact integers of the ledger too.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let table = TableFile::read(&args.file)?;
    let summary = Summary::new(&table);
    if args.json {
        let mut json = summary.json();
        json["file"] = json!(args.file.to_string_lossy());
        print_json(&json)
    } else {
        print(&summary.text())
    }
}

/// What both kinds of tables have to say.
struct Summary<'a> {
    kind: &'static str,
    nodes: &'a Nodes,
    res: usize,
    radius_um: f64,
    /// Absorption levels of a structure table, else empty.
    levels: &'a [f64],
    /// Absorption of a dyed table.
    absorption_per_um: Option<[f64; 3]>,
    channels: Vec<String>,
    /// `albedo[node][channel]`.
    albedo: Vec<Vec<f64>>,
    /// Bakes of a dyed table: 1, or 3 where each channel was baked by itself.
    bakes: Option<usize>,
    /// `ledger[node][level]`; a dyed table has the clear level's only, of each bake.
    ledger: Vec<&'a [Ledger]>,
    provenance: &'a Provenance,
}

impl<'a> Summary<'a> {
    fn new(table: &'a TableFile) -> Self {
        match table {
            TableFile::Structure(t) => {
                let levels = t.levels.len();
                let albedo = |node| (0..levels).map(|l| t.albedo(node, l)).collect();
                Self {
                    kind: "structure",
                    nodes: &t.nodes,
                    res: t.res,
                    radius_um: t.radius_um,
                    levels: &t.levels,
                    absorption_per_um: None,
                    bakes: None,
                    channels: (0..levels).map(|l| format!("a{l:02}")).collect(),
                    albedo: (0..t.nodes.len()).map(albedo).collect(),
                    ledger: t.ledger.chunks(levels).collect(),
                    provenance: &t.provenance,
                }
            }
            TableFile::Scatter(t) => Self {
                kind: "scatter",
                nodes: &t.nodes,
                res: t.res,
                radius_um: t.radius_um,
                levels: &[],
                absorption_per_um: Some(t.absorption_per_um),
                bakes: Some(t.bakes()),
                channels: ["R", "G", "B"].map(str::to_owned).to_vec(),
                albedo: (0..t.nodes.len()).map(|n| t.albedo(n).to_vec()).collect(),
                ledger: t.ledger.chunks(t.bakes()).collect(),
                provenance: &t.provenance,
            },
        }
    }

    fn mode(&self) -> &'static str {
        match self.nodes.mode {
            Mode::Paper => "paper",
            Mode::Cone => "cone",
        }
    }

    /// Nodes in the order of the file's parts: the paper counts from the tip.
    fn bins(&self) -> impl Iterator<Item = (usize, usize)> {
        let n = self.nodes.len();
        (0..n).map(move |bin| (bin, self.nodes.node_of_part(bin)))
    }

    /// Bounds and middle of a node's azimuths, degrees from the major axis, if there are several.
    fn azimuth_deg(&self, node: usize) -> Option<[f64; 3]> {
        let azimuths = self.nodes.azimuths;
        let range = azimuths.range(self.nodes.azimuth_bin(node));
        (!azimuths.is_averaged()).then(|| range.map(f64::to_degrees))
    }

    fn photons(&self) -> f64 {
        let emitted = self.ledger.iter().map(|l| u128::from(l[0].emitted));
        emitted.sum::<u128>() as f64 / PHOTON as f64
    }

    fn json(&self) -> Value {
        let p = self.provenance;
        let bins: Vec<Value> = self
            .bins()
            .map(|(bin, node)| self.bin_json(bin, node))
            .collect();
        json!({
            "format": format_of(self.nodes),
            "azimuths": self.nodes.azimuths.count,
            "kind": self.kind,
            "mode": self.mode(),
            "warp": "unicube",
            "face": self.res,
            "channels": self.channels,
            "levels": self.levels,
            "absorption_per_um": self.absorption_per_um,
            "bakes": self.bakes,
            "radius_um": self.radius_um,
            "photons": self.photons(),
            "ledger_units_per_photon": PHOTON,
            "species": p.species,
            "class": p.class,
            "station": p.station,
            "seed": p.seed,
            "photon_seed": p.photon_seed,
            "max_events": p.max_events,
            "content": p.content,
            "program": p.program,
            "species_text": p.species_text,
            "bins": bins,
        })
    }

    fn bin_json(&self, bin: usize, node: usize) -> Value {
        let nodes = self.nodes;
        let clear = &self.ledger[node][0];
        let [from, to] = nodes.theta_range(node);
        let side = self.azimuth_deg(node);
        json!({
            "bin": bin,
            "part": part_name(nodes, bin),
            "theta_deg": nodes.theta(node).to_degrees(),
            "theta_from_deg": from.to_degrees(),
            "theta_to_deg": to.to_degrees(),
            "azimuth_deg": side.map(|[_, _, middle]| middle),
            "azimuth_from_deg": side.map(|[from, ..]| from),
            "azimuth_to_deg": side.map(|[_, to, _]| to),
            "photons": clear.emitted as f64 / PHOTON as f64,
            "albedo": self.albedo[node],
            "truncated": share(clear.truncated, clear.emitted),
            "lost": share(clear.lost, clear.emitted),
            "ledger": self.ledger[node],
        })
    }

    fn text(&self) -> String {
        let p = self.provenance;
        let mut out = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(out, "{name:<12} {value}");
        };
        line(
            "table",
            format!(
                "{}, {} mode, format {}",
                self.kind,
                self.mode(),
                format_of(self.nodes)
            ),
        );
        let class = if p.class.is_empty() { "-" } else { &p.class };
        line(
            "species",
            format!("{}, {class}, station {}", p.species, p.station),
        );
        line("radius", format!("{} um", self.radius_um));
        line(
            "maps",
            format!(
                "{} bins of 6 x {res} x {res} texels, channels {}",
                match self.nodes.azimuths.count {
                    1 => self.nodes.len().to_string(),
                    count => format!("{count} azimuths, {}", self.nodes.inclinations()),
                },
                self.channels.join(" "),
                res = self.res
            ),
        );
        if !self.levels.is_empty() {
            line(
                "levels",
                format!("{} (optical depth per radius)", numbers(self.levels)),
            );
        }
        if let Some(absorption) = self.absorption_per_um {
            line("absorption", format!("{} per um", numbers(&absorption)));
        }
        let each = if self.bakes == Some(3) {
            " for each of R, G, B: materials differ by color"
        } else {
            ""
        };
        line(
            "photons",
            format!(
                "{}{each}, seed {}, photon seed {}",
                self.photons(),
                p.seed,
                p.photon_seed
            ),
        );
        line("max events", p.max_events.to_string());
        line("content", p.content.clone());
        line("program", p.program.clone());
        out.push('\n');
        out.push_str(&self.bin_table());
        out
    }

    fn bin_table(&self) -> String {
        let shown = shown_channels(self.channels.len());
        let has_sides = !self.nodes.azimuths.is_averaged();
        let mut out = String::from("bin");
        if has_sides {
            out.push_str("      azimuth");
        }
        out.push_str("   theta        from .. to     photons  truncated       lost");
        for &c in &shown {
            let _ = write!(out, "  {:>7}", self.channels[c]);
        }
        out.push('\n');
        for (bin, node) in self.bins() {
            let clear = &self.ledger[node][0];
            let [from, to] = self.nodes.theta_range(node);
            let _ = write!(out, "{bin:>3}");
            if let Some([from, to, _]) = self.azimuth_deg(node) {
                let _ = write!(out, " {from:>5.1} .. {to:>3.0}");
            }
            let _ = write!(
                out,
                " {:>7.2} {:>8.2} .. {:>6.2} {:>11} {:>10} {:>10}",
                self.nodes.theta(node).to_degrees(),
                from.to_degrees(),
                to.to_degrees(),
                clear.emitted / PHOTON,
                percent(share(clear.truncated, clear.emitted)),
                percent(share(clear.lost, clear.emitted)),
            );
            for &c in &shown {
                let _ = write!(out, "  {:>7.5}", self.albedo[node][c]);
            }
            out.push('\n');
        }
        if shown.len() < self.channels.len() {
            out.push_str("(albedo of some levels; all of them with --json)\n");
        }
        out
    }
}

/// Channels that fit a terminal beside the rest: all of RGB, five of many levels.
fn shown_channels(count: usize) -> Vec<usize> {
    const FIT: usize = 5;
    if count <= FIT {
        return (0..count).collect();
    }
    (0..FIT).map(|i| i * (count - 1) / (FIT - 1)).collect()
}

fn share(part: u64, whole: u64) -> f64 {
    part as f64 / whole.max(1) as f64
}

fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0 %".to_owned(),
        p if p < 0.001 => format!("{p:.1e} %"),
        p => format!("{p:.3} %"),
    }
}

fn numbers(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|v| format!("{v}")).collect();
    words.join(" ")
}
