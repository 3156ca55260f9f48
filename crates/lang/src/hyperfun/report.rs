//! Places in the text, and what was found wrong there.

use crate::diagnostic::{Diagnostic, MAX_ERRORS, MAX_WARNINGS, Severity};
use std::ops::Range;

/// Bytes of the source.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Span {
    pub(super) start: u32,
    pub(super) end: u32,
}

impl Span {
    pub(super) fn new(start: usize, end: usize) -> Self {
        Self { start: start as u32, end: end as u32 }
    }

    /// From the beginning of this one to the end of the other.
    pub(super) fn to(self, end: Span) -> Self {
        Self { start: self.start, end: end.end }
    }

    /// The empty place behind.
    pub(super) fn after(self) -> Self {
        Self { start: self.end, end: self.end }
    }

    pub(super) fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// The messages so far, each said once.
#[derive(Default)]
pub(super) struct Report {
    list: Vec<Diagnostic>,
    errors: usize,
}

impl Report {
    pub(super) fn add(&mut self, diagnostic: Diagnostic) {
        let is_error = diagnostic.severity == Severity::Error;
        let warnings = self.list.len() - self.errors;
        let full = if is_error { self.is_full() } else { warnings >= MAX_WARNINGS };
        if full || self.list.iter().any(|d| d.span == diagnostic.span && d.message == diagnostic.message) {
            return;
        }
        self.errors += usize::from(is_error);
        self.list.push(diagnostic);
    }

    pub(super) fn error(&mut self, span: Span, message: impl Into<String>, label: impl Into<String>) {
        self.add(Diagnostic::error(span.range(), message, label));
    }

    pub(super) fn is_full(&self) -> bool {
        self.errors >= MAX_ERRORS
    }

    pub(super) fn has_errors(&self) -> bool {
        self.errors > 0
    }

    pub(super) fn error_count(&self) -> usize {
        self.errors
    }

    /// The messages in the order of the text.
    pub(super) fn into_list(mut self) -> Vec<Diagnostic> {
        self.list.sort_by_key(|d| d.span.start);
        self.list
    }
}
