use super::*;
use crate::bake::absorption_levels;

#[test]
fn ledger_is_exact_and_weights_follow_beer() {
    let levels = absorption_levels(12);
    let cube = Unicube::new(4);
    let mut tally = Tally::new(cube.texels(), levels.len());
    let (mut emitted, mut deposits) = (0, Deposits::default());
    for i in 0..1000u32 {
        let rest = Rest {
            part: PHOTON / u64::from(1 + i % 3),
            share: 1.0 / f64::from(1 + i % 7),
            path: f64::from(i % 37) * 0.31,
        };
        emitted += rest.part;
        match i % 10 {
            0 => tally.truncate(rest, &levels),
            1 => tally.lose(rest, &levels),
            2 => tally.absorb(rest, &levels),
            _ => {
                deposits.push(i as usize % cube.texels(), rest);
                tally.escape(&mut deposits, &levels);
            }
        }
    }
    tally.fold(&cube);
    for l in tally.ledger() {
        assert_eq!(emitted, l.escaped + l.absorbed + l.truncated + l.lost);
        assert!(l.truncated > 0 && l.lost > 0);
    }
    let rest = Rest {
        part: PHOTON,
        share: 0.3,
        path: 0.7,
    };
    let weights = weights::<6>(rest, (-levels[1] * rest.path).exp());
    let weights = weights.iter().flat_map(|pair| pair.to_array());
    for (level, weight) in levels.iter().zip(weights) {
        let exact = 0.3 * (-level * 0.7).exp();
        assert!((weight as f64 / PHOTON as f64 - exact).abs() < 1e-9);
    }
}
