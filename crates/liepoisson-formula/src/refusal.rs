//! Why a formula is refused: a message, and the place in the text.

use std::fmt;

/// A formula that is not in the grammar, or has no meaning where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// What was wanted, what came, what to try.
    pub message: String,
    /// The whole formula; empty where something else than a formula is refused.
    pub text: String,
    /// Place of the offending character in it, in characters from 0; `None` where something else than a formula is refused.
    pub position: Option<usize>,
}

impl Refusal {
    pub(super) fn new(message: impl Into<String>, text: &str, position: usize) -> Refusal {
        let position = position.min(text.chars().count());
        Refusal { message: message.into(), text: text.to_owned(), position: Some(position) }
    }

    /// Of something that is no formula.
    pub(super) fn general(message: impl Into<String>) -> Refusal {
        Refusal { message: message.into(), text: String::new(), position: None }
    }

    /// Line and column of the place in a formula, both from 1.
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        let before: Vec<char> = self.text.chars().take(self.position?).collect();
        let line = 1 + before.iter().filter(|&&character| character == '\n').count();
        let column = 1 + before.iter().rev().take_while(|&&character| character != '\n').count();
        Some((line, column))
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line_and_column() {
            Some((line, column)) => write!(f, "{} (line {line}, column {column}).", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Refusal {}

/// The question that begins a hint, "Did you mean l3? ", or nothing where no known name is near.
pub(super) fn did_you_mean<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> String {
    let wanted = name.to_lowercase();
    let mut by_letters: Vec<(String, &str)> = vec![];
    for other in known {
        let letters = other.to_lowercase();
        match by_letters.iter_mut().find(|(have, _)| *have == letters) {
            Some((_, shown)) => *shown = other,
            None => by_letters.push((letters, other)),
        }
    }
    let near = by_letters
        .into_iter()
        .map(|(letters, shown)| (similarity(&letters, &wanted), letters, shown))
        .filter(|(similarity, ..)| *similarity >= 0.6)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
    near.map_or_else(String::new, |(.., shown)| format!("Did you mean {shown}? "))
}

/// Twice the letters that two words share in common blocks, over the letters of both: the ratio of Ratcliff and Obershelp, as
/// Python's `difflib` forms it.
fn similarity(a: &str, b: &str) -> f64 {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut matches = 0;
    let mut waiting = vec![(0..a.len(), 0..b.len())];
    while let Some((of_a, of_b)) = waiting.pop() {
        // the longest common block, the first of the longest
        let (mut start_a, mut start_b, mut longest) = (of_a.start, of_b.start, 0);
        for i in of_a.clone() {
            for j in of_b.clone() {
                let rest_a = a[i..of_a.end].iter();
                let length = rest_a.zip(&b[j..of_b.end]).take_while(|(p, q)| p == q).count();
                if length > longest {
                    (start_a, start_b, longest) = (i, j, length);
                }
            }
        }
        if longest > 0 {
            matches += longest;
            waiting.push((of_a.start..start_a, of_b.start..start_b));
            waiting.push((start_a + longest..of_a.end, start_b + longest..of_b.end));
        }
    }
    2.0 * matches as f64 / (a.len() + b.len()).max(1) as f64
}
