//! Numbers that are never used twice.

use super::Offset;
use crate::api::Token;
use serde::{Deserialize, Serialize};

/// The highest used so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Numbers {
    token: u64,
    passage: u64,
}

impl Numbers {
    pub fn token(&self) -> Token {
        Token(self.token)
    }

    pub fn passage(&self) -> u64 {
        self.passage
    }

    pub fn next_token(&mut self) -> Token {
        self.token += 1;
        Token(self.token)
    }

    /// What was numbered after a token was not sent: those numbers are free again.
    pub fn back_to(&mut self, token: Token) {
        self.token = token.0;
    }

    /// Tokens up to this one are used.
    pub fn token_used(&mut self, token: Token) {
        self.token = self.token.max(token.0);
    }

    /// Passages up to this one are used.
    pub fn passage_used(&mut self, passage: u64) {
        self.passage = self.passage.max(passage);
    }

    pub fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        let Self { token, passage } = self;
        offset.token(Token(*token), other.token()) && offset.passage(*passage, other.passage)
    }
}
