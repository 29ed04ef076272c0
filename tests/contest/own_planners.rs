//! Planners that are registered: they play by the rules, and what they do wrong costs them a query and nobody a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Duration;

use wildfire::audit_timeline;
use wildfire::batch::execute::{Batch, OutputFolder};
use wildfire::batch::plan::{BatchPlan, Record};
use wildfire::batch::table::FinishedBatch;
use wildfire::planning::{
    CpuSource, Effort, Goal, GoalDisc, MakeError, Plan, PlanFailure, PlannerContext, PlannerName, Planners, QueryCpu,
    TruckPlanner,
};
use wildfire::scenario::{self, Scenario, TruckPlannerContext, Unimog};
use wildfire::sim::{self, CustomRegistry, RunError};
use wildfire::timeline::{AgentFact, Fact, Outcome, RestReason, Timeline};
use wildfire::vehicle::{Path, ReedsShepp, Segment};
use wildfire::{Pose, rng};

/// A planner that answers by a function.
struct Answers<F>(F);

impl<F: FnMut(Pose, Goal) -> Plan + Send + Sync> TruckPlanner for Answers<F> {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        (self.0)(start, goal)
    }
}

/// Makes the planner of a name that answers by a function of the site.
fn planners<F>(name: &str, answers: impl Fn(&PlannerContext<'_>) -> F + Send + Sync + 'static) -> Planners
where
    F: FnMut(Pose, Goal) -> Plan + Send + Sync + 'static,
{
    let maker = move |site: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
        Ok(Box::new(Answers(answers(site))))
    };
    Planners::default().with(name, maker).expect("the name is free")
}

/// Plans the shortest curve to one of a few poses about the goal, where that is free.
fn short_curves(site: &PlannerContext<'_>) -> impl FnMut(Pose, Goal) -> Plan + Send + Sync + use<> {
    let checker = site.checker.clone();
    move |start, goal| {
        let curves = ReedsShepp { radius_m: checker.body().turning_radius_m };
        let ends = match goal {
            Goal::Pose(end) => vec![end],
            Goal::Disc(GoalDisc { centre, .. }) => (0..16)
                .map(|k| {
                    let out = Pose::new(0.0, 0.0, f64::from(k) * std::f64::consts::TAU / 16.0);
                    let place = centre + out.direction() * 8.0;
                    let body = checker.body().body_centre(Pose::new(0.0, 0.0, out.heading));
                    Pose::new(place.x - body.x, place.y - body.y, out.heading)
                })
                .collect(),
        };
        let free = ends.into_iter().map(|end| curves.shortest(start, end).path(start)).filter(|path| {
            goal.is_met(path.end(), checker.body())
                && path.legs().all(|(pose, segment)| checker.motion_is_free(pose, segment, 0.1))
        });
        let shortest = free.min_by(|a, b| a.length_m().total_cmp(&b.length_m()));
        Plan {
            effort: Effort { roadmap_expansions: 0, local_expansions: 16 },
            ..shortest.ok_or(PlanFailure::Disconnected).into()
        }
    }
}

fn load(name: &str, changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    scenario::load(name, &changes).expect("this scenario is right")
}

fn driven_by(name: &str, scenario: &str, changes: &[&str]) -> Scenario {
    let planner = [format!("planner.{name}.command=[]"), format!("unimog.planner={name}")];
    load(
        scenario,
        &[&planner[0], &planner[1]].into_iter().map(String::as_str).chain(changes.iter().copied()).collect::<Vec<_>>(),
    )
}

fn failures(timeline: &Timeline) -> Vec<PlanFailure> {
    let failure = |fact: &Fact| match fact {
        Fact::Agent(agent, AgentFact::PlanFailed { reason, .. }) if agent.role.suppresses() => Some(*reason),
        _ => None,
    };
    timeline.events.iter().filter_map(|event| failure(&event.fact)).collect()
}

#[test]
fn a_planner_of_ones_own_plays_twenty_seeds_and_the_audit_finds_nothing() {
    let scenario = driven_by("own", "contest", &["duration_s=900"]);
    let planners = planners("own", short_curves);
    let mut put_out = 0;
    for seed in 1..=20 {
        let run = sim::run_with(&scenario, seed, &planners).expect("it takes place");
        let verdict = audit_timeline(&run.timeline, Default::default());
        assert!(verdict.violation.is_none(), "seed {seed}: {:?}", verdict.violation);
        let outcome = Outcome::new(&run.timeline);
        put_out += outcome.extinguished;
        let truck = run.cost.agents.iter().find(|agent| agent.agent.role.suppresses()).expect("it has a truck");
        assert_eq!(truck.source, Some(CpuSource::Thread));
        let again = sim::run_with(&scenario, seed, &planners).expect("it takes place");
        assert_eq!(again.timeline, run.timeline, "seed {seed} gives the same run twice");
    }
    assert!(put_out > 100, "{put_out} fires put out");
}

#[test]
fn a_batch_runs_planners_of_ones_own_and_its_rows_are_those_of_single_runs() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let scenario = driven_by("own", "smoke", &[]);
    let changes = ["planner.own.command=[]".to_owned(), "unimog.planner=own".to_owned()];
    let seeds = "1..12".parse().expect("these seeds are fine");
    let plan = BatchPlan::from_scenario("smoke", &changes, scenario.clone(), seeds, Record::None);
    let folder = OutputFolder::named(&scratch.path().join("own"), false).expect("it is free");
    let mut batch = Batch::begin(plan, folder).expect("it begins");
    let planners = planners("own", short_curves);
    let never = Arc::new(AtomicBool::new(false));
    let registry = CustomRegistry { planners: planners.clone(), ..CustomRegistry::default() };
    batch.run(&registry, 2, &never, |_| {}).expect("all runs take place");
    batch.finish(&never).expect("it is written");
    let finished = FinishedBatch::open(&scratch.path().join("own")).expect("it is finished");
    let runs: Vec<_> = finished.runs().collect();
    let mut rows = finished.rows().expect("they are read").expect("there are rows");
    for run in runs {
        let row = rows.next(&run).expect("it is there");
        let alone = sim::run_with(&scenario, run.seed, &planners).expect("it takes place");
        let extinguished = row.number(wildfire::batch::table::run_column("extinguished"));
        assert_eq!(extinguished, Some(Outcome::new(&alone.timeline).extinguished.into()), "seed {}", run.seed);
    }
}

#[test]
fn who_never_answers_saves_nothing_unless_rescued() {
    let silent = planners("silent", |_| |_, _| Plan::from(Err(PlanFailure::Disconnected)));
    for seed in 1..=3 {
        let alone = sim::run_with(&driven_by("silent", "contest", &[]), seed, &silent).expect("it takes place");
        let outcome = Outcome::new(&alone.timeline);
        assert_eq!(outcome.extinguished, 0, "seed {seed}");
        assert!(
            alone
                .timeline
                .events
                .iter()
                .any(|event| matches!(event.fact, Fact::Agent(_, AgentFact::Rested { reason: RestReason::NoPlan })))
        );
        let rescued = driven_by("silent", "contest", &["unimog.rescue=true"]);
        let rescued = sim::run_with(&rescued, seed, &silent).expect("it takes place");
        assert!(Outcome::new(&rescued.timeline).extinguished > 100, "seed {seed}");
        let truck = Outcome::new(&rescued.timeline).agents.pop().expect("it has a truck");
        assert_eq!(truck.lattice_plans, truck.plans - truck.failures.sum(), "all its drives were rescues");
    }
}

#[test]
fn built_in_planners_go_without_rescue_where_the_scenario_says_so() {
    let rescued = load("dense", &["field.coverage=0.4", "unimog.planner=prm+primitives", "duration_s=1200"]);
    let mut alone = rescued.clone();
    alone.unimog.iter_mut().for_each(|truck| truck.rescue = scenario::FallbackMode::Never);
    let mut rescues = 0;
    for seed in 1..=4 {
        let plans = |scenario| {
            let outcome = Outcome::new(&sim::run(scenario, seed).expect("it takes place").timeline);
            outcome.agents.iter().map(|agent| agent.lattice_plans).sum::<u32>()
        };
        rescues += plans(&rescued);
        assert_eq!(plans(&alone), 0, "seed {seed}");
    }
    assert!(rescues > 0, "nobody needed rescue");
}

#[test]
fn what_the_gate_refuses_is_a_bad_answer_with_words_and_the_run_goes_on() {
    let through_everything = |_: &PlannerContext<'_>| {
        |start: Pose, goal: Goal| {
            let Goal::Disc(disc) = goal else { return Plan::from(Err(PlanFailure::Disconnected)) };
            let curves = ReedsShepp { radius_m: 7.0 };
            Plan::from(Ok(curves.shortest(start, Pose::new(disc.centre.x, disc.centre.y, 0.0)).path(start)))
        }
    };
    let run = sim::run_with(&driven_by("blind", "contest-1", &[]), 1, &planners("blind", through_everything));
    let run = run.expect("it takes place");
    let failures = failures(&run.timeline);
    assert!(failures.len() > 20 && failures.iter().all(|&reason| reason == PlanFailure::BadAnswer), "{failures:?}");
    assert_eq!((run.messages.count, run.messages.first.len()), (failures.len() as u64, 20));
    let first = &run.messages.first[0];
    assert!(first.starts_with("unimog/0 at ") && first.contains("bad answer: segment 1 of "), "{first}");
    let text = run.messages.to_string();
    assert!(text.contains(" times)") && text.matches("bad answer: ").count() < 5, "one of each kind: {text}");
    assert!(audit_timeline(&run.timeline, Default::default()).violation.is_none());
}

#[test]
fn a_panic_is_a_crash_and_what_a_planner_says_of_its_effort_cannot_overflow() {
    let query_count = Arc::new(AtomicU32::new(0));
    let counter = Arc::clone(&query_count);
    let panics = planners("panics", move |_| {
        let counter = Arc::clone(&counter);
        move |_, _| {
            let times = counter.fetch_add(1, Ordering::Relaxed);
            assert!(times % 2 == 1, "not again, for the {times}th time");
            let effort = Effort { roadmap_expansions: u32::MAX, local_expansions: u32::MAX };
            Plan { effort, ..Plan::from(Err(PlanFailure::BudgetSpent)) }
        }
    });
    let run = sim::run_with(&driven_by("panics", "smoke", &[]), 1, &panics).expect("it takes place");
    let failures = failures(&run.timeline);
    assert_eq!(failures.len() as u32, query_count.load(Ordering::Relaxed));
    assert_eq!(failures[0], PlanFailure::Crashed);
    assert!(run.messages.first[0].contains("it panicked: not again, for the 0th time"), "{:?}", run.messages.first);
}

#[test]
fn a_planner_that_cannot_be_built_fails_the_run_with_its_name_and_the_reason() {
    let maker = |_: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
        Err(MakeError::new("no map for this field"))
    };
    let planners = Planners::default().with("lost", maker).expect("the name is free");
    let scenario = driven_by("lost", "smoke", &[]);
    let error = sim::run_with(&scenario, 1, &planners).expect_err("it cannot be built");
    assert_eq!(error.to_string(), "unimog/0 has no planner: `lost` could not be built: no map for this field");
    let nobody = sim::run(&scenario, 1).expect_err("nobody handed it in");
    assert!(matches!(&nobody, RunError::NoPlanner { name, .. } if name.name() == "lost"), "{nobody}");
    assert!(nobody.to_string().contains("is neither built in nor registered"), "{nobody}");
}

#[test]
fn a_planner_sees_its_truck_its_settings_and_a_stream_of_its_own() {
    let scenario = load(
        "smoke",
        &["planner.own.settings.range_m=12.5", "planner.own.settings.names=[\"a\"]", "unimog.planner=own"],
    );
    let truck = scenario.unimog[0].clone();
    let planners = planners("own", |site: &PlannerContext<'_>| {
        assert_eq!(site.custom_settings, &serde_json::json!({ "range_m": 12.5, "names": ["a"] }));
        assert_eq!((site.truck, site.limits.forward_mps), (0, 8.0));
        assert_eq!(site.body, site.checker.body());
        let drawn = (site.stream)("own");
        assert_eq!(drawn, rng::stream(7, "truck/0/own"));
        |_, _| Plan::from(Err(PlanFailure::Disconnected))
    });
    sim::run_with(&scenario, 7, &planners).expect("it takes place");
    assert_eq!(truck.planner, PlannerName::new("own").expect("it has the form"));
}

#[test]
fn planning_time_is_charged_for_the_expansions_that_answers_report() {
    let charged = driven_by("own", "smoke", &["planner.own.seconds_per_expansion=0.25"]);
    let run = sim::run_with(&charged, 3, &planners("own", short_curves)).expect("it takes place");
    let truck = Outcome::new(&run.timeline).agents.pop().expect("it has a truck");
    assert_eq!(truck.planning_s, 4.0 * f64::from(truck.plans), "16 expansions of 0.25 s for every query");
}

#[test]
fn cpu_times_that_somebody_else_measured_count_and_say_where_they_come_from() {
    let elsewhere = planners("own", |site: &PlannerContext<'_>| {
        let mut answers = short_curves(site);
        move |start, goal| Plan {
            cpu: Some(QueryCpu { time: Duration::from_secs(2), starting: Duration::ZERO, source: CpuSource::Process }),
            ..answers(start, goal)
        }
    });
    let run = sim::run_with(&driven_by("own", "smoke", &[]), 3, &elsewhere).expect("it takes place");
    let truck = run.cost.agents.last().expect("it has a truck");
    let plans = Outcome::new(&run.timeline).agents.pop().expect("it has a truck").plans;
    assert_eq!((truck.source, truck.elsewhere), (Some(CpuSource::Process), Duration::from_secs(2) * plans));
    assert!(run.cost.total >= truck.elsewhere);
}

#[test]
fn names_that_nobody_has_are_refused_with_the_place_and_the_nearest() {
    let refused = |changes: &[&str]| {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let error = scenario::load("contest", &changes).expect_err("it is refused");
        (error.to_string(), error.fault.advice().unwrap_or_default())
    };
    let (sentence, help) = refused(&["planner.rrt.command=[\"rrt\"]", "unimog.planner=rtt"]);
    assert_eq!(sentence, "`unimog.planner` is `rtt`, and no planner of this name is known");
    assert!(help.starts_with("did you mean `rrt`?") && help.contains("[planner.NAME]"), "{help}");
    let (sentence, _) = refused(&["unimog.planner=RRT"]);
    assert!(sentence.contains("1 to 40 of `a-z 0-9 + - _ .`"), "{sentence}");
    let (sentence, _) = refused(&["planner.lattice.command=[\"mine\"]"]);
    assert!(sentence.contains("`planner.lattice`") && sentence.contains("built-in"), "{sentence}");
    for (change, word) in [
        ("planner.rrt.query_limit_s=0", "`planner.rrt.query_limit_s`"),
        ("planner.rrt.commands=[\"a\"]", "unknown field `commands`"),
        ("planner.rrt.restarts=-1", "planner.rrt.restarts"),
    ] {
        let (sentence, _) = refused(&[change]);
        assert!(sentence.contains(word), "{change}: {sentence}");
    }
}

#[test]
fn no_path_of_a_built_in_planner_is_refused_by_the_judge() {
    for (name, changes) in [("contest", [""; 0].as_slice()), ("dense", &[]), ("fleet", &[])] {
        let scenario = load(name, changes);
        let terrain = scenario::Terrain::from_scenario(&scenario, 1).expect("it has room");
        let field = Arc::new(wildfire::ClearanceField::new(terrain.frame, &terrain.occupied));
        let checker = wildfire::CollisionChecker::new(field, scenario.unimog[0].vehicle);
        let judge = wildfire::planning::judge::Judge::new(checker.clone());
        for kind in wildfire::planning::TruckPlannerKind::ALL {
            let truck = Unimog { planner: kind.into(), ..scenario.unimog[0].clone() };
            let mut planner = truck
                .make_planner(&TruckPlannerContext {
                    ground: None,
                    truck: 0,
                    seed: 1,
                    checker: &checker,
                    memory: &wildfire::planning::memory::MemoryMeter::unlimited(),
                    planners: &Planners::default(),
                    programs: &scenario.planner,
                })
                .expect("it is built in");
            let mut start = truck.start.pose();
            let mut driven = 0;
            for &bush in terrain.bushes.iter().cycle().take(250) {
                let goal = Goal::Disc(GoalDisc { centre: terrain.frame.centre(bush), radius_m: 10.0 });
                let Ok(path) = planner.plan(start, goal).path else { continue };
                judge.check(start, goal, &path).unwrap_or_else(|bad| panic!("{name}, {kind}: {bad}"));
                start = path.end();
                driven += 1;
            }
            assert!(driven > 100, "{name}, {kind}: {driven} drives");
        }
    }
}

#[test]
fn curvatures_of_single_precision_pass_and_sharper_ones_do_not() {
    for (excess, passes) in [(0.0, true), (9e-7, true), (2e-6, false)] {
        let bent = planners("bent", move |site: &PlannerContext<'_>| {
            let (sharpest, mut answers) = (site.body.max_curvature(), short_curves(site));
            move |start, goal| {
                let mut plan = answers(start, goal);
                if let Ok(path) = &mut plan.path {
                    path.segments.iter_mut().for_each(|segment: &mut Segment| {
                        if segment.curvature != 0.0 {
                            segment.curvature = (sharpest * (1.0 + excess)).copysign(segment.curvature);
                        }
                    });
                }
                plan
            }
        });
        let run = sim::run_with(&driven_by("bent", "smoke", &[]), 3, &bent).expect("it takes place");
        let refused = failures(&run.timeline).contains(&PlanFailure::BadAnswer);
        assert_eq!(!refused, passes, "{excess}: {}", run.messages);
        assert!(passes || run.messages.to_string().contains("a turn of radius"), "{}", run.messages);
        assert!(audit_timeline(&run.timeline, Default::default()).violation.is_none());
    }
}

#[test]
fn a_path_without_segments_stays_where_it_is() {
    let stays = planners("stays", |_| |start: Pose, _| Plan::from(Ok(Path { start, segments: Vec::new() })));
    let run = sim::run_with(&driven_by("stays", "smoke", &[]), 1, &stays).expect("it takes place");
    let failures = failures(&run.timeline);
    assert!(failures.iter().all(|&reason| reason == PlanFailure::BadAnswer) && !failures.is_empty());
}

#[test]
fn calls_of_the_checker_are_charged_where_no_expansions_are_reported() {
    let charged = driven_by("own", "arena", &["duration_s=600"]);
    let planners_that_report = |reports: bool| {
        planners("own", move |site: &PlannerContext<'_>| {
            let mut inner = wildfire::planning::planners::hybrid_astar::HybridAstar::build(site);
            move |start, goal| {
                let plan = TruckPlanner::plan(&mut inner, start, goal);
                Plan { effort: if reports { plan.effort } else { Effort::default() }, ..plan }
            }
        })
    };
    let spent = |reports| {
        let run = sim::run_with(&charged, 3, &planners_that_report(reports)).expect("it takes place");
        let truck = Outcome::new(&run.timeline).agents.pop().expect("it has a truck");
        truck.planning_s
    };
    // An expansion of this planner takes five or six calls, since one answer is good for several motions; eight are the price
    // of an expansion, by the rules.
    let share = spent(false) / spent(true);
    assert!((0.6..0.8).contains(&share), "{share}");
}
