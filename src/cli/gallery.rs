//! `vair gallery`: the library in pictures.

use super::cache;
use super::species::field_guide;
use super::{Console, Failure, check_output};
use crate::blame::Blame;
use crate::gallery::{
    self, Column, GalleryError, Page, Quality, ROW_HEIGHTS, Row, Studio, pictures_of,
};
use crate::image::Canvas;
use crate::io::AtomicFile;
use crate::micrograph::Legend;
use crate::progress::Progress as _;
use crate::species::{self, Origins, Species};
use std::path::{Path, PathBuf};

/// Arguments of `vair gallery`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair gallery -o sheet.png
  vair gallery --species cat,lynx,bobcat --columns sem,light,section --row-height 300 -o cats.png
  vair gallery --quality full --pages docs/library
  vair gallery --coats 6 --row-height 300 -o coats.png")]
pub(super) struct Args {
    /// Which animals, built-in names or paths of species files; all built-in ones if not given.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    species: Vec<String>,
    /// How much work goes into the pictures.
    #[arg(long, value_enum, default_value = "preview")]
    quality: QualityArg,
    /// What a row of the sheet shows; of the pages, which pictures are drawn if they are there already.
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "sem,light,cutaway,lobe,swatch"
    )]
    columns: Vec<ColumnArg>,
    /// Instead of the library: so many of the built-in coats on the built-in body.
    #[arg(long, value_name = "COUNT", value_parser = parse_coats, conflicts_with_all = ["species", "columns", "pages"])]
    coats: Option<usize>,
    /// Height of the sheet's pictures, pixels.
    #[arg(long, default_value_t = 144)]
    row_height: usize,
    /// Do not use or fill the cache of baked tables.
    #[arg(long)]
    no_cache: bool,
    /// Threads; all cores if not given. The pictures do not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Writes the library as Markdown into this folder: an index, a page an animal, small pictures.
    /// Pages of other built-in animals that are there stay, and stay in the index.
    #[arg(long, value_name = "FOLDER")]
    pages: Option<PathBuf>,
    /// Where the contact sheet goes: a .png file. May repeat.
    #[arg(long, short)]
    output: Vec<PathBuf>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum QualityArg {
    /// About fifteen seconds an animal on two cores.
    Preview,
    /// About two minutes an animal on two cores.
    Full,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ColumnArg {
    /// Scales under the electron microscope.
    Sem,
    /// Transmitted light.
    Light,
    /// Cross-section.
    Section,
    /// The fiber without its front quarter.
    Cutaway,
    /// Where one hair sends light.
    Lobe,
    /// A piece of fur.
    Swatch,
}

impl From<ColumnArg> for Column {
    fn from(column: ColumnArg) -> Self {
        match column {
            ColumnArg::Sem => Self::Sem,
            ColumnArg::Light => Self::Light,
            ColumnArg::Section => Self::Section,
            ColumnArg::Cutaway => Self::Cutaway,
            ColumnArg::Lobe => Self::Lobe,
            ColumnArg::Swatch => Self::Swatch,
        }
    }
}

/// How many coats the sheet shows.
fn parse_coats(text: &str) -> Result<usize, String> {
    let most = gallery::COATS.len();
    match text.parse() {
        Ok(count) if (1..=most).contains(&count) => Ok(count),
        _ => Err(format!("must be 1 to {most}, as many as there are coats")),
    }
}

/// Colors of the palette of a page's picture: 64 show no steps in fur and keratin.
const PAGE_COLORS: usize = 64;

/// Runs the command.
///
/// # Errors
/// An animal that is not known or cannot be drawn, a place that cannot be written, or stopped.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    super::with_threads(args.threads, || run_here(args, console))?
}

fn run_here(args: &Args, console: &Console) -> Result<(), Failure> {
    let refuse = |message: String| Err(Failure::new(Blame::Input, message));
    if args.output.is_empty() && args.pages.is_none() {
        return refuse("nothing to do: neither --output nor --pages is given".to_owned());
    }
    if !ROW_HEIGHTS.contains(&args.row_height) {
        let (lo, hi) = (ROW_HEIGHTS.start(), ROW_HEIGHTS.end());
        return refuse(format!(
            "--row-height is {}, must be {lo} to {hi} pixels",
            args.row_height
        ));
    }
    for path in &args.output {
        check_output(path, "a sheet", "png")?;
    }
    let cache = cache::of_user(args.no_cache, console);
    let work = Work {
        args,
        console,
        studio: Studio {
            quality: match args.quality {
                QualityArg::Preview => Quality::PREVIEW,
                QualityArg::Full => Quality::FULL,
            },
            cache: cache.as_ref(),
            cancel: console.cancel(),
        },
    };
    if let Some(count) = args.coats {
        let sheet = gallery::coats_sheet(&work.studio, count, args.row_height, console);
        let sheet = sheet.map_err(|error| Failure::new(error.blame(), error))?;
        for path in &args.output {
            sheet.write_png(path)?;
        }
        return Ok(());
    }
    let mut animals = Vec::new();
    let all: Vec<String> = species::ids().map(str::to_owned).collect();
    let names = if args.species.is_empty() {
        &all
    } else {
        &args.species
    };
    for name in names {
        animals.push(species::load_with_origins(name.trim(), &[])?);
    }
    let mut refused = Vec::new();
    if !args.output.is_empty() {
        work.sheet(&animals, &mut refused)?;
    }
    if let Some(folder) = &args.pages {
        work.pages(folder, &animals, &mut refused)?;
    }
    match refused.into_iter().next() {
        Some(failure) => Err(failure),
        None => Ok(()),
    }
}

struct Work<'a> {
    args: &'a Args,
    console: &'a Console,
    studio: Studio<'a>,
}

impl Work<'_> {
    /// The contact sheet. What cannot be drawn is said in its place, on the terminal and in `refused`.
    fn sheet(
        &self,
        animals: &[(Species, Origins)],
        refused: &mut Vec<Failure>,
    ) -> Result<(), Failure> {
        let columns: Vec<Column> = self.args.columns.iter().map(|&c| c.into()).collect();
        let height = self.args.row_height;
        let count = animals.len() * columns.len();
        self.console.begin("gallery", count as u64, "pictures");
        let mut rows = Vec::new();
        'animals: for (species, _) in animals {
            self.console.note(&species.name);
            let mut pictures = Vec::new();
            for &column in &columns {
                let size = gallery::picture_size(column, height);
                let class = &species.classes[0];
                let picture = self
                    .studio
                    .picture(column, species, class, size, Legend::Bar);
                if self.stopped(&picture) {
                    break 'animals;
                }
                pictures.push(picture.map_err(|error| {
                    let why = error.to_string();
                    refused.push(self.refusal(species, column, error));
                    why
                }));
                self.console.advance(1);
            }
            rows.push(Row { species, pictures });
        }
        self.console.finish();
        let stopped = rows.len() < animals.len();
        if rows.is_empty() {
            let message = "stopped before the first row was complete; nothing was written";
            return Err(Failure::new(Blame::Interrupted, message));
        }
        let sheet = gallery::sheet(&rows, &columns, height);
        for path in &self.args.output {
            sheet.write_png(path)?;
        }
        if stopped {
            let message = format!(
                "stopped; the sheet holds the first {} of {} animals",
                rows.len(),
                animals.len()
            );
            return Err(Failure::new(Blame::Interrupted, message));
        }
        for path in &self.args.output {
            self.console.say(format_args!("drawn: {}", path.display()));
        }
        Ok(())
    }

    /// The pages. An animal's page is written when its pictures are; the index at the end.
    fn pages(
        &self,
        folder: &Path,
        animals: &[(Species, Origins)],
        refused: &mut Vec<Failure>,
    ) -> Result<(), Failure> {
        let images = folder.join("images");
        std::fs::create_dir_all(&images).map_err(|error| {
            let message = format!("cannot make {}: {error}", images.display());
            Failure::new(Blame::Environment, message)
        })?;
        let count: usize = animals.iter().map(|(s, _)| pictures_of(s).len()).sum();
        self.console.begin("pages", count as u64, "pictures");
        let mut done = 0;
        let wanted: Vec<Column> = self.args.columns.iter().map(|&c| c.into()).collect();
        'animals: for (species, origins) in animals {
            self.console.note(&species.name);
            for picture in pictures_of(species) {
                let (column, size) = (picture.column, picture.size());
                let path = images.join(picture.file(species));
                if !wanted.contains(&column) && path.exists() {
                    self.console.advance(1);
                    continue;
                }
                let drawn = self
                    .studio
                    .picture(column, species, picture.class, size, Legend::Bar);
                if self.stopped(&drawn) {
                    break 'animals;
                }
                match drawn {
                    Ok(canvas) => {
                        canvas.write_small_png(&path, PAGE_COLORS)?;
                    }
                    Err(error) => refused.push(self.refusal(species, column, error)),
                }
                self.console.advance(1);
            }
            let page = Page {
                species,
                origins,
                guide: &field_guide(species, origins),
            };
            let path = folder.join(format!("{}.md", species.id));
            AtomicFile::write_all_to(&path, gallery::page(&page).as_bytes())?;
            done += 1;
        }
        self.console.finish();
        let mut finished: Vec<&Species> = animals[..done].iter().map(|(s, _)| s).collect();
        let others = others(folder, &finished)?;
        finished.extend(&others);
        let order: Vec<&str> = species::ids().collect();
        finished.sort_by_key(|s| order.iter().position(|id| *id == s.id));
        let index = gallery::index(&finished, &self.command(folder, others.is_empty()));
        AtomicFile::write_all_to(&folder.join("README.md"), index.as_bytes())?;
        if done < animals.len() {
            let message = format!("stopped; {done} of {} pages are there", animals.len());
            return Err(Failure::new(Blame::Interrupted, message));
        }
        Ok(())
    }

    fn stopped(&self, picture: &Result<Canvas, GalleryError>) -> bool {
        picture.is_err() && self.studio.cancel.is_cancelled()
    }

    fn refusal(&self, species: &Species, column: Column, error: GalleryError) -> Failure {
        let message = format!("{}, {}: {error}", species.id, column.name());
        self.console.say(format!("warning: {message}"));
        Failure::new(error.blame(), message)
    }

    /// The command line that writes the pages again.
    fn command(&self, folder: &Path, these_alone: bool) -> String {
        let mut command = "vair gallery".to_owned();
        if !self.args.species.is_empty() && these_alone {
            command += &format!(" --species {}", self.args.species.join(","));
        }
        if matches!(self.args.quality, QualityArg::Full) {
            command += " --quality full";
        }
        format!("{command} --pages {}", folder.display())
    }
}

/// The built-in animals that have a page in a folder, others than some.
fn others(folder: &Path, than: &[&Species]) -> Result<Vec<Species>, Failure> {
    let has_page =
        |id: &&str| than.iter().all(|s| s.id != *id) && folder.join(format!("{id}.md")).exists();
    let load = |id: &str| Ok(species::load(id, &[])?);
    species::ids().filter(has_page).map(load).collect()
}
