//! Sizes, file names and links; pictures themselves are tested where they are drawn.

use super::*;
use crate::species::load_with_origins;
use glam::Vec3;

#[test]
fn a_sheet_has_a_row_an_animal_and_a_column_a_kind() {
    let (species, _) = load_with_origins("red-fox", &[]).unwrap();
    let columns = [Column::Sem, Column::Swatch];
    let row = || Row {
        species: &species,
        pictures: columns
            .iter()
            .map(|&column| {
                let (width, height) = picture_size(column, 120);
                Ok(Canvas::new(width, height, Vec3::ZERO))
            })
            .collect(),
    };
    let one = sheet(&[row()], &columns, 120);
    let two = sheet(&[row(), row()], &columns, 120);
    assert_eq!(one.width(), two.width());
    assert!(two.height() - one.height() > 120);
    // The pictures are on it, whole: as many black pixels as they have.
    let black = (0..one.width() * one.height())
        .filter(|i| one.get(i % one.width(), i / one.width()) == Vec3::ZERO)
        .count();
    assert_eq!(black, 120 * (192 + 160));
}

#[test]
fn pages_name_every_picture_and_every_source() {
    let (species, origins) = load_with_origins("red-fox", &[]).unwrap();
    let text = page(&Page {
        species: &species,
        origins: &origins,
        guide: "in words\n\nNUMBERS\nall numbers\n\nSOURCES\n  AF\n",
    });
    for picture in pictures_of(&species) {
        let link = format!("(images/{})", picture.file(&species));
        assert_eq!(text.matches(&link).count(), 1, "{link}");
    }
    for reference in &origins.references {
        assert!(text.contains(&reference.text));
    }
    assert!(
        text.contains("in words\n```")
            && text.contains("all numbers\n```")
            && text.contains("Vulpes vulpes")
    );
}

#[test]
fn the_index_lists_animals_under_their_families() {
    let load = |id| load_with_origins(id, &[]).unwrap().0;
    let animals = [load("cat"), load("lynx"), load("red-fox")];
    let text = index(&animals.each_ref(), "vair gallery --pages docs/library");
    assert_eq!(text.matches("\n## ").count(), 2, "{text}");
    for species in &animals {
        assert!(text.contains(&format!("[{}]({}.md)", species.name, species.id)));
    }
}

#[test]
fn a_stopped_studio_makes_nothing() {
    let (species, _) = load_with_origins("red-fox", &[]).unwrap();
    let cancel = Cancel::default();
    cancel.cancel();
    let studio = Studio {
        quality: Quality::PREVIEW,
        cache: None,
        cancel: &cancel,
    };
    for column in [Column::Sem, Column::Lobe, Column::Swatch] {
        let class = &species.classes[0];
        let result = studio.picture(column, &species, class, (160, 100), Legend::None);
        let error = result.err().unwrap();
        assert_eq!(error.blame(), Blame::Interrupted);
    }
}
