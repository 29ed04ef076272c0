//! What a page asks, and what it is answered: one scenario at a time, one run of it in the making.

use data_encoding::BASE64;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_picture::film::{FrameRequest, RunView, ViewOptions, page_data};
use wildfire_scenario::{
    BUILT_IN, DispatchPolicy, Fault, MemoryLimit, Scenario, ScenarioError, Terrain, TruckGoal, TruckPlannerKind,
    WumpusGoal,
};
use wildfire_sim::game::{Answer, Game, GameChoice, GameScenario, Side, played};
use wildfire_sim::policies::{NamedPolicy, Policy, RuleContext};
use wildfire_sim::{RunError, RunOptions, Simulation};
use wildfire_timeline::{AgentId, Outcome, Setting, Timeline, Winner, file};

/// The memory that a run may take in a page.
const MEMORY: MemoryLimit = MemoryLimit { bytes: 512_000_000 };

/// A question of a page.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
enum PageRequest {
    /// The built-in scenarios and planners.
    Catalogue,
    /// Begins a run, or a game where some side is played; answers that are given are carried out when they are asked for.
    Open {
        scenario: GameScenario,
        #[serde(default)]
        changes: Vec<String>,
        seed: u64,
        #[serde(default)]
        plays: Vec<Side>,
        #[serde(default)]
        answers: Vec<Answer>,
        #[serde(default)]
        searches: bool,
    },
    /// Lets everything happen that is due until then, or until a question.
    Advance { to_ns: f64 },
    /// Answers for an agent that is asked.
    Answer { agent: AgentName, choice: GameChoice },
    /// Lets the built-in policy that the scenario names answer.
    Decide { agent: AgentName },
    /// All that the page draws of the run so far.
    Page,
    /// The result of a run that has ended, and its recording.
    Finish,
    /// The policies that could have played the side.
    Rivals { side: Side },
    /// The result of the same run with these changes and nobody playing.
    Rival { changes: Vec<String> },
}

/// An agent as requests name it.
#[derive(Clone, Copy, Deserialize)]
struct AgentName {
    side: Side,
    number: u16,
}

impl From<AgentName> for AgentId {
    fn from(AgentName { side, number }: AgentName) -> Self {
        Self { role: side.role(), number }
    }
}

/// Why a request was refused, and where in the scenario's text the reason lies.
#[derive(Debug, Serialize)]
struct SessionError {
    message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    advice: Option<String>,
    /// Line and column, from 1; `None` outside the text.
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<(usize, usize)>,
}

impl SessionError {
    fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), advice: None, place: None }
    }

    fn of_scenario(error: &ScenarioError, scenario: &GameScenario) -> Self {
        let text = match scenario {
            GameScenario::Text(text) => text,
            GameScenario::Name(name) => BUILT_IN.iter().find(|(key, _)| key == name).map_or("", |(_, text)| text),
        };
        let location = error.location.as_ref().filter(|location| location.is_in(text));
        let place = location.map(wildfire_scenario::SourceLocation::line_and_column);
        let message = match &error.fault {
            Fault::Unreadable { path, .. } => {
                format!("`{path}` cannot be read: in a page a scenario has no other files")
            }
            _ => error.to_string(),
        };
        Self { message, advice: error.fault.advice(), place }
    }
}

impl From<RunError> for SessionError {
    fn from(error: RunError) -> Self {
        Self::new(match error {
            RunError::Memory(_) => {
                format!("this run needs more than {MEMORY} of memory, which a page does not have; the program does")
            }
            other => other.to_string(),
        })
    }
}

/// A page's side of the program.
#[derive(Default)]
pub struct Session {
    run: Option<LiveRun>,
}

/// The policies that decide for a player, by side.
type StandInPolicies = Vec<(Side, Box<dyn Policy>)>;

/// A run in the making.
struct LiveRun {
    game: Game,
    simulation: Simulation,
    /// Answers of a game that was opened, still to be carried out.
    scripted: std::vec::IntoIter<Answer>,
    /// The policies that the scenario names for the sides that are played.
    substitutes: StandInPolicies,
}

impl Session {
    /// Answers a request, both in JSON: with what was asked for, or with `{"error": {"message": ..}}`.
    pub fn answer(&mut self, request: &str) -> String {
        let request = serde_json::from_str(request).map_err(|error| SessionError::new(format!("no request: {error}")));
        let answered = request.and_then(|request| self.execute(request));
        answered.unwrap_or_else(|refusal| json!({ "error": refusal }).to_string())
    }

    fn execute(&mut self, request: PageRequest) -> Result<String, SessionError> {
        match request {
            PageRequest::Catalogue => Ok(catalogue().to_string()),
            PageRequest::Open { scenario, changes, seed, plays, answers, searches } => {
                // The memory of the run before is free for the next one.
                self.run = None;
                let making = LiveRun::open(Game::new(scenario, changes, seed, plays), answers, searches)?;
                let opened = making.opened();
                self.run = Some(making);
                Ok(opened.to_string())
            }
            PageRequest::Advance { to_ns } => {
                let making = self.making()?;
                // Beyond any time of a run a number of JSON is the end of time.
                making.advance(SimTime::from_nanos(to_ns as u64))?;
                Ok(making.state().to_string())
            }
            PageRequest::Answer { agent, choice } => {
                self.making()?.answer(agent.into(), choice)?;
                Ok("{}".to_owned())
            }
            PageRequest::Decide { agent } => {
                let choice = self.making()?.decide(agent)?;
                Ok(json!({ "choice": choice }).to_string())
            }
            PageRequest::Page => {
                let timeline = self.making()?.so_far();
                let view = RunView::new(timeline, None);
                let options = ViewOptions::default();
                Ok(page_data(&FrameRequest { runs: &[&view], time: SimTime::ZERO, options: &options }))
            }
            PageRequest::Finish => self.making()?.finish(),
            PageRequest::Rivals { side } => Ok(json!(rivals(side, self.making()?.simulation.setting())).to_string()),
            PageRequest::Rival { changes } => {
                let mut game = self.making()?.game.clone();
                game.changes.extend(changes);
                let scenario =
                    game.load_unplayed().map_err(|error| SessionError::of_scenario(&error, &game.scenario))?;
                let options = RunOptions { memory: MEMORY, ..RunOptions::default() };
                let run = wildfire_sim::run_with_options(&scenario.scenario, game.seed, &options)?;
                Ok(result(&Outcome::new(&run.timeline)).to_string())
            }
        }
    }

    fn making(&mut self) -> Result<&mut LiveRun, SessionError> {
        self.run.as_mut().ok_or_else(|| SessionError::new("no run is open"))
    }
}

impl LiveRun {
    fn open(game: Game, answers: Vec<Answer>, searches: bool) -> Result<Self, SessionError> {
        let refuse = |error: Box<ScenarioError>| SessionError::of_scenario(&error, &game.scenario);
        // The policies that stand in for players are those of the scenario that nobody plays.
        let unplayed = game.load_unplayed().map_err(refuse)?.scenario;
        let scenario = game.load().map_err(refuse)?.scenario;
        let options =
            RunOptions { policies: played(), records_searches: searches, memory: MEMORY, ..RunOptions::default() };
        let simulation = Simulation::with(&scenario, game.seed, &options)?;
        let substitutes = substitutes(&game, &unplayed)?;
        Ok(Self { game, simulation, scripted: answers.into_iter(), substitutes })
    }

    fn opened(&self) -> Value {
        let setting = self.simulation.setting();
        json!({
            "scenario": setting.scenario,
            "version": setting.program_version,
            "duration_ns": setting.rules.duration.as_nanos(),
        })
    }

    /// Advances, and carries out answers that were given with the game as long as they fit.
    fn advance(&mut self, target: SimTime) -> Result<(), SessionError> {
        while let Some(queried) = self.simulation.advance_to_question(target).map(<[_]>::to_vec) {
            let Some(answer) = self.scripted.next() else { break };
            let agent = answer.agent();
            if answer.t_ns != self.simulation.now().as_nanos() || !queried.contains(&agent) {
                // After an answer that does not fit, all that follow belong to another run.
                self.scripted = Vec::new().into_iter();
                return Err(SessionError::new(
                    "this game was played with another version: its answers do not fit this run",
                ));
            }
            self.answer(agent, answer.choice)?;
        }
        Ok(self.simulation.expect_within_memory()?)
    }

    fn state(&self) -> Value {
        let setting = self.simulation.setting();
        let queried = self.simulation.observe(|seen, queried| {
            queried
                .iter()
                .map(|&agent: &AgentId| {
                    let options = seen.options(agent);
                    let view = seen.agents.iter().find(|view| view.id == agent).expect("all agents are seen");
                    json!({
                        "agent": agent.to_string(),
                        "side": agent.role.name(),
                        "number": agent.number,
                        "place": view.place.to_array(),
                        "goal": view.goal.map(|goal| setting.frame.index(goal)),
                        "options": options.iter().map(|cell| setting.frame.index(*cell)).collect::<Vec<_>>(),
                    })
                })
                .collect::<Vec<_>>()
        });
        json!({
            "now_ns": self.simulation.now().as_nanos(),
            "has_ended": self.simulation.has_ended(),
            "asked": queried.unwrap_or_default(),
        })
    }

    fn answer(&mut self, agent: AgentId, choice: GameChoice) -> Result<(), SessionError> {
        let can = self.simulation.observe(|seen, queried| {
            let is_option = match choice {
                GameChoice::Go(col, row) => seen.options(agent).contains(&Cell { col, row }),
                GameChoice::GoToNearest | GameChoice::Wait | GameChoice::Stay => true,
            };
            // Only trucks have a nearest fire to go for.
            queried.contains(&agent) && is_option && (choice != GameChoice::GoToNearest || agent.role.suppresses())
        });
        match can {
            Some(true) => {}
            Some(false) => return Err(SessionError::new(format!("{agent} is not asked, or cannot go there"))),
            None => return Err(SessionError::new("nobody is asked")),
        }
        let answer = Answer::new(self.simulation.now(), agent, choice);
        self.simulation.answer(vec![(agent, answer.action())]);
        self.game.answers.push(answer);
        Ok(())
    }

    /// Answers as the scenario's own policy does, and returns what it chose.
    fn decide(&mut self, name: AgentName) -> Result<GameChoice, SessionError> {
        let agent = AgentId::from(name);
        let substitute = self.substitutes.iter_mut().find(|(side, _)| *side == name.side);
        let (_, policy) = substitute.ok_or_else(|| SessionError::new("nobody plays this side"))?;
        let choices = self.simulation.observe(|seen, _| policy.choose(seen, &[agent])).unwrap_or_default();
        let choice =
            choices.into_iter().find(|&(id, _)| id == agent).map_or(GameChoice::Stay, |(_, choice)| choice.into());
        self.answer(agent, choice)?;
        Ok(choice)
    }

    fn timeline(&self) -> Timeline {
        Timeline {
            setting: self.simulation.setting().clone(),
            events: self.simulation.facts().to_vec(),
            ground: self.simulation.ground().to_vec(),
        }
    }

    /// Returns the run as if it ended now, which is how far it can be shown.
    fn so_far(&self) -> Timeline {
        let mut timeline = self.timeline();
        timeline.setting.rules.duration = timeline.setting.rules.duration.min(self.simulation.now());
        timeline
    }

    fn finish(&self) -> Result<String, SessionError> {
        if !self.simulation.has_ended() {
            return Err(SessionError::new("the run is not over"));
        }
        let timeline = self.timeline();
        let recording = file::encode(&timeline).map_err(|error| SessionError::new(error.to_string()))?;
        let name = format!("{}-seed-{}", timeline.setting.scenario, timeline.setting.seed);
        Ok(json!({
            "result": result(&Outcome::new(&timeline)),
            "name": name,
            "recording": BASE64.encode(&recording),
            "game": self.game,
        })
        .to_string())
    }
}

/// Makes the policies that the scenario names for the sides that are played.
fn substitutes(game: &Game, scenario: &Scenario) -> Result<StandInPolicies, SessionError> {
    // The same field as that of the run, since it follows from scenario and seed.
    let terrain = Terrain::from_scenario(scenario, game.seed).map_err(RunError::from)?;
    let lightable = terrain.lightable(scenario.fire.lights_ground());
    let site = RuleContext {
        frame: &terrain.frame,
        lightable: &lightable,
        spread_m: scenario.fire.spread_radius_m,
        seed: game.seed,
        learned: scenario.learned.as_ref(),
    };
    let named = |side: Side| match side {
        Side::Wumpus => scenario.wumpus.first().map(|wumpus| NamedPolicy::from(&wumpus.goal)),
        Side::Unimog => scenario.unimog.first().map(|truck| NamedPolicy::from(&truck.goal)),
    };
    game.plays
        .iter()
        .map(|&side| match named(side) {
            Some(NamedPolicy::BuiltIn(rule)) => Ok((side, rule.make(&site))),
            Some(NamedPolicy::Custom(name)) => {
                Err(SessionError::new(format!("the policy `{name}` does not run in a page")))
            }
            None => Err(SessionError::new(format!("the scenario has no {} to play", side.role().name()))),
        })
        .collect()
}

fn catalogue() -> Value {
    let scenarios = BUILT_IN.iter().map(|(name, text)| json!({ "name": name, "text": text }));
    json!({
        "scenarios": scenarios.collect::<Vec<_>>(),
        "planners": TruckPlannerKind::ALL.map(TruckPlannerKind::name),
    })
}

/// Lists the policies of a side with the changes that name them; those of teams where there is one.
fn rivals(side: Side, setting: &Setting) -> Vec<Value> {
    let trucks = setting.agents.iter().filter(|agent| agent.id.role.suppresses()).count();
    let (key, names) = match side {
        Side::Wumpus => ("wumpus.goal", WumpusGoal::BUILT_IN.to_vec()),
        Side::Unimog if trucks > 1 => ("dispatch.policy", DispatchPolicy::ALL.map(DispatchPolicy::name).to_vec()),
        Side::Unimog => ("unimog.goal", TruckGoal::BUILT_IN.to_vec()),
    };
    names.into_iter().map(|name| json!({ "name": name, "changes": [format!("{key}={name}")] })).collect()
}

fn result(outcome: &Outcome) -> Value {
    let winner = match outcome.winner() {
        Winner::Wumpus => "wumpus",
        Winner::Unimog => "unimog",
        Winner::Tie => "tie",
    };
    json!({
        "bushes": outcome.obstacles,
        "saved": outcome.intact + outcome.extinguished,
        "intact": outcome.intact,
        "extinguished": outcome.extinguished,
        "burned": outcome.burned(),
        "wumpus_points": outcome.wumpus_score,
        "truck_points": outcome.truck_score,
        "winner": winner,
        "burned_beyond_bound": outcome.burned_beyond_bound(),
        "ended_s": outcome.ended_s,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(session: &mut Session, request: &Value) -> Value {
        serde_json::from_str(&session.answer(&request.to_string())).expect("answers are JSON")
    }

    fn open(session: &mut Session, scenario: &str, plays: &[&str]) -> Value {
        let request = json!({ "do": "open", "scenario": { "name": scenario }, "seed": 3, "plays": plays });
        ask(session, &request)
    }

    const TO_THE_END: f64 = 1e18;

    #[test]
    fn a_run_in_slices_is_the_programs_run() {
        let mut session = Session::default();
        assert_eq!(open(&mut session, "smoke", &[])["scenario"], "smoke");
        let mut until = 0.0;
        while ask(&mut session, &json!({ "do": "advance", "to_ns": until }))["has_ended"] == false {
            until += 7e9;
            assert!(ask(&mut session, &json!({ "do": "page" }))["runs"][0]["seed"] == 3);
        }
        let finished = ask(&mut session, &json!({ "do": "finish" }));
        let scenario = wildfire_scenario::load("smoke", &[]).expect("it is built in");
        let timeline = wildfire_sim::run(&scenario, 3).expect("it takes place").timeline;
        let recording = BASE64.encode(&file::encode(&timeline).expect("it fits"));
        assert_eq!(finished["recording"], recording);
        assert_eq!(finished["result"]["burned"], Outcome::new(&timeline).burned());
    }

    #[test]
    fn the_substitute_plays_as_the_policy_it_stands_for() {
        for (side, scenario) in [("wumpus", "smoke"), ("unimog", "smoke")] {
            let mut session = Session::default();
            open(&mut session, scenario, &[side]);
            loop {
                let state = ask(&mut session, &json!({ "do": "advance", "to_ns": TO_THE_END }));
                let Some(queried) = state["asked"].get(0) else { break };
                let agent = json!({ "side": queried["side"], "number": queried["number"] });
                let decided = ask(&mut session, &json!({ "do": "decide", "agent": agent }));
                assert!(decided["error"].is_null(), "{decided}");
            }
            let finished = ask(&mut session, &json!({ "do": "finish" }));
            let rival = ask(&mut session, &json!({ "do": "rival", "changes": [] }));
            assert_eq!(finished["result"], rival, "{side}");
            assert!(finished["game"]["answers"].as_array().expect("a list").len() > 5);
        }
    }

    #[test]
    fn a_game_that_was_opened_goes_on_where_it_ended() {
        let mut session = Session::default();
        open(&mut session, "smoke", &["wumpus"]);
        let state = ask(&mut session, &json!({ "do": "advance", "to_ns": TO_THE_END }));
        let agent = json!({ "side": "wumpus", "number": 0 });
        ask(&mut session, &json!({ "do": "decide", "agent": agent }));
        let second = ask(&mut session, &json!({ "do": "advance", "to_ns": TO_THE_END }));
        let game = &session.run.as_ref().expect("it is open").game;
        let mut again = json!({ "do": "open", "scenario": { "name": "smoke" }, "seed": 3, "plays": ["wumpus"] });
        again["answers"] = json!(game.answers);
        let mut other = Session::default();
        ask(&mut other, &again);
        assert_eq!(ask(&mut other, &json!({ "do": "advance", "to_ns": TO_THE_END })), second);
        assert_ne!(state, second);
        again["answers"][0]["t_ns"] = json!(5);
        ask(&mut other, &again);
        let refused = ask(&mut other, &json!({ "do": "advance", "to_ns": TO_THE_END }));
        assert!(refused["error"]["message"].as_str().expect("words").contains("do not fit"), "{refused}");
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_place() {
        let mut session = Session::default();
        let refused = ask(&mut session, &json!({ "do": "page" }));
        assert_eq!(refused["error"]["message"], "no run is open");
        let smoke = BUILT_IN.iter().find(|(name, _)| *name == "smoke").expect("it is built in").1;
        let text = format!("{smoke}\n[fires]\n");
        let refused = ask(&mut session, &json!({ "do": "open", "scenario": { "text": text }, "seed": 1 }));
        assert_eq!(refused["error"]["place"], json!([text.lines().count(), 2]), "{refused}");
        assert!(open(&mut session, "smok", &[])["error"]["advice"].as_str().expect("words").contains("smoke"));
        let alone = open(&mut session, "unimog-alone", &["wumpus"]);
        assert!(alone["error"]["message"].is_string(), "{alone}");
        open(&mut session, "smoke", &["wumpus"]);
        ask(&mut session, &json!({ "do": "advance", "to_ns": TO_THE_END }));
        for agent in [json!({ "side": "wumpus", "number": 4 }), json!({ "side": "unimog", "number": 0 })] {
            let refused = ask(&mut session, &json!({ "do": "answer", "agent": agent, "choice": "wait" }));
            assert!(refused["error"]["message"].as_str().expect("words").contains("is not asked"), "{refused}");
        }
        assert!(ask(&mut session, &json!({ "do": "sing" }))["error"]["message"].is_string());
    }

    #[test]
    fn rivals_are_policies_of_the_side() {
        let mut session = Session::default();
        open(&mut session, "fleet", &[]);
        let rivals = ask(&mut session, &json!({ "do": "rivals", "side": "unimog" }));
        assert_eq!(rivals.as_array().expect("a list").len(), DispatchPolicy::ALL.len());
        let changes = &rivals[1]["changes"];
        let result = ask(&mut session, &json!({ "do": "rival", "changes": changes }));
        assert!(result["saved"].is_number(), "{result}");
    }
}
