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
    /// Without hair: the skin leaves no room for one as long as thick. See
    /// [`Collision::Exact`](crate::species::Collision), as for the two below.
    pub buried: usize,
    /// Hairs that were bent along the skin, which they would have entered.
    pub bent: usize,
    /// Hairs that end where they would have entered the skin: folds left them no way out.
    pub cut: usize,
}

impl Account {
    /// Hairs that grew.
    pub fn grown(&self) -> usize {
        self.asked - self.short - self.thin - self.sparse - self.buried
    }

    /// What is to be said of follicles that have no hair.
    pub(super) fn missing(&self, class: &str) -> Option<String> {
        let reasons = [
            (self.short, "would be shorter than thick"),
            (self.thin, "would have no width"),
            (self.sparse, "are where its density is less"),
            (
                self.buried,
                "have no room between folds of the skin, or above the ground",
            ),
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

    /// What is to be said of hairs that met the skin.
    pub(super) fn collided(&self, class: &str) -> Option<String> {
        (self.bent + self.cut > 0).then(|| {
            format!(
                "{} of {} strands of `{class}` would have entered the skin: {} lie on it, {} end before it",
                self.bent + self.cut,
                self.grown(),
                self.bent,
                self.cut
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
            ("buried_in_skin", self.buried),
            ("bent_by_skin", self.bent),
            ("cut_by_skin", self.cut),
        ];
        all.into_iter().filter(|(_, count)| *count > 0).collect()
    }
}
