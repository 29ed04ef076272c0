//! Reports of commands in the requested format.
//!
//! A command computes a report: an object for programs, and a document for people, which is printed as text, Markdown,
//! HTML or LaTeX.

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::cli::error::CliError;
use wildfire_base::document::Document;

/// The format that a report is printed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ReportFormat {
    #[default]
    Text,
    Json,
    #[value(alias = "markdown")]
    Md,
    Html,
    #[value(alias = "latex")]
    Tex,
}

/// The option that selects the format of a report, and a flag for each format, as earlier versions had them.
#[derive(Clone, Copy, Debug, Default, Args)]
#[group(id = "report_form", multiple = false)]
pub struct FormArguments {
    /// Print the report as text, a JSON object with all computed values, Markdown, a web page or LaTeX [default: text].
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<ReportFormat>,
    #[arg(long, hide = true)]
    json: bool,
    #[arg(long, hide = true)]
    md: bool,
    #[arg(long, hide = true)]
    html: bool,
    #[arg(long, hide = true)]
    tex: bool,
}

impl FormArguments {
    /// Returns the requested format.
    pub fn format(self) -> ReportFormat {
        match self {
            Self { format: Some(format), .. } => format,
            Self { json: true, .. } => ReportFormat::Json,
            Self { md: true, .. } => ReportFormat::Md,
            Self { html: true, .. } => ReportFormat::Html,
            Self { tex: true, .. } => ReportFormat::Tex,
            _ => ReportFormat::Text,
        }
    }

    /// Returns whether the report is text for a terminal; the other formats are input for programs.
    pub fn is_text(self) -> bool {
        self.format() == ReportFormat::Text
    }

    /// Returns whether the report is a JSON object.
    pub fn is_json(self) -> bool {
        self.format() == ReportFormat::Json
    }

    /// Refuses JSON beside an option that prints text as well.
    pub fn expect_no_json_with(self, option: &str, is_set: bool) -> Result<(), CliError> {
        if !(is_set && self.is_json()) {
            return Ok(());
        }
        Err(CliError::bad_input(format_args!("{option} prints text; expected another format than json with it"), None))
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
        match self.format() {
            ReportFormat::Text => document().to_text(),
            ReportFormat::Json => serde_json::to_string(object).expect("names, numbers and words are JSON") + "\n",
            ReportFormat::Md => document().to_markdown(),
            ReportFormat::Html => document().to_html(),
            ReportFormat::Tex => document().to_latex(),
        }
    }
}
