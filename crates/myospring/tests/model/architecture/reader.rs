//! What a Rust file declares and which paths stand in it, from its tokens; tests are left out.

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

/// A module of a file: the file itself, or one written inside it.
pub(super) type Scope = Vec<String>;

/// A path as it is written, in a `use` or in code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Written {
    /// The modules within the file around it.
    pub(super) scope: Scope,
    /// Its segments; `*` ends one that takes all names.
    pub(super) path: Vec<String>,
    /// What a `use` gives a name to.
    pub(super) bound: Option<Bound>,
}

/// The name that a `use` gives.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Bound {
    pub(super) name: String,
    /// Whether others may use it (`pub`, `pub(super)`).
    pub(super) passed_on: bool,
}

/// All of a file.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Reading {
    /// Modules that are files of their own: `mod name;`.
    pub(super) files: Vec<String>,
    /// Modules written inside the file, by their place in it.
    pub(super) inline: Vec<Scope>,
    pub(super) written: Vec<Written>,
}

/// Reads the text of a file.
pub(super) fn read(text: &str) -> Reading {
    let mut reading = Reading::default();
    reading.walk(text.parse().unwrap(), &Vec::new());
    reading
}

impl Reading {
    fn walk(&mut self, tokens: TokenStream, scope: &Scope) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            at = self.step(&tokens, at, scope);
        }
    }

    /// Reads what begins at a token; where the next begins.
    fn step(&mut self, tokens: &[TokenTree], at: usize, scope: &Scope) -> usize {
        if is_only_for_tests(tokens, at) {
            return end_of_item(tokens, at + 2);
        }
        match &tokens[at] {
            TokenTree::Group(group) => {
                // `pub(in crate::cell)` says who may look, and uses nothing.
                if !(at > 0 && is_word(&tokens[at - 1], "pub") && is_visibility(group)) {
                    self.walk(group.stream(), scope);
                }
                at + 1
            }
            TokenTree::Ident(word) if word == "mod" => {
                let name = tokens[at + 1].to_string();
                if let Some(TokenTree::Group(body)) = tokens.get(at + 2) {
                    let inside = [scope.as_slice(), &[name]].concat();
                    self.walk(body.stream(), &inside);
                    self.inline.push(inside);
                } else {
                    self.files.push(name);
                }
                at + 3
            }
            // Not `impl Iterator + use<>`, which takes lifetimes.
            TokenTree::Ident(word) if word == "use" && !is_mark(tokens.get(at + 1), '<') => {
                let end = (at..tokens.len()).find(|end| is_mark(tokens.get(*end), ';')).unwrap();
                let passed_on = at > 0
                    && (is_word(&tokens[at - 1], "pub")
                        || (at > 1 && is_word(&tokens[at - 2], "pub")));
                self.tree(&tokens[at + 1..end], Vec::new(), scope, passed_on);
                end + 1
            }
            TokenTree::Ident(first) if is_join(tokens, at + 1) => {
                let (mut path, mut next) = (vec![first.to_string()], at + 1);
                while is_join(tokens, next) {
                    let Some(TokenTree::Ident(word)) = tokens.get(next + 2) else { break };
                    path.push(word.to_string());
                    next += 3;
                }
                // `<T as Trait>::Item::x` begins before it.
                if at < 2 || !is_join(tokens, at - 2) {
                    self.written.push(Written { scope: scope.clone(), path, bound: None });
                }
                next
            }
            _ => at + 1,
        }
    }

    /// Reads a tree of `use`: `a::b`, `a::b as c`, `a::*`, `a::{self, b::{c, d}}`.
    fn tree(&mut self, tokens: &[TokenTree], mut path: Scope, scope: &Scope, passed_on: bool) {
        let mut name = None;
        for (at, token) in tokens.iter().enumerate() {
            match token {
                TokenTree::Group(group) => {
                    let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                    for part in inner.split(|token| is_mark(Some(token), ',')) {
                        self.tree(part, path.clone(), scope, passed_on);
                    }
                    return;
                }
                TokenTree::Ident(word) if word == "as" => {
                    name = tokens.get(at + 1).map(ToString::to_string);
                    break;
                }
                TokenTree::Ident(word) => path.push(word.to_string()),
                _ if is_mark(Some(token), '*') => path.push("*".to_owned()),
                _ => {}
            }
        }
        // Behind the last comma of a group there is nothing.
        if tokens.is_empty() {
            return;
        }
        path.pop_if(|last| last == "self");
        let name = name.or_else(|| path.last().cloned()).unwrap();
        let bound = Some(Bound { name, passed_on });
        self.written.push(Written { scope: scope.clone(), path, bound });
    }
}

fn is_word(token: &TokenTree, word: &str) -> bool {
    matches!(token, TokenTree::Ident(ident) if ident == word)
}

fn is_mark(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == mark)
}

/// Whether `::` stands here.
fn is_join(tokens: &[TokenTree], at: usize) -> bool {
    is_mark(tokens.get(at), ':') && is_mark(tokens.get(at + 1), ':')
}

fn is_visibility(group: &Group) -> bool {
    let first = group.stream().into_iter().next();
    let words = ["crate", "super", "self", "in"];
    group.delimiter() == Delimiter::Parenthesis
        && first.is_some_and(|first| words.iter().any(|word| is_word(&first, word)))
}

/// Whether `#[cfg(test)]` stands here.
fn is_only_for_tests(tokens: &[TokenTree], at: usize) -> bool {
    let attribute = tokens.get(at + 1).map(|token| token.to_string().replace(' ', ""));
    is_mark(tokens.get(at), '#') && attribute.as_deref() == Some("[cfg(test)]")
}

/// Behind the item, field or statement that begins here.
fn end_of_item(tokens: &[TokenTree], at: usize) -> usize {
    let ends = |token: &TokenTree| match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        token => is_mark(Some(token), ';') || is_mark(Some(token), ','),
    };
    (at..tokens.len()).find(|end| ends(&tokens[*end])).map_or(tokens.len(), |end| end + 1)
}
