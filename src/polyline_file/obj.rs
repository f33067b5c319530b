//! `v` and `l` of Wavefront OBJ; everything else is passed over.

use super::Fault;

pub(super) fn lines(bytes: &[u8]) -> Result<Vec<Vec<[f32; 3]>>, Fault> {
    let mut points: Vec<[f32; 3]> = Vec::new();
    let mut lines = Vec::new();
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        let line = line.split('#').next().unwrap_or_default();
        let fault = |reason: String| (format!("line {}", number + 1), reason);
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f32> = words.map_while(|word| word.parse().ok()).collect();
                match numbers.get(..3) {
                    Some(&[x, y, z]) if x.is_finite() && y.is_finite() && z.is_finite() => {
                        points.push([x, y, z]);
                    }
                    _ => return Err(fault("`v` needs three finite numbers".to_owned())),
                }
            }
            Some("l") => {
                let corner = |word: &str| {
                    let index = word.split('/').next().unwrap_or_default();
                    let index: i64 = index
                        .parse()
                        .map_err(|_| fault("`l` needs numbers of vertices".to_owned()))?;
                    // Indices count from 1; negative ones count back from the last.
                    let count = points.len() as i64;
                    let place = if index < 0 { count + index } else { index - 1 };
                    let point = usize::try_from(place).ok().and_then(|p| points.get(p));
                    point
                        .copied()
                        .ok_or_else(|| fault(format!("vertex {index} of {count}")))
                };
                lines.push(words.map(corner).collect::<Result<Vec<_>, Fault>>()?);
            }
            _ => {}
        }
    }
    Ok(lines)
}
