//! A program that is asked for as long as a run lasts: greeted, shown its field, started again when it fails.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::backend::Backend;
use super::launch::{CpuLimit, Launch, ProcessError, ProcessErrorKind, QueryLimits};
use super::protocol::{FromProgram, ToProgram, VERSION};
use wildfire_base::time::wall::WallStopwatch;

/// Queries in a row over its instructions after which a module is given up for the rest of a run. All later ones count as one
/// over its instructions does, so that a module that loops has the same outcomes, and a run takes no hours.
const MAX_SPENT_IN_A_ROW: u32 = 10;

/// A program on a field, through failures and new starts.
#[derive(Debug)]
pub struct ExternalClient {
    program: Arc<Launch>,
    /// The line that shows it the field.
    field: Vec<u8>,
    /// `None` after a failure, until the next query.
    session: Option<ProgramSession>,
    /// Attempts to start it again that failed.
    failed_starts: u32,
    /// The last queries in a row in which a module ran out of instructions.
    spent_in_a_row: u32,
    /// CPU time up to the first `ready`.
    pub built: Option<Duration>,
}

/// A program that has said hello.
#[derive(Debug)]
pub struct ProgramSession {
    peer: Backend,
    /// Queries on this field: they are numbered from 1 on, so that a program may count them itself.
    queries: u64,
    /// Its CPU time that has been counted for something.
    counted: Duration,
    /// Instructions that a module may run until it is ready.
    start_instructions: u64,
}

/// Programs that play in more than one run and are free at the moment.
#[derive(Debug, Default)]
pub struct Idle(Mutex<Vec<IdleProgram>>);

/// A program without a run, and how it was started.
#[derive(Debug)]
pub struct IdleProgram {
    launch: Arc<Launch>,
    session: ProgramSession,
}

impl Idle {
    /// Takes a program that was started in the same way, if one is free.
    pub fn take(&self, launch: &Launch) -> Option<ProgramSession> {
        // No thread that panics leaves the list half changed.
        let mut idle = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = idle.iter().position(|other| *other.launch == *launch)?;
        Some(idle.swap_remove(found).session)
    }

    /// Takes a program back, unless it has failed.
    pub fn give_back(&self, respondent: ExternalClient) {
        if let Some(free) = respondent.into_idle() {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(free);
        }
    }
}

impl Drop for Idle {
    fn drop(&mut self) {
        let idle = std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner));
        idle.into_iter().for_each(|program| program.session.end());
    }
}

/// What came of a query.
#[derive(Debug)]
pub struct Reply {
    pub answer: Result<FromProgram, ProcessError>,
    /// CPU time of its processes since the answer before, if the system tells.
    pub cpu: Option<Duration>,
    /// The part of it in which the program started again.
    pub starting: Duration,
    /// Instructions of a module since the answer before.
    pub instructions: Option<u64>,
}

impl ExternalClient {
    /// Starts a program and shows it a field, or shows it to one that has played before.
    pub fn new(
        program: Arc<Launch>,
        field: &ToProgram<'_>,
        before: Option<ProgramSession>,
    ) -> Result<Self, ProcessError> {
        let field = field.line();
        // One that played before and cannot go on costs this run nothing but the time of finding out.
        let again = before.and_then(|session| session.play_again(&program, &field));
        let (session, built) = match again {
            Some(mut session) => {
                let built = session.elapsed_since_last();
                (session, built)
            }
            None => {
                let (started, built) = ProgramSession::start(&program, &field, program.start_instructions);
                let mut session = started?;
                // Its start has a budget of its own.
                session.peer.take_instructions();
                (session, built)
            }
        };
        Ok(Self { program, field, session: Some(session), failed_starts: 0, spent_in_a_row: 0, built })
    }

    /// Returns the expansions that a query counts for at least.
    pub fn expansions_per_query(&self) -> u32 {
        self.program.expansions_per_query
    }

    /// Asks a query, which is told its number, and checks that the answer is of a type that fits. A program that failed
    /// before is started again first.
    pub fn ask(
        &mut self,
        query: impl FnOnce(u64) -> Vec<u8>,
        check: impl FnOnce(&FromProgram) -> Result<(), &'static str>,
    ) -> Reply {
        // A program that never answers in time would cost its whole budget at every query.
        if self.spent_in_a_row == MAX_SPENT_IN_A_ROW {
            let budget = self.program.query_instructions;
            let message =
                format!("was given up after {MAX_SPENT_IN_A_ROW} queries in a row over {budget} instructions");
            let answer = Err(ProcessError { kind: ProcessErrorKind::BudgetSpent, message });
            return Reply { answer, cpu: None, starting: Duration::ZERO, instructions: Some(budget) };
        }
        let (running, started) = self.running();
        let starting = started.unwrap_or_default();
        let mut session = match running {
            Ok(session) => session,
            // The failed start has taken time too, which counts for this query.
            Err(error) => return Reply { answer: Err(error), cpu: started, starting, instructions: None },
        };
        session.queries += 1;
        let number = session.queries;
        let Launch { query_limit: wall, query_cpu, .. } = *self.program;
        // What it thought since its last answer counts for this one.
        let cpu = query_cpu.map(|limit| CpuLimit { limit, from: session.counted });
        let allowance = QueryLimits { wall, cpu, instructions: self.program.query_instructions, answer: "answer" };
        let answer = session.peer.exchange(&query(number), allowance);
        let answer = answer.and_then(|line| {
            let refuse = |reason: &str| Err(ProcessError::bad_answer(&line, reason));
            match FromProgram::parse(&line) {
                Err(reason) => refuse(&reason),
                Ok(answer) => match (check(&answer), answer.id()) {
                    (Err(reason), _) => refuse(reason),
                    // An answer to an earlier query, which this one must not get.
                    (Ok(()), Some(id)) if id != number => refuse(&format!("`id` is {id}; expected {number}")),
                    _ => Ok(answer),
                },
            }
        });
        let is_spent = answer.as_ref().is_err_and(|error| error.kind == ProcessErrorKind::BudgetSpent);
        self.spent_in_a_row = if is_spent { self.spent_in_a_row + 1 } else { 0 };
        // Of what cannot be understood the next line cannot be trusted to answer the next query.
        if answer.is_err() {
            session.peer.kill();
        }
        // After the kill, so that all it has taken counts.
        let cpu = session.elapsed_since_last().map(|elapsed_since_last| elapsed_since_last + starting);
        let instructions = session.peer.take_instructions();
        // Otherwise the next query starts the program again.
        if answer.is_ok() {
            self.session = Some(session);
        }
        Reply { answer, cpu, starting, instructions }
    }

    /// Takes the program, or starts it again; returns the CPU time of a start too. A query that fails costs that query
    /// alone: only failed starts are counted, and after too many of them nobody tries again.
    fn running(&mut self) -> (Result<ProgramSession, ProcessError>, Option<Duration>) {
        if let Some(session) = self.session.take() {
            return (Ok(session), None);
        }
        if self.failed_starts > self.program.restarts {
            return (Err(ProcessError::crashed("failed to start more often than it may")), None);
        }
        let (started, cpu) = ProgramSession::start(&self.program, &self.field, self.program.query_instructions);
        let started = started.map_err(|error| {
            self.failed_starts += 1;
            ProcessError { kind: ProcessErrorKind::Crashed, message: format!("did not start again: {}", error.message) }
        });
        (started, cpu)
    }

    /// Gives the program away, to play in another run, if it has not failed.
    pub fn into_idle(mut self) -> Option<IdleProgram> {
        let session = self.session.take()?;
        Some(IdleProgram { launch: Arc::clone(&self.program), session })
    }
}

impl Drop for ExternalClient {
    fn drop(&mut self) {
        if let Some(session) = self.session.take() {
            session.end();
        }
    }
}

impl ProgramSession {
    /// Starts a program and shows it a field; returns the CPU time that it took, also if that fails.
    fn start(program: &Launch, field: &[u8], instructions: u64) -> (Result<Self, ProcessError>, Option<Duration>) {
        let watch = WallStopwatch::start();
        let mut session = match Backend::start(program) {
            Ok(peer) => Self { peer, queries: 0, counted: Duration::ZERO, start_instructions: instructions },
            Err(error) => return (Err(error), None),
        };
        let greeted = session.greet(program, watch).and_then(|()| session.show(program, field, watch));
        let cpu = session.elapsed_since_last();
        (greeted.map(|()| session), cpu)
    }

    /// Says hello, and waits until the program has.
    fn greet(&mut self, program: &Launch, since: WallStopwatch) -> Result<(), ProcessError> {
        let hello =
            ToProgram::Hello { protocol: VERSION, program: concat!("wildfire ", env!("CARGO_PKG_VERSION")).into() };
        let line = self.peer.exchange(&hello.line(), self.at_start(program, since, "`hello`"))?;
        let problem = match FromProgram::parse(&line) {
            Ok(FromProgram::Hello(hello)) if hello.protocol == VERSION => None,
            Ok(FromProgram::Hello(hello)) => Some(format!("`protocol` is {}; expected {VERSION}", hello.protocol)),
            Ok(_) => Some("expected the type `hello`".to_owned()),
            Err(problem) => Some(problem),
        };
        match problem {
            Some(problem) => Err(ProcessError::bad_answer(&line, &problem)),
            None => Ok(()),
        }
    }

    /// Shows the field of another run to a program that has played before.
    fn play_again(mut self, program: &Launch, field: &[u8]) -> Option<Self> {
        self.peer.begin_run();
        self.show(program, field, WallStopwatch::start()).ok()?;
        Some(self)
    }

    /// Shows it a field, and waits until it is ready.
    fn show(&mut self, program: &Launch, field: &[u8], since: WallStopwatch) -> Result<(), ProcessError> {
        self.queries = 0;
        let line = self.peer.exchange(field, self.at_start(program, since, "`ready`"))?;
        let problem = match FromProgram::parse(&line) {
            Ok(FromProgram::Ready) => return Ok(()),
            Ok(FromProgram::Error(error)) => return Err(ProcessError::refused(&error.message)),
            Ok(_) => "expected the type `ready` or `error`".to_owned(),
            Err(problem) => problem,
        };
        Err(ProcessError::bad_answer(&line, &problem))
    }

    /// Returns what it may take until it is ready, from its start on. Where the CPU time of queries is limited, that of a start
    /// is too, so that no other process computes at leisure meanwhile.
    fn at_start<'a>(&self, program: &Launch, since: WallStopwatch, answer: &'a str) -> QueryLimits<'a> {
        let Launch { start_limit, query_cpu, .. } = *program;
        let cpu = start_cpu(start_limit, query_cpu, self.counted);
        let wall = start_limit.saturating_sub(since.elapsed());
        QueryLimits { wall, cpu, instructions: self.start_instructions, answer }
    }

    /// Returns its CPU time since the last lap.
    fn elapsed_since_last(&mut self) -> Option<Duration> {
        let now = self.peer.cpu()?;
        let elapsed_since_last = now.saturating_sub(self.counted);
        self.counted = now;
        Some(elapsed_since_last)
    }

    /// Says goodbye, and waits until nothing of it is left.
    pub fn end(self) {
        self.peer.end();
    }
}

/// Returns the CPU time that a start may take from `from` on.
fn start_cpu(start_limit: Duration, query_cpu: Option<Duration>, from: Duration) -> Option<CpuLimit> {
    query_cpu.map(|_| CpuLimit { limit: start_limit, from })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn start_is_limited_in_cpu_time_where_queries_are() {
        let [start, query, counted] = [30, 1, 7].map(Duration::from_secs);
        assert!(start_cpu(start, None, counted).is_none());
        let allowed = start_cpu(start, Some(query), counted).expect("there is a limit");
        assert_eq!((allowed.limit, allowed.from), (start, counted));
    }
}
