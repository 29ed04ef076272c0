#![doc = include_str!("../README.md")]
//!
//! Many runs: the plan, workers, a journal that loses nothing, tables in the order of the plan.
//!
//! A [`BatchPlan`] lists the runs. A [`Batch`] executes them on several threads and keeps a journal with a line for each
//! finished one; the tables are written from the journal when all have finished. So a batch can be stopped at any moment and
//! resumed, and each run adds only a few bytes of memory. Apart from its `cpu_` and `wall_` columns, a row never depends on
//! the number of workers, on slices or on interruptions. A run that fails or panics is a row like the others, with the
//! reason.
//!
//! Four modules, each of which imports only those before it, and five more beside the last:
//! - `plan`: the runs, frozen in `plan.json`;
//! - `execute`: workers, the journal and its folder; each run yields a [`RunRow`];
//! - `table`: the columns, the files written from them, and the reader of these files;
//! - `report`: reports on one batch, from its summary to its page of charts, and its audit;
//! - `maps`: results of a batch for every cell of the field;
//! - `decisions`: what the decisions of a run were worth;
//! - `drives`: queries to planners outside of runs, their table and their summary;
//! - [`comparison`]: comparisons of batches, including those of other versions of the program;
//! - [`arena`]: frozen tracks, and boards of entries on them.

pub mod arena;
pub mod comparison;
mod decisions;
mod drives;
mod execute;
mod maps;
mod plan;
mod report;
pub mod stats;
mod table;

pub use decisions::{
    AlternativeAction, Answers, DecisionTally, DecisionValue, HindsightBound, JudgeError, JudgeProgress,
    SelectedDecisions, WhyReport, attain, attain_all, judge_batch,
};
#[doc(hidden)]
pub use drives::made_up_drives;
pub use drives::{
    Attempt, AttemptSettings, COMPARED, DRIVE_COLUMNS, DRIVE_LEGEND, DriveColumn, DriveContrast, DriveError,
    DriveFailure, DriveProblems, DriveQuery, DriveRequest, DriveTable, INTERVAL_LEGEND, MAX_QUERIES, MEASURES, Measure,
    PlannerSummary, QueryCost, ask_all, attempts, contrast_table, custom_names, expect_planners_exist,
    failure_sentences, interval_tables, missed, queries_text, requested_planners, rows_table, shortened_field,
    summary_table, violation_sentences,
};
pub use execute::{
    AGENTS_FILE, Append, Batch, BatchError, BatchStatus, CALLS_PARQUET, CHARTS_FOLDER, CpuSplit, DECISIONS_PARQUET,
    Disk, FailedRuns, Found, JournalError, JournalIndex, JournalKeeping, JournalScan, Lock, LostRecording, Machine,
    Machines, MissingRuns, OutputFolder, Pilot, PlannerCall, RECORDINGS_FOLDER, REPORT_FILE, RUNS_FILE, RUNS_PARQUET,
    RealDisk, RunDetail, RunEnd, RunResult, RunRow, RunScenario, STATE_STEPS, STATES_PARQUET, SliceState, Solution,
    StateCount, Status, TABLES_FILE, UnexpectedFile, Whole, batch_status, file_name_of, limit_threads, with_threads,
};
pub use maps::{
    BatchMaps, BatchQuantity, BatchSide, Losses, MapDifference, MapSource, MapsError, MapsOptions, RunMean, map_batches,
};
pub use plan::{
    BatchPlan, BatchRequest, COMMIT, COMPILER, CONDITION_COLUMN, CourseError, CoursePlan, CourseRefusal, CourseRequest,
    EntryCard, LONG_VERSION, MAX_RUNS, MAX_SEEDS_BYTES, MAX_SLICES, MAX_VARIANTS, PLAN_FILE, PLAN_TEMPLATE,
    PLANNER_KEY, PROGRAM_VERSION, PlanError, PlanWriter, PlannedRun, RUNS_WITHOUT_FORCE, Record, RequestError,
    RunLabel, Seeds, SeedsError, Setting, Slice, SliceError, Sweep, SweepError, Value, Variant, plan_schema,
    planner_of, range_text, rules_schema, shell_word,
};
pub use report::{
    AuditOptions, AuditReport, AuditSource, AuditsError, BatchReport, ChartData, Facet, FacetSeries, Failures,
    FieldPicture, LISTED_VIOLATIONS, ListedViolation, MAX_PANELS, Merged, NotableRun, PaperCharts, ReportError,
    ReportParts, RunObject, SHOWN_RUNS, SelectedQuantities, Tables, Tally, VariantReport, WrittenReport, audit_all,
    merge, notable_runs, notes, read_report, read_rows, runs_with_pages, word_facets, write_chart, write_chart_data,
    write_paper_chart, write_report,
};
pub use table::{
    AGENT_COLUMNS, AgentColumn, AgentRow, CALL_COLUMNS, COLUMNS_BEFORE_SWEPT, CallColumn, Column, FileColumn,
    FinishedBatch, FinishedError, Kind, QueryTally, RUN_COLUMNS, RunColumn, RunRecord, STATE_COLUMNS, StateColumn,
    TableError, TableOfRows, TableReader, Unit, is_measured, recordings_in, row_schema, run_column, swept_columns,
};
