//! Reports on a finished batch: tables and figures, the champion, failures, and the result of the audit.

mod audits;
mod failures;
mod finish;
mod html_report;
mod json;
mod notes;
mod opening;
mod profile;
mod summary;
mod tables;
mod tally;

pub use audits::{AuditOptions, AuditReport, AuditSource, AuditsError, LISTED_VIOLATIONS, ListedViolation, audit_all};
pub use failures::Failures;
pub use finish::{Merged, merge, read_report, read_rows};
pub use html_report::{
    ChartData, Facet, FacetSeries, FieldPicture, MAX_PANELS, NotableRun, PaperCharts, ReportError, ReportParts,
    SelectedQuantities, WrittenReport, notable_runs, runs_with_pages, word_facets, write_chart, write_chart_data,
    write_paper_chart, write_report,
};
pub use json::RunObject;
pub use notes::notes;
pub use summary::{BatchReport, VariantReport};
pub use tables::{SHOWN_RUNS, Tables};
pub use tally::Tally;
