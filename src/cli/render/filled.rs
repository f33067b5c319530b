//! Arguments filled with what a scene file says where the command line says nothing.

use super::args::{Args, FilterArg, SamplerArg};
use crate::cli::{Failure, named};
use crate::scene_file::SceneFile;

impl Args {
    /// These arguments, with those of the scene file if it is one that they name.
    ///
    /// # Errors
    /// Everything that is wrong with the file.
    pub(super) fn filled(&self) -> Result<Self, Failure> {
        let mut args = self.clone();
        let Some(file) = SceneFile::read(&self.name)? else {
            return Ok(args);
        };
        args.name = file.species;
        if args.coat.is_none() {
            or(&mut args.color, file.color);
        }
        or(&mut args.coat, file.coat);
        // The command line's come last and win.
        args.set = [file.set, args.set].concat();
        args.on.fill(file.skin, file.skin_units, file.skin_up);
        or(&mut args.strands, file.strands);
        or(&mut args.seed, file.seed);
        or(&mut args.env, file.env);
        or(&mut args.env_turn, file.env_turn);
        args.env_visible |= file.env_visible.unwrap_or(false);
        args.no_ground |= !file.ground.unwrap_or(true);
        or(&mut args.view, file.view);
        or(&mut args.fov, file.fov);
        or(&mut args.zoom, file.zoom);
        or(&mut args.shift, file.shift);
        or(&mut args.lens, file.lens);
        or(&mut args.focus, file.focus);
        or(&mut args.res, file.res);
        if args.samples.is_none() {
            or(&mut args.spp, file.spp);
        }
        or(&mut args.sampler, file.sampler.and_then(named));
        or(&mut args.filter, file.filter.and_then(named));
        args.look.fill(file.look, file.exposure);
        args.lamps = file.lamps;
        Ok(args)
    }
}

/// What holds where neither command line nor file says anything.
impl Args {
    pub(super) fn env(&self) -> &str {
        self.env.as_deref().unwrap_or("studio")
    }

    pub(super) fn env_turn(&self) -> f32 {
        self.env_turn.unwrap_or(0.0)
    }

    pub(super) fn res(&self) -> [u32; 2] {
        self.res.unwrap_or([640, 480])
    }

    pub(super) fn sampler(&self) -> SamplerArg {
        self.sampler.unwrap_or(SamplerArg::Qsir)
    }

    pub(super) fn filter(&self) -> FilterArg {
        self.filter.unwrap_or(FilterArg::Gaussian)
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed.unwrap_or(0)
    }
}

fn or<T>(given: &mut Option<T>, filed: Option<T>) {
    if given.is_none() {
        *given = filed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, Command};
    use crate::scene_file::SCENE;
    use crate::species::shape::Kind;

    fn filled(words: &[&str]) -> Args {
        let words = ["vair", "render"]
            .iter()
            .chain(words)
            .chain(&["-o", "a.png"]);
        match Cli::from_words(words).unwrap().command {
            Command::Render(args) => args.filled().unwrap(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_command_line_goes_before_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        let text = "species = \"mink\"\nseed = 3\nzoom = 2\nskin = \"ball\"\nset = [\"a=1\"]\nspp = 5\nground = false\nlook = \"srgb\"\ncoat = \"zebra\"\ncolor = [0.5, 0.2, 0.1]";
        std::fs::write(&path, text).unwrap();
        let name = path.to_str().unwrap();
        let args = filled(&[name]);
        assert_eq!((args.name.as_str(), args.on.name()), ("mink", "ball"));
        assert_eq!((args.seed(), args.zoom, args.spp), (3, Some(2.0), Some(5)));
        assert!(args.no_ground);
        assert_eq!(args.color, Some([0.5, 0.2, 0.1]));
        assert_eq!(
            filled(&[name, "--color", "0,1,0"]).color,
            Some([0.0, 1.0, 0.0])
        );
        let spotted = filled(&[name, "--coat", "leopard"]);
        assert_eq!(
            (spotted.coat.as_deref(), spotted.color),
            (Some("leopard"), None)
        );
        let args = filled(&[
            name,
            "--seed",
            "0",
            "--skin",
            "tress",
            "--set",
            "b=2",
            "--samples",
            "0..2",
        ]);
        assert_eq!((args.seed(), args.on.name(), args.spp), (0, "tress", None));
        assert_eq!(args.set, ["a=1", "b=2"]);
        let plain = filled(&["mink"]);
        assert_eq!(
            (plain.res(), plain.env(), plain.seed()),
            ([640, 480], "studio", 0)
        );
    }

    #[test]
    fn words_of_scene_files_are_choices_of_the_command() {
        for key in ["sampler", "filter", "look", "skin_units", "skin_up"] {
            let Some(Kind::Choice(choices)) = SCENE.field(key).map(|f| &f.kind) else {
                panic!("{key}");
            };
            for choice in *choices {
                let option = format!("--{}", key.replace('_', "-"));
                filled(&["mink", &option, choice.name]);
            }
        }
    }
}
