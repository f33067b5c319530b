//! `vair table fit`: hair shaders in closed form fitted to a table.

use super::compare::percent;
use super::dye::Pigment;
use crate::blame::Blame;
use crate::cli::stdout::{print, print_json};
use crate::cli::{Console, Failure};
use crate::table::{Fit, Model, StructureTable, TableFile, TableRef};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Optical depths per radius whose nearest levels are fitted if nothing is said: clear, pale, dark.
const DEPTHS: [f64; 3] = [0.0, 0.2, 1.0];

/// Options of `vair table fit`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    vair table fit fox.exr --species red-fox\n  \
    vair table fit fox-dyed.exr --model chiang --json\n  \
    vair table fit fox.exr --level 0 --level 5\n\n\
    Index, roughness and tilt are common to all channels, each channel has its own absorption, per\n\
    radius. Errors are relative L2 distances of S below 73 degrees over bins of 2 by 5 degrees; a lobe's\n\
    is over the light that the model puts there.")]
pub(super) struct Args {
    /// A structure table or a dyed one.
    file: PathBuf,
    /// The model to fit; both if not given.
    #[arg(long, value_enum)]
    model: Option<ModelArg>,
    /// Absorption level of a structure table to fit, counted from 0. May repeat.
    #[arg(long, value_name = "K", conflicts_with_all = ["eumelanin", "pheomelanin", "absorption", "species"])]
    level: Vec<usize>,
    #[command(flatten)]
    pigment: Pigment,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ModelArg {
    /// Chiang et al. 2016, the hair shader of most renderers.
    Chiang,
    /// Cuticle, cortex and a medulla that scatters, after Yan et al. 2015.
    DoubleCylinder,
}

pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    let pigment = args.pigment.absorption_per_um()?;
    // Fits are of round hairs.
    let mut table = TableFile::read(&args.file)?.averaged()?;
    if let TableFile::Scatter(_) = table
        && (pigment.is_some() || !args.level.is_empty())
    {
        return Err(Failure::with_help(
            Blame::Input,
            format!("{} is dyed already", args.file.display()),
            "leave out the pigment or the levels",
        ));
    }
    if let (TableFile::Structure(structure), Some(absorption)) = (&table, pigment) {
        table = TableFile::Scatter(structure.dye(absorption)?);
    }
    let channels = match &table {
        TableFile::Structure(t) if args.level.is_empty() => usual_levels(t),
        TableFile::Structure(_) => args.level.clone(),
        TableFile::Scatter(_) => vec![0, 1, 2],
    };
    let names: Vec<String> = channels.iter().map(|&c| name(&table, c)).collect();
    let models = match args.model {
        Some(ModelArg::Chiang) => vec![Model::Chiang],
        Some(ModelArg::DoubleCylinder) => vec![Model::DoubleCylinder],
        None => vec![Model::Chiang, Model::DoubleCylinder],
    };
    let mut fits = Vec::new();
    for model in models {
        console.say(format_args!("fitting {}", model.name()));
        fits.push(model.fit(TableRef::from(&table), &channels)?);
    }
    if args.json {
        let fits: Vec<Value> = fits.iter().map(|fit| json(fit, &names)).collect();
        return print_json(&json!({
            "file": args.file.to_string_lossy(),
            "channels": names,
            "fits": fits,
        }));
    }
    let texts: Vec<String> = fits.iter().map(|fit| text(fit, &names)).collect();
    print(&texts.join("\n"))
}

fn usual_levels(table: &StructureTable) -> Vec<usize> {
    let off = |level: usize, depth: f64| (table.levels[level] - depth).abs();
    let nearest = |depth: f64| {
        let levels = 0..table.levels.len();
        levels.min_by(|&a, &b| off(a, depth).total_cmp(&off(b, depth)))
    };
    let mut levels: Vec<usize> = DEPTHS.iter().filter_map(|&d| nearest(d)).collect();
    levels.dedup();
    levels
}

fn name(table: &TableFile, channel: usize) -> String {
    match table {
        TableFile::Structure(t) => {
            let depth = t.levels.get(channel).copied().unwrap_or_default();
            format!("a{channel:02} (optical depth {depth})")
        }
        TableFile::Scatter(_) => ["R", "G", "B"][channel.min(2)].to_owned(),
    }
}

fn json(fit: &Fit, names: &[String]) -> Value {
    let mut parameters = serde_json::Map::new();
    for (name, value) in &fit.shared {
        parameters.insert((*name).to_owned(), json!(value));
    }
    parameters.insert("sigma_a".to_owned(), json!(fit.absorption));
    let lobes = fit
        .model
        .lobes()
        .iter()
        .zip(&fit.lobes)
        .map(|(name, lobe)| {
            json!({
                "lobe": name,
                "energy_of_table": lobe.table,
                "energy_of_model": lobe.model,
                "error": lobe.error,
            })
        });
    json!({
        "model": fit.model.name(),
        "parameters": parameters,
        "channels": names,
        "error": fit.error,
        "lobes": lobes.collect::<Vec<_>>(),
    })
}

fn text(fit: &Fit, names: &[String]) -> String {
    let mut out = match fit.model {
        Model::Chiang => "Chiang et al. 2016\n".to_owned(),
        Model::DoubleCylinder => "double cylinder, after Yan et al. 2015\n".to_owned(),
    };
    for (name, value) in &fit.shared {
        let _ = writeln!(out, "  {name:<12} {value:>8.4}   {}", meaning(name));
    }
    for ((name, sigma), error) in names.iter().zip(&fit.absorption).zip(&fit.error) {
        let _ = writeln!(
            out,
            "  sigma_a      {sigma:>8.4}   per radius, {name}; error {}",
            percent(*error).trim_start()
        );
    }
    let _ = writeln!(out, "\n  lobe    light of table   of model      error");
    for (name, lobe) in fit.model.lobes().iter().zip(&fit.lobes) {
        let _ = writeln!(
            out,
            "  {name:<8}     {}   {}   {}",
            percent(lobe.table),
            percent(lobe.model),
            percent(lobe.error)
        );
    }
    out.push_str("\n  to paste (absorption: the channels in order)\n");
    out.push_str(&match fit.model {
        Model::Chiang => words_of_shaders(fit),
        Model::DoubleCylinder => String::new(),
    });
    out.push_str(&option_of_render(fit));
    out
}

fn meaning(name: &str) -> &'static str {
    match name {
        "eta" => "index of refraction",
        "beta_m" => "longitudinal roughness",
        "beta_n" => "azimuthal roughness",
        "alpha_deg" => "tilt of the scales, degrees: R leaves toward the root by twice as much",
        "layers" => "layers of the cuticle",
        "kappa" => "radius of the medulla over that of the fiber",
        "sigma_m_s" => "scattering of the medulla per radius",
        "beta_m_s" => "longitudinal roughness of the light scattered on",
        "rho_s" => "azimuthal mean cosine of the light scattered on about straight through",
        "back_s" => "share of the scattered light that goes back",
        "beta_m_b" => "longitudinal roughness of the light scattered back",
        "rho_b" => "azimuthal mean cosine of the light scattered back about straight back",
        "path_s" => "path of the scattered light in the cortex, radii",
        _ => "",
    }
}

/// Absorption of three channels.
fn absorption(fit: &Fit) -> [f64; 3] {
    std::array::from_fn(|c| fit.absorption[c.min(fit.absorption.len() - 1)])
}

/// The same in the words of shaders that have Chiang's model.
fn words_of_shaders(fit: &Fit) -> String {
    let of = |name: &str| fit.parameter(name).unwrap_or_default();
    let (eta, m, n, alpha) = (of("eta"), of("beta_m"), of("beta_n"), of("alpha_deg"));
    let [r, g, b] = absorption(fit);
    format!(
        "  pbrt             Material \"hair\" \"rgb sigma_a\" [{r:.4} {g:.4} {b:.4}] \"float eta\" {eta:.4} \
         \"float beta_m\" {m:.4} \"float beta_n\" {n:.4} \"float alpha\" {alpha:.3}\n\
         \x20 Mitsuba 3 hair   sigma_a {r:.4} {g:.4} {b:.4}, int_ior {eta:.4}, longitudinal_roughness {m:.4}, \
         azimuthal_roughness {n:.4}, scale_tilt {alpha:.3}\n\
         \x20 Principled Hair  Chiang, absorption coefficient {r:.4} {g:.4} {b:.4}, roughness {m:.4}, radial roughness \
         {n:.4}, coat 0, IOR {eta:.4}, offset {alpha:.3} degrees\n"
    )
}

/// The same as options of `vair render`.
fn option_of_render(fit: &Fit) -> String {
    let model = fit.model.name();
    let [r, g, b] = absorption(fit);
    let mut out =
        format!("  vair render      --model {model} --{model} sigma_a={r:.4}:{g:.4}:{b:.4}");
    for (name, value) in &fit.shared {
        let _ = write!(out, ",{}={value:.4}", name.trim_end_matches("_deg"));
    }
    out + "\n"
}
