//! `vair figure`: several pictures on one sheet, from a recipe of `vair` commands.

use super::check_output;
use super::{Cli, Command, Console, Failure};
use crate::blame::Blame;
use crate::image::{Canvas, GLYPH_HEIGHT};
use crate::io::{FileError, read_bounded};
use glam::{Vec2, Vec3};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Arguments of `vair figure`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair figure furs -o furs.png                        # Figure 1 of the paper: two synthetic furs and closeups
  vair figure lobes -o lobes.png                      # Figure 4: scattering functions at 45 degrees
  vair figure tress -o tress.png                      # Figure 5: human hair
  vair figure medullae -o medullae.png                # one animal with three medullae, all else equal
  vair figure models -o models.png                    # one animal by tables and by hair models fitted to them
  vair figure furs --quality full --panels furs -o furs.png
  vair figure my-figure.toml -o mine.png              # a recipe of yours; --print shows one to begin with")]
pub(super) struct Args {
    /// A built-in figure (furs, lobes, tress, medullae, models) or the path of a recipe.
    name: String,
    /// How much work goes into it.
    #[arg(long, value_enum, default_value = "draft")]
    quality: QualityArg,
    /// Prints the recipe instead, to be edited.
    #[arg(long)]
    print: bool,
    /// Also leaves the panels in this folder, by themselves; rendered ones as EXR too.
    #[arg(long, value_name = "FOLDER")]
    panels: Option<PathBuf>,
    /// Threads; all cores if not given. The picture does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Where the sheet goes: a .png file.
    #[arg(long, short, required_unless_present = "print")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum QualityArg {
    /// Small: one to some minutes, most of it for tables that are baked once and for fits.
    Draft,
    /// As the recipe has it for print.
    Full,
}

/// Recipes by name.
const FIGURES: [(&str, &str); 5] = [
    ("furs", include_str!("../../procedural/figures/furs.toml")),
    ("lobes", include_str!("../../procedural/figures/lobes.toml")),
    ("tress", include_str!("../../procedural/figures/tress.toml")),
    (
        "medullae",
        include_str!("../../procedural/figures/medullae.toml"),
    ),
    (
        "models",
        include_str!("../../procedural/figures/models.toml"),
    ),
];

/// A figure as a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Recipe {
    title: String,
    /// Panels side by side.
    columns: usize,
    /// Of each rendered panel, pixels.
    size: [u32; 2],
    draft: Quality,
    full: Quality,
    panels: Vec<Panel>,
}

/// Words that are added to commands.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Quality {
    /// Of the size.
    scale: f64,
    #[serde(default)]
    render: String,
    #[serde(default)]
    bake: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Panel {
    label: String,
    /// Commands of vair one after the other, without program and output; the last one draws. FOLDER is where
    /// files can be handed on.
    commands: Vec<String>,
}

/// Largest recipe, bytes.
const RECIPE_LIMIT: u64 = 1 << 20;
/// Most panels.
const PANEL_LIMIT: usize = 64;

const PAPER: Vec3 = Vec3::new(0.965, 0.96, 0.95);
const INK: Vec3 = Vec3::new(0.12, 0.13, 0.15);

/// Runs the command.
///
/// # Errors
/// A recipe that cannot be used, anything that one of its commands refuses, a place that cannot be written.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    super::with_threads(args.threads, || run_here(args, console))?
}

fn run_here(args: &Args, console: &Console) -> Result<(), Failure> {
    let text = recipe_text(&args.name)?;
    let Some(output) = args.output.as_deref().filter(|_| !args.print) else {
        return super::stdout::print(&text);
    };
    let recipe = read(&args.name, &text)?;
    check_output(output, "a sheet", "png")?;
    let scratch = tempfile::tempdir()
        .map_err(|e| FileError::new("create a folder in", &std::env::temp_dir(), e))?;
    let folder = args.panels.as_deref().unwrap_or(scratch.path());
    // All that can be refused is refused before any work.
    let quality = match args.quality {
        QualityArg::Draft => &recipe.draft,
        QualityArg::Full => &recipe.full,
    };
    let panels: Vec<Vec<Command>> = (0..recipe.panels.len())
        .map(|i| recipe.commands(i, quality, folder, args.panels.is_some()))
        .collect::<Result<_, String>>()
        .map_err(|e| Failure::new(Blame::Input, format!("{}: {e}", args.name)))?;
    if let Some(folder) = &args.panels {
        std::fs::create_dir_all(folder).map_err(|e| FileError::new("create", folder, e))?;
    }
    let mut pictures = Vec::with_capacity(panels.len());
    for (i, (panel, commands)) in recipe.panels.iter().zip(panels).enumerate() {
        console.say(format!(
            "panel {} of {}: {}",
            i + 1,
            recipe.panels.len(),
            panel.label
        ));
        for command in commands {
            super::dispatch(command, console).map_err(|failure| match failure.blame {
                // What a panel had so far goes with the scratch folder.
                Blame::Interrupted if args.panels.is_none() => {
                    let help = "--panels FOLDER keeps the panels that are done";
                    Failure::with_help(Blame::Interrupted, "stopped; no sheet was written", help)
                }
                _ => failure,
            })?;
        }
        pictures.push(Canvas::read_png(&panel_path(folder, i, "png"))?);
    }
    sheet(&recipe, &pictures).write_png(output)?;
    console.say(format_args!("drawn: {}", output.display()));
    Ok(())
}

fn recipe_text(name: &str) -> Result<String, Failure> {
    if let Some((_, text)) = FIGURES.iter().find(|(known, _)| *known == name) {
        return Ok((*text).to_owned());
    }
    if !name.ends_with(".toml") {
        let names: Vec<&str> = FIGURES.iter().map(|(name, _)| *name).collect();
        let message = format!("there is no figure {name:?}");
        let help = format!(
            "take one of {}, or the path of a .toml file",
            names.join(", ")
        );
        return Err(Failure::with_help(Blame::Input, message, help));
    }
    let bytes = read_bounded(Path::new(name), RECIPE_LIMIT)?;
    String::from_utf8(bytes).map_err(|e| Failure::new(Blame::Input, format!("{name}: {e}")))
}

fn read(name: &str, text: &str) -> Result<Recipe, Failure> {
    let refuse = |what: String| Failure::new(Blame::Input, format!("{name}: {what}"));
    // The message of the parser shows line and place.
    let recipe: Recipe = toml::from_str(text).map_err(|e| refuse(e.to_string()))?;
    let count = recipe.panels.len();
    if !(1..=PANEL_LIMIT).contains(&count) {
        return Err(refuse(format!(
            "it has {count} panels, must have 1 to {PANEL_LIMIT}"
        )));
    }
    if !(1..=PANEL_LIMIT).contains(&recipe.columns) {
        return Err(refuse(format!(
            "`columns` is {}, must be 1 to {PANEL_LIMIT}",
            recipe.columns
        )));
    }
    for (key, quality) in [("draft", &recipe.draft), ("full", &recipe.full)] {
        if !(0.01..=4.0).contains(&quality.scale) {
            return Err(refuse(format!(
                "`{key}.scale` is {}, must be 0.01 to 4",
                quality.scale
            )));
        }
    }
    Ok(recipe)
}

/// Where a panel's picture is.
fn panel_path(folder: &Path, index: usize, ending: &str) -> PathBuf {
    folder.join(format!("{}.{ending}", index + 1))
}

impl Recipe {
    /// The commands of a panel, whole.
    fn commands(
        &self,
        index: usize,
        quality: &Quality,
        folder: &Path,
        keep: bool,
    ) -> Result<Vec<Command>, String> {
        let panel = &self.panels[index];
        let mut commands = Vec::with_capacity(panel.commands.len());
        for (i, line) in panel.commands.iter().enumerate() {
            let of = |e: String| format!("panel {} ({}): `{line}`: {e}", index + 1, panel.label);
            let verb = line.split_whitespace().next().unwrap_or("");
            let more = match verb {
                "render" => &quality.render,
                "bake" => &quality.bake,
                "table" | "fiber" | "gallery" => "",
                _ => {
                    return Err(of(
                        "only render, bake, table, fiber and gallery draw panels".into(),
                    ));
                }
            };
            let what = line.split_whitespace().nth(1).unwrap_or("");
            let draws = match verb {
                "bake" => false,
                "table" => matches!(what, "plot" | "compare"),
                _ => true,
            };
            if i + 1 == panel.commands.len() && !draws {
                return Err(of("the last command of a panel has to draw it".into()));
            }
            let folder_text = folder.to_string_lossy();
            let words = line.split_whitespace().chain(more.split_whitespace());
            let mut words: Vec<String> = std::iter::once("vair".to_owned())
                .chain(words.map(|word| word.replace("FOLDER", &folder_text)))
                .collect();
            let mut output = |ending| {
                let path = panel_path(folder, index, ending);
                words.extend(["-o".to_owned(), path.to_string_lossy().into_owned()]);
            };
            if i + 1 == panel.commands.len() {
                output("png");
                if verb == "render" && keep {
                    output("exr");
                }
            }
            if verb == "render" {
                let [width, height] = self.size.map(|n| (f64::from(n) * quality.scale).round());
                words.extend(["--res".to_owned(), format!("{width}x{height}")]);
            }
            let cli = Cli::from_words(words).map_err(|e| of(e.to_string()))?;
            commands.push(cli.command);
        }
        match commands.is_empty() {
            true => Err(format!(
                "panel {} ({}) has no command",
                index + 1,
                panel.label
            )),
            false => Ok(commands),
        }
    }
}

/// Panels in rows with their labels below, under the title.
fn sheet(recipe: &Recipe, pictures: &[Canvas]) -> Canvas {
    let columns = recipe.columns.min(pictures.len());
    let rows = pictures.len().div_ceil(columns);
    let width = pictures.iter().map(Canvas::width).max().unwrap_or(1);
    let height = pictures.iter().map(Canvas::height).max().unwrap_or(1);
    let text = (height as f32 / 220.0).floor().max(1.0);
    let line = (2.0 * GLYPH_HEIGHT * text) as usize;
    let gap = line / 2;
    let mut sheet = Canvas::new(
        gap + columns * (width + gap),
        2 * line + rows * (height + line),
        PAPER,
    );
    let place = |x: usize, y: usize| Vec2::new(x as f32, y as f32 + 0.5 * GLYPH_HEIGHT * text);
    sheet.text(place(gap, gap), &recipe.title, 1.5 * text, INK);
    for (i, (panel, picture)) in recipe.panels.iter().zip(pictures).enumerate() {
        let x = gap + i % columns * (width + gap);
        let y = 2 * line + i / columns * (height + line);
        sheet.paste(picture, x, y);
        sheet.text(place(x, y + height), &panel.label, text, INK);
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_recipes_are_read_and_their_commands_parse_at_both_qualities() {
        for (name, text) in FIGURES {
            let recipe = read(name, text).unwrap();
            for quality in [&recipe.draft, &recipe.full] {
                for i in 0..recipe.panels.len() {
                    let folder = Path::new("a folder");
                    let commands = recipe.commands(i, quality, folder, true).unwrap();
                    assert_eq!(commands.len(), recipe.panels[i].commands.len(), "{name}");
                }
            }
        }
    }

    #[test]
    fn what_is_wrong_with_a_recipe_is_said_with_its_place() {
        let with = |change: (&str, &str)| FIGURES[0].1.replace(change.0, change.1);
        let refused = |text: &str| format!("{:?}", read("my.toml", text).unwrap_err().report);
        let typo = refused(&with(("columns = 2", "colums = 2")));
        assert!(typo.contains("colums") && typo.contains("line 7"), "{typo}");
        let none = refused(&with(("columns = 2", "columns = 0")));
        assert!(none.contains("my.toml: `columns` is 0"), "{none}");
        for (command, complaint) in [
            ("export mink", "only render, bake"),
            ("render ember-lynx --zoom far", "invalid value 'far'"),
            ("figure furs", "only render, bake"),
            ("bake ember-lynx", "has to draw it"),
            ("table info FOLDER/a.exr", "has to draw it"),
        ] {
            let text = with(("render ember-lynx", command));
            let recipe = read("my.toml", &text).unwrap();
            let error = recipe.commands(0, &recipe.draft, Path::new("x"), false);
            let error = error.unwrap_err();
            assert!(error.starts_with("panel 1 (ember lynx): `"), "{error}");
            assert!(error.contains(complaint), "{error}");
        }
    }

    #[test]
    fn sheets_are_png() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_output(&folder.path().join("sheet.PNG"), "a sheet", "png").is_ok());
        let error = check_output(&folder.path().join("sheet.jpg"), "a sheet", "png").unwrap_err();
        let report = format!("{:?}", error.report);
        assert!(report.contains("must end in .png"), "{report}");
    }

    #[test]
    fn panels_stand_in_rows_of_so_many() {
        let recipe = read("furs", FIGURES[0].1).unwrap();
        let colors = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
        let panels = colors.map(|color| Canvas::new(60, 40, color));
        let sheet = sheet(&recipe, &panels);
        let found = |color| {
            let all = (0..sheet.height()).flat_map(|y| (0..sheet.width()).map(move |x| (x, y)));
            let at: Vec<_> = all.filter(|&(x, y)| sheet.get(x, y) == color).collect();
            assert_eq!(at.len(), 60 * 40);
            at[0]
        };
        let [a, b, c, d] = colors.map(found);
        assert!(
            a.1 == b.1 && c.1 == d.1 && a.0 == c.0 && b.0 == d.0,
            "{a:?} {b:?} {c:?} {d:?}"
        );
        assert!(b.0 > a.0 + 60 && c.1 > a.1 + 40);
    }
}
