//! Reports of commands in the requested format.
//!
//! A command computes a report: an object for programs, and a document for people, which is printed as text, Markdown,
//! HTML or LaTeX.

use clap::Args;
use serde::Serialize;

use wildfire_base::document::Document;

/// The form that a report is printed in, text unless another is asked for.
#[derive(Clone, Copy, Debug, Default, Args)]
#[group(id = "report_form", multiple = false)]
pub struct FormArguments {
    /// Print the report as one JSON object, with all computed values.
    #[arg(help_heading = "Output", long)]
    pub json: bool,
    /// Print the report as Markdown.
    #[arg(help_heading = "Output", long)]
    pub md: bool,
    /// Print the report as a self-contained web page.
    #[arg(help_heading = "Output", long)]
    pub html: bool,
    /// Print the report as LaTeX, for \input in a paper.
    #[arg(help_heading = "Output", long)]
    pub tex: bool,
}

impl FormArguments {
    /// Returns whether the report is text for a terminal; the other formats are input for programs.
    pub fn is_text(self) -> bool {
        !(self.json || self.md || self.html || self.tex)
    }

    /// Prints a report in this form, into a string.
    pub fn render<R: Serialize>(self, report: &R) -> String
    where
        for<'r> &'r R: Into<Document>,
    {
        self.render_either(report, || report.into())
    }

    /// Prints either the object or the document in this form, into a string.
    pub fn render_either(self, object: &impl Serialize, document: impl FnOnce() -> Document) -> String {
        if self.json {
            return serde_json::to_string(object).expect("names, numbers and words are JSON") + "\n";
        }
        let document = document();
        match self {
            Self { md: true, .. } => document.to_markdown(),
            Self { html: true, .. } => document.to_html(),
            Self { tex: true, .. } => document.to_latex(),
            _ => document.to_text(),
        }
    }
}
