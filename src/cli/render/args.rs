//! Arguments of `vair render`.

use super::{live, output, parse};
use crate::bsdf::{ChiangParameters, DoubleCylinderParameters};
use crate::cli::bake::{parse_count, parse_share, parse_time};
use crate::cli::color;
use crate::cli::skin::SkinArgs;
use crate::render::Crop;
use crate::scene::Lamp;
use std::path::PathBuf;
use std::time::Duration;

/// The arguments.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  vair render red-fox -o red-fox.png
  vair render polar-bear --env sky --res 1280x720 --spp 128 -o bear.png -o bear.exr
  vair render harbor-seal --azimuths 8 -o seal.png
  vair render red-fox --table guard-small.exr --table under-small.exr -o fox.png
  vair render red-fox --model double-cylinder-fit -o shader.png
  vair render cat --coat leopard -o leopard.png
  vair render alpaca --color '#c8642a' -o rusty.png
  vair render mink --skin sofa.obj --strands 1e6 -o sofa.png
  vair render examples/scenes/fox-by-a-window.toml --res 1280x720 -o window.png
  vair render red-fox --crop 453,98,64,64 --spp 256 -o eye.exr")]
pub(in crate::cli) struct Args {
    /// A built-in species, a path to a species file, or a scene file, whose keys are options of this command.
    pub(super) name: String,
    /// Pattern of the coat: tabby, leopard, zebra, badger, fox, cow, countershaded, siamese,
    /// tortoiseshell, the path of a recipe, or none; if not given, that of the species.
    #[arg(long, value_name = "NAME")]
    pub(super) coat: Option<String>,
    #[arg(long, value_name = "COLOR", value_parser = color::parse, conflicts_with = "coat", help = color::HELP)]
    pub(super) color: Option<[f64; 3]>,
    #[command(flatten)]
    pub(super) on: SkinArgs,
    /// The light: studio, sky, white, black, or a latitude-longitude EXR or HDR file; studio if not given.
    #[arg(long)]
    pub(super) env: Option<String>,
    /// Turns the light about the vertical, degrees.
    #[arg(long)]
    pub(super) env_turn: Option<f32>,
    /// Shows the environment behind the subject instead of a backdrop.
    #[arg(long)]
    pub(super) env_visible: bool,
    /// Width and height of the picture; 640x480 if not given.
    #[arg(long, value_parser = parse::size)]
    pub(super) res: Option<[u32; 2]>,
    /// Samples a pixel; 32 if not given.
    #[arg(long)]
    pub(super) spp: Option<u32>,
    /// Renders only these samples of every pixel, from the first to one before the last: `0..64`. Ranges
    /// written to .safetensors files are put together by `vair merge`, to the bit what one run gives.
    #[arg(long, value_parser = parse::samples, value_name = "A..B", conflicts_with_all = ["spp", "target_error"])]
    pub(super) samples: Option<[u32; 2]>,
    /// Ends tile by tile where the noise is below this share of the tile's light, such as 5%; `--spp` is the
    /// most samples then, and 4096 if it is not given.
    #[arg(long, value_name = "ERROR", value_parser = parse_share)]
    pub(super) target_error: Option<f64>,
    /// Saves all samples to this file now and then and when stopped, and goes on from it if it is there. It
    /// goes when the picture is done.
    #[arg(long, value_name = "FILE")]
    pub(super) checkpoint: Option<PathBuf>,
    /// Time between two saves of the checkpoint.
    #[arg(long, value_name = "TIME", default_value = "30s", value_parser = parse_time)]
    pub(super) checkpoint_every: Duration,
    /// Shows the picture while it is made in tev (github.com/Tom94/tev), which has to run already: where it listens.
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true, default_missing_value = live::TEV)]
    pub(super) tev: Option<String>,
    /// Renders only a part of the frame, with the same pixels: x,y,width,height.
    #[arg(long, value_parser = parse::crop)]
    pub(super) crop: Option<Crop>,
    /// Stops after this time with the samples there are, such as 90s or 5m.
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    pub(super) time: Option<Duration>,
    /// How directions are drawn; all give the same picture. qsir if not given.
    #[arg(long, value_enum)]
    pub(super) sampler: Option<SamplerArg>,
    /// How samples spread over and around their pixel; gaussian if not given.
    #[arg(long, value_enum)]
    pub(super) filter: Option<FilterArg>,
    /// Adds mattes by name to the EXR: hair classes and zones of the coat, skin and ground, after Cryptomatte.
    #[arg(long)]
    pub(super) cryptomatte: bool,
    /// What scatters light: the baked tables, a hair model with given numbers, or a hair model as near to the
    /// tables as it comes.
    #[arg(long, value_enum, default_value = "table")]
    pub(super) model: ModelArg,
    /// Numbers of `--model chiang`; absorption is per radius.
    #[arg(
        long,
        value_parser = parse::chiang,
        value_name = "KEY=VALUE,..",
        default_value = "sigma_a=0.06:0.10:0.20,beta_m=0.3,beta_n=0.3,alpha=2,eta=1.55",
        allow_hyphen_values = true
    )]
    pub(super) chiang: ChiangParameters,
    /// Numbers of `--model double-cylinder`, of which others than these may be left out; absorption is that of the
    /// cortex, per radius of the strand, and so is scattering in the medulla. `vair table fit` prints them.
    #[arg(
        long,
        value_parser = parse::double_cylinder,
        value_name = "KEY=VALUE,..",
        default_value = DOUBLE_CYLINDER,
        allow_hyphen_values = true
    )]
    pub(super) double_cylinder: DoubleCylinderParameters,
    /// Also writes strands, skin, light and camera to this folder as a scene for Mitsuba 3; needs
    /// `--model chiang`.
    #[arg(long, value_name = "FOLDER")]
    pub(super) mitsuba: Option<PathBuf>,
    /// Strands in all; if not given, as many as the animal has, at most 250000. Fewer are wider, to cover
    /// as much: see `keep_widths` of a species.
    #[arg(long, value_parser = parse_count)]
    pub(super) strands: Option<u64>,
    /// Photons for each scattering table that has to be baked.
    #[arg(long, value_parser = parse_count, default_value = "3e6")]
    pub(super) bake_photons: u64,
    /// Tell so many azimuths of flat hairs apart: they glint as they turn. The photons are then those of
    /// each. 1 averages over azimuths.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) azimuths: usize,
    /// A table to use instead of baking, packed or not: for the stations of its hair class. May repeat.
    #[arg(long, value_name = "FILE")]
    pub(super) table: Vec<PathBuf>,
    /// Camera: degrees around the subject (0 is +Z, 90 is +X) and above it; if not given, the side from
    /// which the skin looks best.
    #[arg(long, value_parser = parse::pair, value_name = "YAW,PITCH", allow_hyphen_values = true)]
    pub(super) view: Option<[f32; 2]>,
    /// Field of view along the shorter side, degrees.
    #[arg(long)]
    pub(super) fov: Option<f32>,
    /// 1 frames the subject, 2 shows half of it.
    #[arg(long)]
    pub(super) zoom: Option<f32>,
    /// Shifts the camera across and up, in radii of the subject.
    #[arg(long, value_parser = parse::pair, value_name = "X,Y", allow_hyphen_values = true)]
    pub(super) shift: Option<[f32; 2]>,
    /// Diameter of the lens, millimeters: what is not at the distance of `--focus` blurs. 0, a pinhole, if not
    /// given.
    #[arg(long, value_name = "MM")]
    pub(super) lens: Option<f32>,
    /// Distance from the camera that is sharp, millimeters; if not given, the nearest point of the subject.
    #[arg(long, value_name = "MM")]
    pub(super) focus: Option<f32>,
    /// Leaves out the floor.
    #[arg(long)]
    pub(super) no_ground: bool,
    #[command(flatten)]
    pub(super) look: output::Look,
    /// Seed of fiber, fur and picture; 0 if not given.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Another seed for the noise of the picture alone.
    #[arg(long, value_name = "SEED")]
    pub(super) picture_seed: Option<u64>,
    /// Writes times, rays and memory to this JSON file.
    #[arg(long, value_name = "FILE")]
    pub(super) stats: Option<PathBuf>,
    /// Threads; all cores if not given. The picture does not depend on it.
    #[arg(long)]
    pub(super) threads: Option<usize>,
    /// Override a field of the species: `guard.pigment.0.eumelanin=2`. May repeat.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Bake even if the cache holds the tables, and do not store them there.
    #[arg(long)]
    pub(super) no_cache: bool,
    /// Where the picture goes: .png or .exr, or .safetensors for its sums. May repeat.
    #[arg(long, short, required = true)]
    pub(super) output: Vec<PathBuf>,
    /// Lamps of the scene file, and whether the yaw of each counts from the camera.
    #[arg(skip)]
    pub(super) lamps: Vec<(Lamp, bool)>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum SamplerArg {
    /// Resampled products of scattering and environment.
    Qsir,
    /// Resampled products, one ray for direct and indirect light.
    QsirOneRay,
    /// The scattering table alone.
    Bsdf,
    /// The environment for direct light.
    Env,
    /// Both, by multiple importance sampling.
    Mis,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum FilterArg {
    /// A narrow Gaussian.
    Gaussian,
    /// Even over the pixel.
    Box,
    /// A tent of two pixels.
    Tent,
}

#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
pub(super) enum ModelArg {
    /// Photons baked into tables.
    Table,
    /// Chiang et al. 2016, the hair shader of Mitsuba, pbrt and Cycles, with the numbers of `--chiang`.
    Chiang,
    /// The same, fitted to the tables.
    ChiangFit,
    /// Cuticle, cortex and a medulla that scatters, after Yan et al. 2015, with the numbers of
    /// `--double-cylinder`.
    DoubleCylinder,
    /// The same, fitted to the tables.
    DoubleCylinderFit,
}

impl ModelArg {
    /// The option that gives its numbers, if they are given.
    pub(super) fn numbers(self) -> Option<&'static str> {
        match self {
            Self::Chiang => Some("--chiang"),
            Self::DoubleCylinder => Some("--double-cylinder"),
            Self::Table | Self::ChiangFit | Self::DoubleCylinderFit => None,
        }
    }
}

/// The usual numbers of a double cylinder.
pub(super) const DOUBLE_CYLINDER: &str = "sigma_a=0.06:0.10:0.20,beta_m=0.3,beta_n=0.3,alpha=2,eta=1.55,layers=0.5,\
     kappa=0.7,sigma_m_s=2,path_s=2,beta_m_s=0.6,rho_s=0.3,back_s=0.5,beta_m_b=0.6,rho_b=0.3";
