//! What was found.

use super::consumer::Consumer;
use super::rule::Rule;
use std::collections::HashSet;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Good to know.
    Note,
    /// Something is ignored or drawn a little differently.
    Warning,
    /// Something is refused, lost or drawn wrongly.
    Error,
}

impl Severity {
    /// In lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Something that one or more programs will refuse, ignore or misread.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The rule that is broken.
    pub rule: Rule,
    /// How bad that is.
    pub severity: Severity,
    /// Who suffers.
    pub consumers: Vec<Consumer>,
    /// The file that was asked about.
    pub file: String,
    /// Path of the prim or name of the grid; empty for the file itself.
    pub prim: String,
    /// Attribute or field; empty for the prim itself.
    pub attribute: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub remedy: String,
}

/// Where something was found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place<'p> {
    pub(super) prim: &'p str,
    pub(super) attribute: &'p str,
}

/// Collects findings of one file.
pub(super) struct Findings<'f> {
    file: &'f str,
    profile: &'f [Consumer],
    known: HashSet<(Rule, String, String, String)>,
    /// Variants that are shown, `{lod=low}`; empty for those of the file.
    pub(super) view: String,
    pub(super) all: Vec<Finding>,
}

impl<'f> Findings<'f> {
    /// * `profile`: who counts; empty for all but AR viewers.
    pub(super) fn new(file: &'f str, profile: &'f [Consumer]) -> Self {
        Self {
            file,
            profile,
            known: HashSet::new(),
            view: String::new(),
            all: Vec::new(),
        }
    }

    /// Whether a consumer was named, not only meant along with all others.
    pub(super) fn names(&self, consumer: Consumer) -> bool {
        self.profile.contains(&consumer)
    }

    fn counts(&self, consumer: Consumer) -> bool {
        match self.profile {
            [] => consumer != Consumer::Ar,
            named => named.contains(&consumer),
        }
    }

    /// Adds a finding, if it concerns anyone and is not known yet: variants show the same prims again.
    pub(super) fn add(
        &mut self,
        (rule, severity): (Rule, Severity),
        consumers: &[Consumer],
        place: Place<'_>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let consumers = consumers.iter().copied();
        let consumers: Vec<Consumer> = consumers.filter(|c| self.counts(*c)).collect();
        let message = message.into();
        let (mut prim, attribute) = (place.prim.to_owned(), place.attribute.to_owned());
        let key = (rule, prim.clone(), attribute.clone(), message.clone());
        if consumers.is_empty() || !self.known.insert(key) {
            return;
        }
        if !self.view.is_empty() {
            let root = prim[1.min(prim.len())..]
                .find('/')
                .map_or(prim.len(), |at| at + 1);
            prim.insert_str(root, &self.view);
        }
        self.all.push(Finding {
            rule,
            severity,
            consumers,
            file: self.file.to_owned(),
            prim,
            attribute,
            message,
            remedy: remedy.into(),
        });
    }
}
