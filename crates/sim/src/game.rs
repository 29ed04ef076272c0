//! Games: runs in which a player decides for one side or both, and the answers that replay them.
//!
//! Agents that are played follow a policy called [`PLAYER`], so that recordings name it. While a game is played the policy
//! leaves every decision to [`Simulation::answer`](crate::Simulation::answer); a [`Game`] that holds all answers gives the
//! same run without anybody there.

use std::sync::{Arc, Mutex};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::policies::{Action, Observation, Policies, Policy, PolicyContext};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_scenario::{LoadedScenario, ScenarioError, ScenarioText};
use wildfire_timeline::{AgentId, Role};

/// The policy name of played agents.
pub const PLAYER: &str = "player";

/// The size limit of a game file, in bytes.
pub const MAX_GAME_BYTES: u64 = 8_000_000;

/// The version of the format, which games carry.
const FORMAT: u32 = 1;

/// A run and the answers of its players.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Game {
    /// The version of the format.
    wildfire_game: u32,
    /// The name of a built-in scenario, or the text of a custom one.
    pub scenario: GameScenario,
    /// Changes of the scenario, such as `unimog.planner=prm-rs`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
    pub seed: u64,
    /// The sides that players decide for: `wumpus`, `unimog`.
    pub plays: Vec<Side>,
    /// The answers in the order in which they were given.
    #[serde(default)]
    pub answers: Vec<Answer>,
}

/// Where a game's scenario comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GameScenario {
    /// A built-in scenario, by name.
    Name(String),
    /// The text of a scenario file.
    Text(String),
}

/// A side of the contest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    Wumpus,
    Unimog,
}

impl Side {
    pub fn role(self) -> Role {
        match self {
            Self::Wumpus => Role::Wumpus,
            Self::Unimog => Role::Unimog,
        }
    }
}

/// A player's decision for an agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// The time of the question, in nanoseconds from the start of the run.
    pub t_ns: u64,
    /// The side, and the agent's number on it.
    pub side: Side,
    pub number: u16,
    pub choice: GameChoice,
}

/// A choice for an agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GameChoice {
    /// Go for this cell: column and row.
    Go(u16, u16),
    /// Go for the fire that is nearest by drive (trucks only).
    GoToNearest,
    /// Wait, or keep the goal, until something happens, for at most ten seconds.
    Wait,
    /// Wait, or keep the goal, until something happens.
    Stay,
}

impl GameChoice {
    /// Returns whether agents of a side can do this, wherever they are.
    pub fn is_for(self, side: Side) -> bool {
        self != Self::GoToNearest || side == Side::Unimog
    }
}

/// How long an agent waits that nothing wakes.
const WAIT: SimTime = SimTime::from_nanos(10_000_000_000);

impl From<Action> for GameChoice {
    /// What games cannot hold is [`Self::Stay`].
    fn from(choice: Action) -> Self {
        match choice {
            Action::Go(Cell { col, row }) => Self::Go(col, row),
            Action::GoToNearest => Self::GoToNearest,
            Action::Move(_) | Action::Refill | Action::Wait | Action::WaitUntil(_) => Self::Stay,
        }
    }
}

impl Answer {
    /// Returns the choice for an agent that was asked at this time.
    pub fn new(time: SimTime, agent: AgentId, choice: GameChoice) -> Self {
        let side = if agent.role.lights() { Side::Wumpus } else { Side::Unimog };
        Self { t_ns: time.as_nanos(), side, number: agent.number, choice }
    }

    /// Returns the agent that the answer is for.
    pub fn agent(&self) -> AgentId {
        AgentId { role: self.side.role(), number: self.number }
    }

    /// Returns the choice as the simulation takes it.
    pub fn action(&self) -> Action {
        match self.choice {
            GameChoice::Go(col, row) => Action::Go(Cell { col, row }),
            GameChoice::GoToNearest => Action::GoToNearest,
            GameChoice::Wait => Action::WaitUntil(SimTime::from_nanos(self.t_ns) + WAIT),
            GameChoice::Stay => Action::Wait,
        }
    }
}

/// The reason why a game cannot be replayed.
#[derive(Debug, Error)]
pub enum GameError {
    #[error("this is not a game file: {0}")]
    Malformed(#[from] serde_json::Error),
    #[error("the game has format {found}; expected {FORMAT}")]
    Format { found: u32 },
    #[error("it does not name the side played; expected `wumpus` or `unimog`")]
    NobodyPlays,
    #[error("answer {number} sends {agent} to the nearest fire; only trucks can go there")]
    NotATruck { number: usize, agent: AgentId },
}

impl Game {
    /// Creates a game without answers.
    pub fn new(scenario: GameScenario, changes: Vec<String>, seed: u64, plays: Vec<Side>) -> Self {
        Self { wildfire_game: FORMAT, scenario, changes, seed, plays, answers: Vec::new() }
    }

    /// Reads the JSON text of a game.
    ///
    /// # Errors
    /// If it is none, is of another format, nobody plays in it, or an answer is none for its agent.
    pub fn from_json(text: &str) -> Result<Self, GameError> {
        let game: Self = serde_json::from_str(text)?;
        match game.wildfire_game {
            FORMAT if game.plays.is_empty() => return Err(GameError::NobodyPlays),
            FORMAT => {}
            found => return Err(GameError::Format { found }),
        }
        match game.answers.iter().zip(1..).find(|(answer, _)| !answer.choice.is_for(answer.side)) {
            Some((answer, number)) => Err(GameError::NotATruck { number, agent: answer.agent() }),
            None => Ok(game),
        }
    }

    /// Loads the scenario, with the played sides following [`PLAYER`].
    ///
    /// # Errors
    /// If it is refused.
    pub fn load(&self) -> Result<LoadedScenario, Box<ScenarioError>> {
        let text = self.text()?;
        let goals = self.plays.iter().map(|side| format!("{}.goal={PLAYER}", side.role().name()));
        // Without a command the policy is one that is registered.
        let played = (!self.plays.is_empty()).then(|| format!("policy.{PLAYER}.command=[]"));
        LoadedScenario::from_text(&text, &self.changes.iter().cloned().chain(played).chain(goals).collect::<Vec<_>>())
    }

    /// Loads the scenario with its own policies, without players.
    ///
    /// # Errors
    /// If it is refused.
    pub fn load_unplayed(&self) -> Result<LoadedScenario, Box<ScenarioError>> {
        LoadedScenario::from_text(&self.text()?, &self.changes)
    }

    fn text(&self) -> Result<ScenarioText, Box<ScenarioError>> {
        match &self.scenario {
            GameScenario::Name(name) => ScenarioText::built_in(name),
            GameScenario::Text(text) => ScenarioText::from_bytes("scenario.toml", Ok(text.clone().into_bytes())),
        }
    }

    /// Returns policies among which [`PLAYER`] gives this game's answers; the first question that the game has no answer
    /// to goes into `unanswered`.
    pub fn replayed(&self, unanswered: &Unanswered) -> Policies {
        let answers = Arc::new(self.answers.clone());
        let first = unanswered.clone();
        let make = move |_: &PolicyContext<'_>| {
            let answers = Arc::clone(&answers);
            let unanswered = first.clone();
            Ok(Box::new(ScriptedPolicy { answers, next: 0, unanswered }) as Box<dyn Policy>)
        };
        Policies::default().with(PLAYER, make).expect("no built-in policy has this name")
    }
}

/// Returns policies among which [`PLAYER`] passes every decision to [`Simulation::answer`](crate::Simulation::answer).
pub fn played() -> Policies {
    Policies::default()
        .with(PLAYER, |_: &PolicyContext<'_>| Ok(Box::new(ExternalPolicy) as Box<dyn Policy>))
        .expect("no built-in policy has this name")
}

/// Leaves every decision to somebody outside.
#[derive(Clone)]
pub(crate) struct ExternalPolicy;

impl Policy for ExternalPolicy {
    fn choose(&mut self, _: &Observation<'_>, _: &[AgentId]) -> Vec<(AgentId, Action)> {
        Vec::new()
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(self.clone()))
    }
}

/// A message about the first question that a game has no answer to; agents wait from there on.
#[derive(Clone, Debug, Default)]
pub struct Unanswered(Arc<Mutex<Option<String>>>);

impl Unanswered {
    /// Takes the message after the run.
    pub fn take(&self) -> Option<String> {
        self.0.lock().expect("nobody panics while holding it").take()
    }
}

/// Gives the answers of a game.
#[derive(Clone)]
struct ScriptedPolicy {
    answers: Arc<Vec<Answer>>,
    next: usize,
    unanswered: Unanswered,
}

impl Policy for ScriptedPolicy {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        let next = self.answers.get(self.next);
        if let Some(answer) = next.filter(|next| next.t_ns == seen.now.as_nanos() && queried.contains(&next.agent())) {
            self.next += 1;
            // The rest comes in further questions, as in the game that was recorded.
            return vec![(answer.agent(), answer.action())];
        }
        let has = match next {
            Some(next) => format!("the next answer is that of {} at {}", next.agent(), SimTime::from_nanos(next.t_ns)),
            None => format!("there are {} answers", self.next),
        };
        let mut first = self.unanswered.0.lock().expect("nobody panics while holding it");
        first.get_or_insert_with(|| {
            format!("{} is asked at {} (t_ns {}), and {has}", queried[0], seen.now, seen.now.as_nanos())
        });
        queried.iter().map(|&agent| (agent, Action::Wait)).collect()
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(self.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RunOptions, Simulation, run_with_options};
    use wildfire_base::geometry::DVec2;

    /// Plays a game by a rule of its own and returns it with its timeline.
    fn play(mut game: Game) -> (Game, wildfire_timeline::Timeline) {
        let scenario = game.load().expect("it is a scenario").scenario;
        let options = RunOptions { policies: played(), ..RunOptions::default() };
        let mut simulation = Simulation::with(&scenario, game.seed, &options).expect("it takes place");
        let mut turn = 0;
        while let Some(queried) = simulation.advance_to_question(SimTime::MAX).map(<[_]>::to_vec) {
            // Not always the first who is asked, and now and then somebody waits.
            let agent = queried[turn % queried.len()];
            let cells = simulation.observe(|seen, _| seen.options(agent)).expect("a question waits");
            let go = |cell: &Cell| GameChoice::Go(cell.col, cell.row);
            let choice = if turn % 7 == 3 { GameChoice::Wait } else { cells.last().map_or(GameChoice::Wait, go) };
            let answer = Answer::new(simulation.now(), agent, choice);
            simulation.answer(vec![(agent, answer.action())]);
            game.answers.push(answer);
            turn += 1;
        }
        (game, simulation.finish().timeline)
    }

    fn game(scenario: &str, plays: &[Side]) -> Game {
        let changes = vec!["duration_s=400".to_owned()];
        Game::new(GameScenario::Name(scenario.to_owned()), changes, 4, plays.to_vec())
    }

    #[test]
    fn the_answers_of_a_game_give_its_run() {
        for (scenario, plays) in
            [("smoke", &[Side::Wumpus][..]), ("fleet", &[Side::Unimog]), ("fleet", &[Side::Wumpus, Side::Unimog])]
        {
            let (game, timeline) = play(game(scenario, plays));
            assert!(game.answers.len() > 10, "{scenario}: {} answers", game.answers.len());
            let read = Game::from_json(&serde_json::to_string(&game).expect("it is JSON")).expect("it is a game");
            assert_eq!(read, game);
            let unanswered = Unanswered::default();
            let options = RunOptions { policies: read.replayed(&unanswered), ..RunOptions::default() };
            let scenario = read.load().expect("it is a scenario").scenario;
            let run = run_with_options(&scenario, read.seed, &options).expect("it takes place");
            assert_eq!(unanswered.take(), None);
            assert_eq!(run.timeline, timeline);
            assert!(wildfire_audit::audit_timeline(&timeline, Default::default()).violation.is_none());
        }
    }

    #[test]
    fn a_question_without_an_answer_is_reported() {
        let (mut game, _) = play(game("smoke", &[Side::Wumpus]));
        let count = game.answers.len();
        game.answers.pop();
        let unanswered = Unanswered::default();
        let options = RunOptions { policies: game.replayed(&unanswered), ..RunOptions::default() };
        let scenario = game.load().expect("it is a scenario").scenario;
        run_with_options(&scenario, game.seed, &options).expect("it takes place");
        let message = unanswered.take().expect("an answer is missing");
        assert!(message.starts_with("wumpus/0 is asked at"), "{message}");
        assert!(message.ends_with(&format!("and there are {} answers", count - 1)), "{message}");
    }

    /// Gives everybody the same choice.
    struct Always(Action);

    impl Policy for Always {
        fn choose(&mut self, _: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
            queried.iter().map(|&agent| (agent, self.0)).collect()
        }
    }

    #[test]
    fn choices_that_an_agent_cannot_carry_out_are_counted_and_reported() {
        let nowhere = Cell { col: 0, row: 0 };
        for (side, choice, expected) in [
            ("wumpus", Action::GoToNearest, "wumpus/0 cannot go to the nearest fire; only trucks can"),
            ("wumpus", Action::Refill, "wumpus/0 cannot refill; it has no tank"),
            ("wumpus", Action::Move(DVec2::ONE), "wumpus/0 cannot be sent to (1, 1)"),
            ("wumpus", Action::Go(nowhere), "wumpus/0 cannot go for (0, 0)"),
            ("wumpus", Action::Wait, ""),
            ("unimog", Action::Go(nowhere), "unimog/0 cannot go for (0, 0)"),
            ("unimog", Action::Move(DVec2::ONE), "unimog/0 cannot be sent to (1, 1)"),
            ("unimog", Action::Refill, "unimog/0 cannot refill; it has no tank"),
            ("unimog", Action::GoToNearest, ""),
        ] {
            let make = move |_: &PolicyContext<'_>| Ok(Box::new(Always(choice)) as Box<dyn Policy>);
            let policies = Policies::default().with("same", make).expect("the name is free");
            let changes =
                ["policy.same.command=[]".to_owned(), format!("{side}.goal=same"), "duration_s=200".to_owned()];
            let scenario = wildfire_scenario::load("smoke", &changes).expect("it is a scenario");
            let options = RunOptions { policies, ..RunOptions::default() };
            let run = run_with_options(&scenario, 1, &options).expect("it takes place");
            let illegal = run.asks.unwrap_or_default().illegal;
            let messages = run.messages.to_string();
            assert_eq!(illegal > 0, !expected.is_empty(), "{side} {choice:?}");
            assert!(messages.contains(expected), "{messages}");
        }
    }

    #[test]
    fn what_is_no_game_is_refused() {
        for (text, expected) in [
            ("[]", "this is not a game file"),
            (r#"{"wildfire_game": 2, "scenario": {"name": "smoke"}, "seed": 1, "plays": ["unimog"]}"#, "format 2"),
            (
                r#"{"wildfire_game": 1, "scenario": {"name": "smoke"}, "seed": 1, "plays": []}"#,
                "does not name the side",
            ),
            (r#"{"wildfire_game": 1, "scenario": {"name": "smoke"}, "seed": -1, "plays": []}"#, "line 1"),
            (
                r#"{"wildfire_game": 1, "scenario": {"name": "smoke"}, "seed": 1, "plays": ["wumpus"], "answers":
                [{"t_ns": 0, "side": "wumpus", "number": 0, "choice": "go-to-nearest"}]}"#,
                "answer 1 sends wumpus/0 to the nearest fire; only trucks can",
            ),
        ] {
            let refusal = Game::from_json(text).expect_err(text).to_string();
            assert!(refusal.contains(expected), "{refusal}");
        }
        assert!(game("nowhere", &[Side::Wumpus]).load().is_err());
    }
}
