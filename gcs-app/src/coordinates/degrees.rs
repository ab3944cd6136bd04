//! Latitude and longitude in degrees: decimal, with minutes, with seconds; signs or letters; as charts write them.

use geometry::LatLon;

/// A piece of a text.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Token {
    Number {
        value: f64,
        signed: bool,
        /// Digits before the point.
        digits: usize,
    },
    /// N, S, E or W.
    Letter(char),
    /// A comma or the like between the two angles.
    Break,
}

/// `None`: it is something else.
pub(super) fn read(text: &str) -> Option<LatLon> {
    let tokens = tokens(text)?;
    let (first, second) = halves(&tokens)?;
    let (a, b) = (Angle::of(first)?, Angle::of(second)?);
    let (lat, lon) = match (a.letter, b.letter) {
        (Some('N' | 'S'), Some('E' | 'W')) | (None, None) => (a, b),
        (Some('E' | 'W'), Some('N' | 'S')) => (b, a),
        _ => return None,
    };
    let at = LatLon::new(lat.degrees(2)?, lon.degrees(3)?);
    at.is_valid().then_some(at)
}

fn tokens(text: &str) -> Option<Vec<Token>> {
    let text = text.to_ascii_uppercase();
    let mut rest = text.as_str();
    let mut tokens = Vec::new();
    while let Some(c) = rest.chars().next() {
        let is_number = |c: char| c.is_ascii_digit() || c == '.';
        if is_number(c) || matches!(c, '-' | '+' | '−') {
            let sign = if is_number(c) { 0 } else { c.len_utf8() };
            let (_, body) = rest.split_at_checked(sign)?;
            let (number, behind) = body.split_at(body.find(|c| !is_number(c)).unwrap_or(body.len()));
            let value: f64 = number.parse().ok()?;
            let value = if matches!(c, '-' | '−') { -value } else { value };
            let digits = number.find('.').unwrap_or(number.len());
            tokens.push(Token::Number { value, signed: sign > 0, digits });
            rest = behind;
            continue;
        }
        match c {
            'N' | 'S' | 'E' | 'W' => tokens.push(Token::Letter(c)),
            ',' | ';' | '/' => tokens.push(Token::Break),
            '°' | 'º' | '\'' | '′' | '’' | '"' | '″' | '”' | ':' | ' ' | '\t' => {}
            _ => return None,
        }
        rest = rest.get(c.len_utf8()..)?;
    }
    Some(tokens)
}

/// The two angles: between letters, at the comma, or in the middle.
fn halves(tokens: &[Token]) -> Option<(&[Token], &[Token])> {
    let is_letter = |token: &Token| matches!(token, Token::Letter(_));
    if let Some(at) = tokens.iter().position(|token| *token == Token::Break) {
        let (first, second) = tokens.split_at(at);
        return Some((first, second.get(1..)?));
    }
    if tokens.first().is_some_and(is_letter) {
        let second = tokens.iter().skip(1).position(is_letter)? + 1;
        return Some(tokens.split_at(second));
    }
    if let Some(first) = tokens.iter().position(is_letter) {
        return tokens.split_at_checked(first + 1);
    }
    (tokens.len().is_multiple_of(2)).then(|| tokens.split_at(tokens.len() / 2))
}

/// Up to three numbers, and a letter before or behind them.
struct Angle {
    letter: Option<char>,
    numbers: Vec<(f64, bool, usize)>,
}

impl Angle {
    fn of(tokens: &[Token]) -> Option<Self> {
        let mut angle = Self { letter: None, numbers: Vec::new() };
        for (index, token) in tokens.iter().enumerate() {
            match token {
                Token::Number { value, signed, digits } => angle.numbers.push((*value, *signed, *digits)),
                Token::Letter(c) if angle.letter.is_none() && (index == 0 || index + 1 == tokens.len()) => {
                    angle.letter = Some(*c);
                }
                Token::Letter(_) | Token::Break => return None,
            }
        }
        let signs = angle.numbers.iter().filter(|(_, signed, _)| *signed).count();
        let first = angle.numbers.first()?;
        // a sign belongs before the degrees, and not beside a letter
        let is_plain = signs == 0 || (signs == 1 && first.1 && angle.letter.is_none());
        (is_plain && angle.numbers.len() <= 3).then_some(angle)
    }

    /// `whole`: how many digits whole degrees have where minutes follow without a space.
    fn degrees(&self, whole: usize) -> Option<f64> {
        let values: Vec<f64> = match self.numbers.as_slice() {
            [(value, _, digits)] if self.letter.is_some() && *digits >= whole + 2 => {
                packed(*value, *digits - whole)?
            }
            numbers => numbers.iter().map(|(value, ..)| *value).collect(),
        };
        let (last, before) = values.split_last()?;
        let is_part = |x: f64| (0.0..60.0).contains(&x);
        if before.iter().any(|x| x.fract() != 0.0) || values.iter().skip(1).any(|x| !is_part(*x)) {
            return None;
        }
        let negative = values.first()?.is_sign_negative() || matches!(self.letter, Some('S' | 'W'));
        let shares = [1.0, 60.0, 3600.0];
        let sum = before.iter().chain([last]).zip(shares).map(|(x, share)| x.abs() / share).sum::<f64>();
        Some(if negative { -sum } else { sum })
    }
}

/// `363224` is 36, 32, 24; `3632.4` is 36, 32.4.
fn packed(value: f64, digits_behind: usize) -> Option<Vec<f64>> {
    match digits_behind {
        2 => Some(vec![(value / 100.0).floor(), value % 100.0]),
        4 => Some(vec![(value / 10_000.0).floor(), (value / 100.0).floor() % 100.0, value % 100.0]),
        _ => None,
    }
}
