//! JSON as descriptions are written in it: read strictly, without recursion beyond a fixed depth.

/// Lists within lists; a description needs five.
const DEEPEST: usize = 16;

/// What a text says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Null,
    Flag(bool),
    Number(f64),
    Text(String),
    List(Vec<Value>),
    Record(Vec<(String, Value)>),
}

/// Reads a text, or says what is wrong, and where.
pub(crate) fn read(text: &[u8]) -> Result<Value, String> {
    let text = std::str::from_utf8(text).map_err(|error| format!("no UTF-8 after {} bytes", error.valid_up_to()))?;
    let mut reader = Reader { text, at: 0, depth: 0 };
    let value = reader.value()?;
    reader.skip_space();
    if reader.at < text.len() { Err(reader.wrong("nothing more")) } else { Ok(value) }
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
}

impl Reader<'_> {
    fn next(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip_space(&mut self) {
        while matches!(self.next(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    fn wrong(&self, wanted: &str) -> String {
        match self.text.get(self.at..).and_then(|rest| rest.chars().next()) {
            Some(got) => format!("wanted {wanted} at character {}; got {got:?}", self.at),
            None => format!("wanted {wanted}; the text ends after {} characters", self.at),
        }
    }

    /// Whether a sign comes next, which is then read.
    fn takes(&mut self, sign: u8) -> bool {
        self.skip_space();
        let is_next = self.next() == Some(sign);
        self.at += usize::from(is_next);
        is_next
    }

    fn word(&mut self, word: &str, value: Value) -> Result<Value, String> {
        if !self.text[self.at..].starts_with(word) {
            return Err(self.wrong(word));
        }
        self.at += word.len();
        Ok(value)
    }

    fn value(&mut self) -> Result<Value, String> {
        self.skip_space();
        match self.next() {
            Some(b'[') => self.deeper(Reader::list),
            Some(b'{') => self.deeper(Reader::record),
            Some(b'"') => self.string().map(Value::Text),
            Some(b'-' | b'0'..=b'9') => self.number(),
            Some(b't') => self.word("true", Value::Flag(true)),
            Some(b'f') => self.word("false", Value::Flag(false)),
            Some(b'n') => self.word("null", Value::Null),
            _ => Err(self.wrong("a value")),
        }
    }

    fn deeper(&mut self, read: fn(&mut Self) -> Result<Value, String>) -> Result<Value, String> {
        if self.depth == DEEPEST {
            return Err(format!("wanted at most {DEEPEST} lists within one another at character {}", self.at));
        }
        (self.depth, self.at) = (self.depth + 1, self.at + 1);
        let value = read(self);
        self.depth -= 1;
        value
    }

    fn list(&mut self) -> Result<Value, String> {
        let mut values = Vec::new();
        if self.takes(b']') {
            return Ok(Value::List(values));
        }
        loop {
            values.push(self.value()?);
            if self.takes(b']') {
                return Ok(Value::List(values));
            }
            if !self.takes(b',') {
                return Err(self.wrong("\",\" or \"]\""));
            }
        }
    }

    fn record(&mut self) -> Result<Value, String> {
        let mut entries = Vec::new();
        if self.takes(b'}') {
            return Ok(Value::Record(entries));
        }
        loop {
            self.skip_space();
            let name = self.string()?;
            if !self.takes(b':') {
                return Err(self.wrong("\":\""));
            }
            entries.push((name, self.value()?));
            if self.takes(b'}') {
                return Ok(Value::Record(entries));
            }
            if !self.takes(b',') {
                return Err(self.wrong("\",\" or \"}\""));
            }
        }
    }

    /// A text.
    fn string(&mut self) -> Result<String, String> {
        if self.next() != Some(b'"') {
            return Err(self.wrong("a text"));
        }
        self.at += 1;
        let mut text = String::new();
        loop {
            let start = self.at;
            let is_end = |&sign: &u8| matches!(sign, b'"' | b'\\') || sign < 0x20;
            let length = self.text.as_bytes()[start..].iter().position(is_end);
            self.at = length.map_or(self.text.len(), |length| start + length);
            text.push_str(&self.text[start..self.at]);
            match self.next() {
                Some(b'"') => {
                    self.at += 1;
                    return Ok(text);
                }
                Some(b'\\') => text.push(self.escaped()?),
                _ => return Err(self.wrong("the end of a text")),
            }
        }
    }

    /// A character that is written with a backslash.
    fn escaped(&mut self) -> Result<char, String> {
        let start = self.at;
        let digits = self.text.get(start + 2..start + 6);
        let code = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok()).and_then(char::from_u32);
        let (character, length) = match (self.text.as_bytes().get(start + 1), code) {
            (Some(b'n'), _) => ('\n', 2),
            (Some(b't'), _) => ('\t', 2),
            (Some(b'r'), _) => ('\r', 2),
            (Some(&sign @ (b'"' | b'\\' | b'/')), _) => (char::from(sign), 2),
            // halves of characters beyond the first 65536 have no code of their own, and need none: UTF-8 has these
            (Some(b'u'), Some(code)) => (code, 6),
            _ => return Err(self.wrong("\\n, \\t, \\r, \\\", \\\\, \\/ or \\u and four digits")),
        };
        self.at += length;
        Ok(character)
    }

    fn number(&mut self) -> Result<Value, String> {
        let start = self.at;
        let is_part = |sign: u8| matches!(sign, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E');
        while self.next().is_some_and(is_part) {
            self.at += 1;
        }
        match self.text[start..self.at].parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Value::Number(number)),
            _ => {
                self.at = start;
                Err(self.wrong("a finite number"))
            }
        }
    }
}
