//! One fault in a species file.

/// Random numbers of one case: splitmix64.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % sides.max(1) as u64) as usize
    }

    pub(crate) fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.roll(items.len())]
    }
}

/// What a damaged file has to lead to.
pub(crate) enum Verdict {
    /// Nothing but order: it may even be good still.
    Any,
    /// A report in one of these lines, counted from 0.
    Line(std::ops::RangeInclusive<usize>),
    /// One report, in this line.
    Only(usize),
}

/// A file with a fault.
pub(crate) struct Damaged {
    pub(crate) text: String,
    pub(crate) verdict: Verdict,
}

/// A built-in species by lines.
pub(crate) struct Source {
    pub(crate) lines: Vec<String>,
}

impl Source {
    pub(crate) fn new(text: &str) -> Self {
        Self {
            lines: text.lines().map(str::to_owned).collect(),
        }
    }

    /// Lines `key = ...` outside of [sources] for which `wanted(key, value)` holds.
    pub(crate) fn entries(&self, wanted: impl Fn(&str, &str) -> bool) -> Vec<usize> {
        let mut table = "";
        let mut found = Vec::new();
        for (index, line) in self.lines.iter().enumerate() {
            if line.starts_with('[') {
                table = line;
            }
            let entry = line.split_once(" = ").filter(|(key, _)| is_key(key));
            if table != "[sources]" && entry.is_some_and(|(key, value)| wanted(key, value)) {
                found.push(index);
            }
        }
        found
    }

    /// The line of the header of the table that a line stands in.
    pub(crate) fn header_above(&self, line: usize) -> usize {
        let header = |l: &usize| self.lines[*l].starts_with('[');
        (0..=line).rev().find(header).unwrap_or(0)
    }

    pub(crate) fn with(&self, line: usize, put: &str) -> String {
        let mut lines = self.lines.clone();
        put.clone_into(&mut lines[line]);
        lines.join("\n") + "\n"
    }

    fn inserted(&self, before: usize, put: &str) -> String {
        let mut lines = self.lines.clone();
        lines.insert(before, put.to_owned());
        lines.join("\n") + "\n"
    }

    fn text(&self) -> String {
        self.lines.join("\n") + "\n"
    }
}

fn is_key(text: &str) -> bool {
    let letter = |c: char| c.is_ascii_lowercase() || c == '_' || c.is_ascii_digit();
    !text.is_empty() && text.chars().all(letter)
}

/// Where the first number of a value stands, bare, in a list or in `{ value = .. }`.
fn number(line: &str) -> Option<std::ops::Range<usize>> {
    let mut start = line.find(" = ")? + 3;
    if line[start..].starts_with("{ value = ") {
        start += "{ value = ".len();
    }
    if line[start..].starts_with('[') {
        start += 1;
    }
    let digit = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let length = line[start..]
        .find(|c| !digit(c))
        .unwrap_or(line.len() - start);
    (length > 0).then_some(start..start + length)
}

fn has_number(key: &str, value: &str) -> bool {
    number(&format!("{key} = {value}")).is_some()
}

/// The kinds of damage; each is a function of the source and the dice.
pub(crate) const KINDS: [fn(&Source, &mut Dice) -> Damaged; 16] = [
    other_type,
    out_of_range,
    not_finite,
    misspelt_key,
    unknown_key,
    unknown_word,
    unknown_source,
    duplicate_key,
    missing_number,
    lost_token,
    deep_nesting,
    duplicate_table,
    misspelt_class,
    cut_short,
    shuffled_lines,
    noise,
];

fn replaced_number(source: &Source, dice: &mut Dice, put: &[&str]) -> Damaged {
    let line = dice.pick(&source.entries(has_number));
    let mut text = source.lines[line].clone();
    let range = number(&text).unwrap();
    text.replace_range(range, dice.pick(put));
    Damaged {
        text: source.with(line, &text),
        verdict: Verdict::Only(line),
    }
}

fn other_type(source: &Source, dice: &mut Dice) -> Damaged {
    let put = [
        "\"12\"",
        "true",
        "[[1]]",
        "1979-05-27",
        "{}",
        "''",
        "{ x = 1 }",
        "07:32:00",
    ];
    let mut damaged = replaced_number(source, dice, &put);
    if let (Verdict::Only(line), true) = (&damaged.verdict, damaged.text.contains("{ x = 1 }")) {
        // No value and an unknown key: two reports.
        damaged.verdict = Verdict::Line(*line..=*line);
    }
    damaged
}

fn out_of_range(source: &Source, dice: &mut Dice) -> Damaged {
    let put = [
        "1e9",
        "-1e9",
        "-0.001e9",
        "99999999999999999999",
        "1e308",
        "-7",
    ];
    let mut damaged = replaced_number(source, dice, &put);
    // Two keys may be negative, and -7 is a good value of them.
    if damaged
        .text
        .lines()
        .any(|l| l == "bend_deg = -7" || l == "twist_turns_per_cm = -7")
    {
        damaged.verdict = Verdict::Any;
    }
    damaged
}

fn not_finite(source: &Source, dice: &mut Dice) -> Damaged {
    replaced_number(
        source,
        dice,
        &["nan", "-nan", "inf", "+inf", "-inf", "1e999", "-1e400"],
    )
}

fn misspelt_key(source: &Source, dice: &mut Dice) -> Damaged {
    let line = dice.pick(&source.entries(|key, _| key.len() > 5));
    let text = &source.lines[line];
    let key = text.find(" = ").unwrap();
    let cut = 1 + dice.roll(key - 2);
    Damaged {
        text: source.with(line, &format!("{}{}", &text[..cut], &text[cut + 1..])),
        verdict: Verdict::Line(line..=line),
    }
}

fn unknown_key(source: &Source, dice: &mut Dice) -> Damaged {
    let line = dice.pick(&source.entries(|_, _| true));
    let key = dice.pick(&[
        "zebra",
        "\"\\u0007\"",
        "\"very long and odd key\"",
        "a.b.c",
        "\"\"",
    ]);
    let value = dice.pick(&["1", "\"x\"", "[]", "{}", "[{}, 2, \"\"]"]);
    Damaged {
        text: source.inserted(line, &format!("{key} = {value}")),
        verdict: Verdict::Line(line..=line),
    }
}

fn unknown_word(source: &Source, dice: &mut Dice) -> Damaged {
    let words = ["pattern", "kind", "margin", "section", "continuity"];
    let line = dice.pick(&source.entries(|key, _| words.contains(&key)));
    let key = source.lines[line].split_once(" = ").unwrap().0;
    let word = dice.pick(&[
        "\"froht\"",
        "\"\"",
        "\"MOSAIC\"",
        "7",
        "[\"froth\"]",
        "\"\\u202e\"",
    ]);
    Damaged {
        text: source.with(line, &format!("{key} = {word}")),
        verdict: Verdict::Line(line..=line),
    }
}

fn unknown_source(source: &Source, dice: &mut Dice) -> Damaged {
    let cited = source.entries(|_, value| value.contains("source = \""));
    if cited.is_empty() {
        return noise(source, dice);
    }
    let line = dice.pick(&cited);
    let put = dice.pick(&["NOBODY", "", "af ", "AF\\n"]);
    let text = source.lines[line].replacen("source = \"", &format!("source = \"{put}"), 1);
    Damaged {
        text: source.with(line, &text),
        verdict: if put.is_empty() {
            Verdict::Any
        } else {
            Verdict::Only(line)
        },
    }
}

fn duplicate_key(source: &Source, dice: &mut Dice) -> Damaged {
    let line = dice.pick(&source.entries(|_, _| true));
    Damaged {
        text: source.inserted(line, &source.lines[line]),
        verdict: Verdict::Line(line..=line + 1),
    }
}

/// Grooms need all of their numbers: what is missing is reported at the head of the table.
fn missing_number(source: &Source, dice: &mut Dice) -> Damaged {
    let all = source.entries(has_number);
    let groom = |line: &&usize| source.lines[source.header_above(**line)].ends_with(".groom]");
    let grooms: Vec<usize> = all.iter().filter(groom).copied().collect();
    let line = dice.pick(&grooms);
    let header = source.header_above(line);
    Damaged {
        text: source.with(line, "# gone"),
        verdict: Verdict::Only(header),
    }
}

/// A line without one of its marks is no TOML; a parser may see it in the next line.
fn lost_token(source: &Source, dice: &mut Dice) -> Damaged {
    let line = dice.pick(&source.entries(|_, _| true));
    let text = &source.lines[line];
    let marks: Vec<usize> = "=\"[]{}".chars().flat_map(|c| text.find(c)).collect();
    let mark = dice.pick(&marks);
    let is_equals = text[mark..].starts_with('=');
    let last = source.lines.len();
    Damaged {
        text: source.with(line, &format!("{}{}", &text[..mark], &text[mark + 1..])),
        // Quotes and brackets that stay open are found further down.
        verdict: Verdict::Line(line..=if is_equals { line } else { last }),
    }
}

fn deep_nesting(source: &Source, dice: &mut Dice) -> Damaged {
    let line = dice.pick(&source.entries(|_, _| true));
    let depth = dice.pick(&[3, 81, 1000, 20_000]);
    let open = dice.pick(&["[", "{ a = ", "{ value = ["]);
    let put = match dice.roll(3) {
        0 => format!("deep = {}", open.repeat(depth)),
        1 => format!("deep = {}1{}", "[".repeat(depth), "]".repeat(depth)),
        _ => format!("{} = 1", vec!["deep"; depth].join(".")),
    };
    Damaged {
        text: source.inserted(line, &put),
        // An open bracket of few levels goes on in the next line.
        verdict: Verdict::Line(line..=line + 1),
    }
}

fn duplicate_table(source: &Source, dice: &mut Dice) -> Damaged {
    let single = |l: &&usize| {
        let line = &source.lines[**l];
        line.starts_with('[') && !line.starts_with("[[") && !line.contains(".stations.")
    };
    let all: Vec<usize> = (0..source.lines.len()).collect();
    let headers: Vec<usize> = all.iter().filter(single).copied().collect();
    let header = source.lines[dice.pick(&headers)].clone();
    let last = source.lines.len();
    Damaged {
        text: source.inserted(last, &header),
        verdict: Verdict::Line(last..=last),
    }
}

fn misspelt_class(source: &Source, dice: &mut Dice) -> Damaged {
    let class = |l: &&usize| source.lines[**l].starts_with("[guard.groom");
    let all: Vec<usize> = (0..source.lines.len()).collect();
    let headers: Vec<usize> = all.iter().filter(class).copied().collect();
    let line = dice.pick(&headers);
    let put = dice.pick(&["gaurd", "guards", "\"guard \"", "Guard"]);
    Damaged {
        text: source.with(line, &source.lines[line].replacen("guard", put, 1)),
        verdict: Verdict::Line(line..=line),
    }
}

fn cut_short(source: &Source, dice: &mut Dice) -> Damaged {
    let text = source.text();
    let mut end = dice.roll(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    Damaged {
        text: text[..end].to_owned(),
        verdict: Verdict::Any,
    }
}

fn shuffled_lines(source: &Source, dice: &mut Dice) -> Damaged {
    let mut lines = source.lines.clone();
    for _ in 0..=dice.roll(6) {
        let (a, b) = (dice.roll(lines.len()), dice.roll(lines.len()));
        match dice.roll(3) {
            0 => lines.swap(a, b),
            1 => drop(lines.remove(a)),
            _ => lines.insert(a, lines[b].clone()),
        }
    }
    Damaged {
        text: lines.join("\r\n"),
        verdict: Verdict::Any,
    }
}

/// Characters put over, in or out at random places.
fn noise(source: &Source, dice: &mut Dice) -> Damaged {
    let mut text: Vec<char> = source.text().chars().collect();
    let marks: Vec<char> = "[]{}=\"'#\\\n\r\t.,-+_0e\0\u{1b}\u{7f}é\u{202e}\u{feff}😀"
        .chars()
        .collect();
    for _ in 0..=dice.roll(12) {
        let place = dice.roll(text.len());
        match dice.roll(3) {
            0 => text[place] = dice.pick(&marks),
            1 => text.insert(place, dice.pick(&marks)),
            _ => drop(text.remove(place)),
        }
    }
    Damaged {
        text: text.into_iter().collect(),
        verdict: Verdict::Any,
    }
}
