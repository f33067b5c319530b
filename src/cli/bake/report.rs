//! What is said of a bake when it is done.

use crate::cli::Console;
use crate::table::{Ledger, Mode, PHOTON, StructureTable};

/// Energy and loss, so that a bad bake is seen at once.
pub(in crate::cli) fn report(tables: &[StructureTable], console: &Console) {
    let clear = |f: fn(&Ledger) -> u64| -> f64 {
        let nodes = |t: &StructureTable| {
            (0..t.nodes.len())
                .map(|n| f(t.ledger(n, 0)) as f64)
                .sum::<f64>()
        };
        tables.iter().map(nodes).sum()
    };
    let emitted = clear(|l| l.emitted);
    console.say(format!(
        "{:.3e} photons: {:.4} % escaped, {:.4} % truncated, {:.1e} of them lost",
        emitted / PHOTON as f64,
        100.0 * clear(|l| l.escaped) / emitted,
        100.0 * clear(|l| l.truncated) / emitted,
        clear(|l| l.lost) / emitted,
    ));
    if tables[0].nodes.mode == Mode::Paper && clear(|l| l.truncated) > 1e-3 * emitted {
        console.say("warning: the cap on events cuts off light; cone mode does not have it");
    }
}
