//! The library as Markdown: an index by family and a page an animal, with small pictures.

use super::Column;
use crate::fiber::Fiber;
use crate::micrograph::{Facts, Subject};
use crate::species::{HairClass, Origins, Species};
use std::fmt::Write as _;

/// A picture on a page.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// What it shows.
    pub column: Column,
    /// Of which class of hair.
    pub class: &'a HairClass,
}

impl Picture<'_> {
    /// Name of its file in the folder `images`.
    pub fn file(&self, species: &Species) -> String {
        match self.column {
            Column::Swatch => format!("{}-fur.png", species.id),
            column => format!("{}-{}-{}.png", species.id, self.class.name, column.name()),
        }
    }

    /// Its width and height, pixels: small, because there are hundreds.
    pub fn size(&self) -> (usize, usize) {
        let height = match self.column {
            Column::Swatch => 216,
            _ => 200,
        };
        let width = self.column.aspect() * height as f64;
        (width.round() as usize, height)
    }
}

/// The pictures of an animal's page, the fur first: micrographs of its first two classes of hair, the
/// lobe of the first.
pub fn pictures_of(species: &Species) -> Vec<Picture<'_>> {
    let first = &species.classes[0];
    let mut pictures = vec![
        Picture {
            column: Column::Swatch,
            class: first,
        },
        Picture {
            column: Column::Lobe,
            class: first,
        },
    ];
    for class in species.classes.iter().take(2) {
        let columns = [Column::Sem, Column::Light, Column::Cutaway];
        pictures.extend(columns.map(|column| Picture { column, class }));
    }
    pictures
}

/// What a page is made of.
pub struct Page<'a> {
    /// The animal.
    pub species: &'a Species,
    /// Where its numbers come from.
    pub origins: &'a Origins,
    /// What `vair species show` prints: sentences, then `NUMBERS`, then `SOURCES`.
    pub guide: &'a str,
}

/// An animal's page.
pub fn page(page: &Page) -> String {
    let species = page.species;
    let mut text = format!("# {}\n\n", species.name);
    if !species.latin.is_empty() {
        let _ = writeln!(text, "*{}*{}\n", species.latin, family(species));
    }
    let _ = writeln!(text, "{}\n", species.summary);
    let pictures = pictures_of(species);
    let shown = |column: Column, class: &HairClass| {
        let picture = pictures
            .iter()
            .find(|p| p.column == column && p.class.name == class.name);
        picture.map_or_else(String::new, |p| {
            let words = format!("{}, {} hair: {}", species.name, class.name, column.title());
            format!("![{words}](images/{})", p.file(species))
        })
    };
    let first = &species.classes[0];
    let _ = writeln!(
        text,
        "| the fur | one {} hair in light from 45\u{b0} toward its tip |\n|:-:|:-:|\n| {} | {} |\n",
        first.name,
        shown(Column::Swatch, first),
        shown(Column::Lobe, first)
    );
    for class in species.classes.iter().take(2) {
        let _ = writeln!(text, "## {} hair\n", capitalized(&class.name));
        let columns = [Column::Sem, Column::Light, Column::Cutaway];
        let cells = |f: &dyn Fn(Column) -> String| columns.map(f).join(" | ");
        let _ = writeln!(
            text,
            "| {} |\n|:-:|:-:|:-:|\n| {} |\n",
            cells(&|column| column.title().to_owned()),
            cells(&|column| shown(column, class))
        );
        for fact in facts(species, class) {
            let _ = writeln!(text, "- {fact}");
        }
        text.push('\n');
    }
    let before = |text: &str, heading: &str| match text.split_once(heading) {
        Some((before, after)) => (before.trim_end().to_owned(), after.to_owned()),
        None => (text.trim_end().to_owned(), String::new()),
    };
    let (sentences, rest) = before(page.guide, "\nNUMBERS\n");
    let (numbers, _) = before(&rest, "\nSOURCES\n");
    let _ = writeln!(
        text,
        "## Field guide\n\nAs `vair species show {}` prints it.\n\n```text\n{sentences}\n```\n\n\
         <details><summary>Every number, its unit and its source</summary>\n\n\
         ```text\n{numbers}\n```\n\n</details>\n",
        species.id
    );
    if !page.origins.references.is_empty() {
        text.push_str("## Sources\n\n");
        for reference in &page.origins.references {
            let _ = writeln!(text, "- **{}** {}", reference.key, reference.text);
        }
        text.push('\n');
    }
    text.push_str("[All animals](README.md)\n");
    text
}

/// What the pictures of a class show, in words.
fn facts(species: &Species, class: &HairClass) -> Vec<String> {
    let station = super::widest(class);
    let Ok(fiber) = Fiber::build(&station.structure, 0) else {
        return Vec::new();
    };
    let facts = Facts::of(&Subject {
        fiber: &fiber,
        species,
        class,
        station,
    });
    let place = format!("shown: {}", facts.place);
    vec![place, facts.size, facts.cuticle, facts.medulla]
}

/// The index: animals by family in the order given.
///
/// * `command`: the command line that writes the pages.
pub fn index(all: &[&Species], command: &str) -> String {
    let mut text = format!(
        "# The fur structure library\n\nEvery animal that is built in: its hair under the electron \
         microscope and in transmitted light, and its fur. The pictures show the widest part of the \
         hair, root left and tip right. Written by\n\n```sh\n{command}\n```\n"
    );
    let mut family = None;
    for species in all {
        let this = heading(species);
        if family != Some(this.clone()) {
            let _ = writeln!(
                text,
                "\n## {this}\n\n| | fur | guard hair, electron microscope | transmitted light |\n\
                 |:--|:-:|:-:|:-:|"
            );
            family = Some(this);
        }
        let first = &species.classes[0];
        let cell = |column: Column| {
            let picture = Picture {
                column,
                class: first,
            };
            format!(
                "<a href=\"{}.md\"><img src=\"images/{}\" height=\"96\" alt=\"{}\"></a>",
                species.id,
                picture.file(species),
                column.title()
            )
        };
        let latin = match species.latin.as_str() {
            "" => String::new(),
            latin => format!("<br>*{latin}*"),
        };
        let _ = writeln!(
            text,
            "| [{}]({}.md){latin} | {} | {} | {} |",
            species.name,
            species.id,
            cell(Column::Swatch),
            cell(Column::Sem),
            cell(Column::Light)
        );
    }
    text
}

fn heading(species: &Species) -> String {
    if species.family.is_empty() {
        return species.group.clone();
    }
    format!("{} ({})", species.group, species.family)
}

fn family(species: &Species) -> String {
    match species.family.as_str() {
        "" => String::new(),
        family => format!(", {family}"),
    }
}

fn capitalized(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
