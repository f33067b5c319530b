//! What became of the follicles of a class: how many have hair as asked, and why others have not.

/// Counts of a class's follicles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Account {
    /// Hairs asked for: as many follicles.
    pub asked: usize,
    /// Without hair: it would be shorter than it is thick.
    pub short: usize,
    /// Without hair: it would have no width.
    pub thin: usize,
    /// Without hair: fewer hairs grow there.
    pub sparse: usize,
    /// Closer to their neighbors than evenly spread: there was no room.
    pub crowded: usize,
}

impl Account {
    /// Hairs that grew.
    pub fn grown(&self) -> usize {
        self.asked - self.short - self.thin - self.sparse
    }

    /// What is to be said of follicles that have no hair.
    pub(super) fn missing(&self, class: &str) -> Option<String> {
        let reasons = [
            (self.short, "would be shorter than thick"),
            (self.thin, "would have no width"),
            (self.sparse, "are where its density is less"),
        ];
        let said = reasons.iter().filter(|(count, _)| *count > 0);
        let reasons: Vec<String> = said.map(|(count, why)| format!("{count} {why}")).collect();
        (!reasons.is_empty()).then(|| {
            format!(
                "{} of {} strands of `{class}` did not grow: {}",
                self.asked - self.grown(),
                self.asked,
                reasons.join(", ")
            )
        })
    }

    /// All counts that are not zero, with their names.
    pub(crate) fn reasons(&self) -> Vec<(&'static str, usize)> {
        let all = [
            ("shorter_than_thick", self.short),
            ("no_width", self.thin),
            ("less_density", self.sparse),
            ("no_room", self.crowded),
        ];
        all.into_iter().filter(|(_, count)| *count > 0).collect()
    }
}
