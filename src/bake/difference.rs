//! Where two documents differ, in words.

use serde_json::Value;

/// Differences named at most: the rest is counted.
const MOST: usize = 4;
/// Longer values are cut.
const LONGEST: usize = 60;

/// The fields in which `found` is not as `wanted`, with both values; `None` if they are equal.
pub(super) fn differences(found: &Value, wanted: &Value) -> Option<String> {
    let mut list = Vec::new();
    compare("", found, wanted, &mut list);
    if list.is_empty() {
        return None;
    }
    let more = list.len().saturating_sub(MOST);
    list.truncate(MOST);
    let mut text = list.join("; ");
    if more > 0 {
        text += &format!("; and {more} more");
    }
    Some(text)
}

fn compare(path: &str, a: &Value, b: &Value, list: &mut Vec<String>) {
    let inside = |key: &str| match path {
        "" => key.to_owned(),
        _ => format!("{path}.{key}"),
    };
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            let mut keys: Vec<&String> = a.keys().chain(b.keys()).collect();
            keys.sort();
            keys.dedup();
            for key in keys {
                let (a, b) = (a.get(key), b.get(key));
                let of = |value: Option<&Value>| value.cloned().unwrap_or_default();
                compare(&inside(key), &of(a), &of(b), list);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&inside(&i.to_string()), a, b, list);
            }
        }
        _ if a == b => {}
        (Value::String(a), Value::String(b)) if a.len() > LONGEST && b.len() > LONGEST => {
            list.push(format!("{path} is another text"));
        }
        _ => list.push(format!("{path} is {}, not {}", short(a), short(b))),
    }
}

fn short(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_the_fields() {
        let a = json!({"a": {"b": 1, "c": [1, 2]}, "d": "x"});
        let b = json!({"a": {"b": 2, "c": [1, 3]}, "d": "x", "e": null});
        assert_eq!(differences(&a, &a), None);
        assert_eq!(
            differences(&b, &a).unwrap(),
            "a.b is 2, not 1; a.c.1 is 3, not 2"
        );
    }
}
