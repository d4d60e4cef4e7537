//! The grammar of formulas: text to tokens to a tree.
//!
//! ```text
//! sum       = product { ("+" | "-") product }
//! product   = factor { ("*" | "/") factor }
//! factor    = ("+" | "-") factor | power
//! power     = component [ ("^" | "**") factor ]
//! component = atom [ "[" index { "," index } "]" ]
//! atom      = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! `^` is a power, binds to the right and tighter than a sign: `-x^2` is `-(x^2)`, `2^3^2` is `2^9`. Components are
//! counted from 1. The method is recursive descent, to a fixed depth.

use super::names::{MAX_NAME, character_instead, quoted};
use super::rational::Rational;
use super::refusal::Refusal;

/// Characters of the longest formula.
pub const MAX_CHARACTERS: usize = 20_000;

const MAX_NESTING: usize = 64;
const MAX_DIGITS: usize = 200;

/// A part of a formula, with the place to which a refusal of it points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    pub(super) position: usize,
    pub(super) part: Part,
}

/// What a part of a formula is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    Number(Rational),
    Name(String),
    /// Terms, and of each whether it is subtracted and where its sign stands.
    Sum(Vec<(Tree, bool, usize)>),
    /// Factors, and of each whether it divides and where its sign stands.
    Product(Vec<(Tree, bool, usize)>),
    Negative(Box<Tree>),
    Power(Box<[Tree; 2]>),
    Component(Box<Tree>, Vec<usize>),
    Call(String, Vec<Tree>),
}

#[derive(Clone, Debug)]
struct Token {
    /// `0` of a number, `a` of a name, a blank of the end, else the sign itself.
    kind: char,
    text: String,
    position: usize,
}

/// The tree of a formula.
pub(super) fn parse(text: &str) -> Result<Tree, Refusal> {
    let length = text.chars().count();
    if length > MAX_CHARACTERS {
        let message =
            format!("a formula must have at most {MAX_CHARACTERS} characters; got {length}. Use vectors to shorten it");
        return Err(Refusal::new(message, text, 0));
    }
    tree(text, MAX_DIGITS)
}

/// The tree of a formula that a program has printed: of any length, with numbers of any length.
pub(super) fn parse_printed(text: &str) -> Result<Tree, Refusal> {
    tree(text, usize::MAX)
}

fn tree(text: &str, max_digits: usize) -> Result<Tree, Refusal> {
    let mut parser = Parser { text, tokens: tokens(text)?, next: 0, nesting: 0, max_digits };
    if parser.at(" ") {
        return Err(parser.error("a formula is empty. Write for example dot(l, l)/2"));
    }
    let tree = parser.sum()?;
    if parser.at(" ") { Ok(tree) } else { Err(parser.unexpected()) }
}

fn tokens(text: &str) -> Result<Vec<Token>, Refusal> {
    let letters: Vec<char> = text.chars().collect();
    let mut tokens = vec![];
    let mut at = 0;
    while let Some(&first) = letters.get(at) {
        let start = at;
        let digits = |mut at: usize| {
            while letters.get(at).is_some_and(char::is_ascii_digit) {
                at += 1;
            }
            at
        };
        let followed_by_digit = |at: usize| letters.get(at + 1).is_some_and(char::is_ascii_digit);
        let kind = match first {
            ' ' | '\t' | '\r' | '\n' => {
                at += 1;
                continue;
            }
            _ if first.is_ascii_digit() || first == '.' && followed_by_digit(at) => {
                at = digits(at);
                if letters.get(at) == Some(&'.') {
                    at = digits(at + 1);
                }
                if matches!(letters.get(at), Some('e' | 'E')) {
                    let sign = usize::from(matches!(letters.get(at + 1), Some('+' | '-')));
                    let end = digits(at + 1 + sign);
                    at = if end > at + 1 + sign { end } else { at };
                }
                '0'
            }
            _ if first.is_ascii_alphabetic() || first == '_' => {
                while letters.get(at).is_some_and(|&letter| letter.is_ascii_alphanumeric() || letter == '_') {
                    at += 1;
                }
                'a'
            }
            '*' if letters.get(at + 1) == Some(&'*') => {
                at += 2;
                '^'
            }
            '-' | '+' | '*' | '/' | '^' | '(' | ')' | '[' | ']' | ',' => {
                at += 1;
                first
            }
            _ => {
                let hint = character_instead(first);
                let message = format!("{} has no meaning here. {hint}", quoted(&first.to_string()));
                return Err(Refusal::new(message, text, at));
            }
        };
        tokens.push(Token { kind, text: letters[start..at].iter().collect(), position: start });
    }
    tokens.push(Token { kind: ' ', text: String::new(), position: letters.len() });
    Ok(tokens)
}

/// Recursive descent over the tokens; each rule of the grammar is a method.
struct Parser<'t> {
    text: &'t str,
    tokens: Vec<Token>,
    next: usize,
    nesting: usize,
    max_digits: usize,
}

type Rule<'t> = fn(&mut Parser<'t>) -> Result<Tree, Refusal>;

impl<'t> Parser<'t> {
    fn sum(&mut self) -> Result<Tree, Refusal> {
        self.chain("+-", '-', Parser::product, Part::Sum)
    }

    fn product(&mut self) -> Result<Tree, Refusal> {
        self.chain("*/", '/', Parser::factor, Part::Product)
    }

    /// Parts with signs between them; `inverse` is the sign that subtracts or divides.
    fn chain(
        &mut self,
        signs: &str,
        inverse: char,
        rule: Rule<'t>,
        make: fn(Vec<(Tree, bool, usize)>) -> Part,
    ) -> Result<Tree, Refusal> {
        let first = rule(self)?;
        if !self.at(signs) {
            return Ok(first);
        }
        let position = self.token().position;
        let start = first.position;
        let mut parts = vec![(first, false, start)];
        while self.at(signs) {
            let sign = self.take();
            parts.push((rule(self)?, sign.kind == inverse, sign.position));
        }
        Ok(Tree { position, part: make(parts) })
    }

    fn factor(&mut self) -> Result<Tree, Refusal> {
        if !self.at("+-") {
            return self.power();
        }
        let sign = self.take();
        let child = self.nested(Parser::factor, &sign)?;
        let negative = |child| Tree { position: sign.position, part: Part::Negative(Box::new(child)) };
        Ok(if sign.kind == '+' { child } else { negative(child) })
    }

    fn power(&mut self) -> Result<Tree, Refusal> {
        let base = self.component()?;
        if !self.at("^") {
            return Ok(base);
        }
        let sign = self.take();
        let exponent = self.nested(Parser::factor, &sign)?;
        Ok(Tree { position: sign.position, part: Part::Power(Box::new([base, exponent])) })
    }

    fn component(&mut self) -> Result<Tree, Refusal> {
        let atom = self.atom()?;
        if !self.at("[") {
            return Ok(atom);
        }
        let bracket = self.take();
        let mut indices = vec![self.index()?];
        while self.at(",") {
            self.take();
            indices.push(self.index()?);
        }
        self.expect(']', &bracket)?;
        if self.at("[") {
            return Err(self.error("a component has no components. Write A[1,2] for an entry of a matrix"));
        }
        Ok(Tree { position: bracket.position, part: Part::Component(Box::new(atom), indices) })
    }

    fn index(&mut self) -> Result<usize, Refusal> {
        let token = self.token();
        let is_whole = token.kind == '0' && token.text.bytes().all(|byte| byte.is_ascii_digit());
        match token.text.parse::<usize>() {
            Ok(index) if is_whole && token.text.len() <= 6 && index >= 1 => {
                self.take();
                Ok(index)
            }
            _ => {
                let got = shown(token);
                Err(self.error(format!("an index is a whole number from 1 on; got {got}. Write for example l[1]")))
            }
        }
    }

    fn atom(&mut self) -> Result<Tree, Refusal> {
        let token = self.token().clone();
        match token.kind {
            '0' => {
                self.take();
                Ok(Tree { position: token.position, part: Part::Number(self.number(&token)?) })
            }
            'a' => {
                self.take();
                self.name(token)
            }
            '(' => {
                self.take();
                let inside = self.nested(Parser::sum, &token)?;
                self.expect(')', &token)?;
                Ok(inside)
            }
            _ => {
                let got = shown(&token);
                let message = format!("a number, a name or a bracket is wanted here; got {got}. Complete the formula");
                Err(self.error(message))
            }
        }
    }

    fn name(&mut self, token: Token) -> Result<Tree, Refusal> {
        if token.text.len() > MAX_NAME {
            let length = token.text.len();
            let message = format!("a name must have at most {MAX_NAME} characters; got {length}. Shorten it");
            return Err(Refusal::new(message, self.text, token.position));
        }
        if !self.at("(") {
            return Ok(Tree { position: token.position, part: Part::Name(token.text) });
        }
        let bracket = self.take();
        let mut arguments = vec![];
        if !self.at(")") {
            arguments.push(self.nested(Parser::sum, &bracket)?);
        }
        while self.at(",") {
            self.take();
            arguments.push(self.nested(Parser::sum, &bracket)?);
        }
        self.expect(')', &bracket)?;
        Ok(Tree { position: token.position, part: Part::Call(token.text, arguments) })
    }

    fn number(&self, token: &Token) -> Result<Rational, Refusal> {
        let lower = token.text.to_lowercase();
        let (mantissa, exponent) = lower.split_once('e').unwrap_or((&lower, "0"));
        let n_digits = mantissa.bytes().filter(u8::is_ascii_digit).count();
        if n_digits > self.max_digits || exponent.trim_start_matches(['+', '-']).len() > 3 {
            let message = format!("a number must have at most {MAX_DIGITS} digits, and 3 in its exponent. Shorten it");
            return Err(Refusal::new(message, self.text, token.position));
        }
        Ok(Rational::decimal(mantissa, exponent.parse().unwrap_or(0)))
    }

    fn token(&self) -> &Token {
        &self.tokens[self.next]
    }

    fn at(&self, kinds: &str) -> bool {
        kinds.contains(self.token().kind)
    }

    fn take(&mut self) -> Token {
        self.next += 1;
        self.tokens[self.next - 1].clone()
    }

    /// A rule one level deeper; the limit keeps the stack from overflowing.
    fn nested(&mut self, rule: Rule<'t>, token: &Token) -> Result<Tree, Refusal> {
        self.nesting += 1;
        if self.nesting > MAX_NESTING {
            let message = format!("a formula must be nested at most {MAX_NESTING} levels deep. Simplify it");
            return Err(Refusal::new(message, self.text, token.position));
        }
        let tree = rule(self)?;
        self.nesting -= 1;
        Ok(tree)
    }

    fn expect(&mut self, kind: char, opened: &Token) -> Result<(), Refusal> {
        if self.token().kind == kind {
            self.take();
            return Ok(());
        }
        if self.at(" ") {
            let message = format!("this '{}' is never closed. Add '{kind}'", opened.kind);
            return Err(Refusal::new(message, self.text, opened.position));
        }
        Err(self.unexpected())
    }

    /// Why no formula goes on with the present token.
    fn unexpected(&self) -> Refusal {
        let token = self.token();
        let before = if self.next > 0 { &self.tokens[self.next - 1] } else { token };
        if "0a(".contains(token.kind) && "0a)]".contains(before.kind) {
            let short = |text: &str| text.chars().take(20).collect::<String>();
            return self.error(format!(
                "a product needs its sign. Write {}*{}",
                short(&before.text),
                short(&token.text)
            ));
        }
        if token.kind == ',' && before.kind == '0' {
            return self.error("',' is not expected here. Write decimals with a point: 0.5");
        }
        let got = shown(token);
        self.error(format!("{got} is not expected here. Remove it, or write what belongs before it"))
    }

    fn error(&self, message: impl Into<String>) -> Refusal {
        Refusal::new(message, self.text, self.token().position)
    }
}

fn shown(token: &Token) -> String {
    if token.kind == ' ' {
        return "the end of the formula".to_owned();
    }
    quoted(&token.text.chars().take(40).collect::<String>())
}
