//! `vair check`: what programs will refuse, ignore or misread in files of fur.

use super::bake::parse_count;
use super::stdout::{harmless, print, print_json};
use super::{Console, Failure};
use crate::blame::Blame;
use crate::check::{
    self, CheckError, CheckSettings, Checked, Consumer, Finding, RULES, Refused, Rule, Severity,
};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::PathBuf;

/// Arguments of `vair check`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  vair check fox.usdc
  vair check fox.usda --profile blender,unreal
  vair check fox.usdc fox.vdb --json > findings.json
  vair check groom.usd --profile unreal --strict
  vair check fox.hair --expect-strands 200000
  vair check --explain C07

A finding says its rule, how bad it is (error: refused, lost or drawn wrongly; warning: ignored or drawn a
little differently; note: good to know), where it is, what is wrong, what to do, and who suffers. The files
may be anyone's; payloads, references, sublayers and grids beside them are read too, and every variant
is looked at. Strands and grids of several files are held against each other.

Ends with 0 if there are no errors, 1 if there are some or a file is broken or not there, 2 if one
cannot be read.")]
pub(super) struct Args {
    /// .usda, .usdc, .usd, .usdz, .vdb and .hair files.
    #[arg(required_unless_present = "explain", value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Who is to read them: all, or some of blender, cycles, unreal, houdini, arnold, renderman, omniverse,
    /// storm, validators, openvdb, luxcore, pbrt (the last two of .hair) and ar (viewers of .usdz, which `all`
    /// leaves out).
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "READERS",
        default_value = "all"
    )]
    profile: Vec<String>,
    /// Strands that each file should have.
    #[arg(long, value_parser = parse_count, value_name = "N")]
    expect_strands: Option<u64>,
    /// Warnings end with 1 too.
    #[arg(long)]
    strict: bool,
    /// Print JSON; `vair schema check` describes it.
    #[arg(long)]
    json: bool,
    /// Say what a rule wants and why: C01 to C20, or all.
    #[arg(long, value_name = "RULE")]
    explain: Option<String>,
}

/// Runs the command.
///
/// # Errors
/// Errors that were found, files that cannot be read, options that are refused.
pub(super) fn run(args: &Args, console: &Console) -> Result<(), Failure> {
    if let Some(rule) = &args.explain {
        return explain(rule);
    }
    let settings = CheckSettings {
        profile: profile(&args.profile)?,
        strands: args.expect_strands,
    };
    let Checked { findings, refused } = check::check(&args.files, &settings);
    let count = |severity| findings.iter().filter(|f| f.severity == severity).count();
    let [errors, warnings, notes] = [Severity::Error, Severity::Warning, Severity::Note].map(count);
    if args.json {
        let files: Vec<_> = args.files.iter().map(|f| f.to_string_lossy()).collect();
        print_json(&json!({
            "files": files,
            "errors": errors,
            "warnings": warnings,
            "notes": notes,
            "findings": findings.iter().map(as_json).collect::<Vec<_>>(),
            "refused": refused.iter().map(refused_as_json).collect::<Vec<_>>(),
        }))?;
    } else {
        print(&lines(&findings))?;
    }
    let read = args.files.len() - refused.len();
    let many =
        |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let summary = format!(
        "{}: {}, {}, {}",
        many(read, "file"),
        many(errors, "error"),
        many(warnings, "warning"),
        many(notes, "note")
    );
    if !refused.is_empty() {
        return Err(not_read(&refused, read, summary));
    }
    if errors > 0 || (args.strict && warnings > 0) {
        return Err(Failure::with_help(
            Blame::Input,
            summary,
            "vair check --explain RULE tells why",
        ));
    }
    console.say(summary);
    Ok(())
}

/// Files that could not be looked at; what was found in the others is printed already.
///
/// * `read`: number of the others. * `summary`: of those.
fn not_read(refused: &[Refused], read: usize, summary: String) -> Failure {
    let errors = || refused.iter().map(|r| &r.error);
    let is_of_input = errors().all(|error| error.blame() == Blame::Input);
    let blame = match is_of_input {
        true => Blame::Input,
        false => Blame::Environment,
    };
    let message: Vec<String> = errors().map(CheckError::to_string).collect();
    let message = message.join("\n");
    match read {
        0 => Failure::new(blame, message),
        _ => Failure::with_help(blame, message, format!("what could be read, {summary}")),
    }
}

fn explain(rule: &str) -> Result<(), Failure> {
    if rule == "all" {
        let all = RULES.iter().map(|d| format!("{} {}\n", d.id, d.title));
        return print(&all.collect::<String>());
    }
    let Some(rule) = Rule::of_id(rule) else {
        let message = format!("`{rule}` is no rule");
        return Err(Failure::with_help(
            Blame::Input,
            message,
            "there are C01 to C20",
        ));
    };
    let said = rule.described();
    let text = format!(
        "{} {}\n\n{}\n\nKnown from: {}\n",
        said.id, said.title, said.explanation, said.evidence
    );
    print(&text)
}

fn profile(names: &[String]) -> Result<Vec<Consumer>, Failure> {
    let mut profile = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        if name == "all" {
            return Ok(Vec::new());
        }
        let Some(consumer) = Consumer::of_name(name) else {
            let known = Consumer::ALL.map(Consumer::name).join(", ");
            return Err(Failure::with_help(
                Blame::Input,
                format!("`{name}` is no reader that --profile knows"),
                format!("there are all, {known}"),
            ));
        };
        profile.push(consumer);
    }
    Ok(profile)
}

/// A line for each thing that is wrong; where several prims share it the first is named.
fn lines(findings: &[Finding]) -> String {
    let what = |f: &Finding| {
        (
            f.file.clone(),
            f.rule,
            f.severity,
            f.attribute.clone(),
            f.message.clone(),
        )
    };
    let mut groups: Vec<(&Finding, usize)> = Vec::new();
    let mut known = HashMap::new();
    for finding in findings {
        let place = *known.entry(what(finding)).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, more)) => *more += 1,
            None => groups.push((finding, 0)),
        }
    }
    groups
        .into_iter()
        .map(|(finding, more)| line(finding, more))
        .collect()
}

/// `fox.usda: C07 error /fox/guard.primvars:groom_color and 2 more: ... Remedy: ... [unreal]`
fn line(finding: &Finding, more: usize) -> String {
    let mut place = finding.prim.clone();
    if !finding.attribute.is_empty() {
        let dot = if place.is_empty() { "" } else { "." };
        place = format!("{place}{dot}{}", finding.attribute);
    }
    if more > 0 {
        place = format!("{place} and {more} more");
    }
    if !place.is_empty() {
        place.push_str(": ");
    }
    let line = format!(
        "{}: {} {} {place}{}. Remedy: {}. [{}]",
        finding.file,
        finding.rule.id(),
        finding.severity.name(),
        finding.message,
        finding.remedy,
        names(finding).join(", ")
    );
    // Names and paths are those of files that anyone may have made.
    harmless(&line.replace('\n', "\\n")).into_owned() + "\n"
}

fn names(finding: &Finding) -> Vec<&'static str> {
    finding.consumers.iter().map(|c| c.name()).collect()
}

fn as_json(finding: &Finding) -> Value {
    json!({
        "rule": finding.rule.id(),
        "severity": finding.severity.name(),
        "consumers": names(finding),
        "file": finding.file,
        "prim": finding.prim,
        "attribute": finding.attribute,
        "message": finding.message,
        "remedy": finding.remedy,
    })
}

fn refused_as_json(refused: &Refused) -> Value {
    json!({ "file": refused.file, "message": refused.error.to_string() })
}
