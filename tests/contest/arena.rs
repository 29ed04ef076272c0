//! What the scenario `arena` promises: planners differ in it, and who does not plan saves nothing.

use std::thread;

use wildfire::Pose;
use wildfire::planning::{
    Goal, MakeError, Plan, PlanFailure, PlannerContext, Planners, TruckPlanner, TruckPlannerKind,
};
use wildfire::scenario;
use wildfire::sim;
use wildfire::stats::Series;
use wildfire::timeline::Outcome;
use wildfire::vehicle::Path;

/// Cells put out in the first seeds, by the planner of this name.
fn put_out(planner: &str, seeds: u64, planners: &Planners) -> Vec<f64> {
    let changes = [format!("planner.{planner}.command=[]"), format!("unimog.planner={planner}")];
    let built_in = TruckPlannerKind::ALL.iter().any(|kind| kind.name() == planner);
    let arena = scenario::load("arena", &changes[usize::from(built_in)..]).expect("it is built in");
    let run = |seed| {
        let run = sim::run_with(&arena, seed, planners).expect("it takes place");
        let outcome = Outcome::new(&run.timeline);
        assert!(outcome.intact <= 1, "{planner}, seed {seed}: what nobody saves burns");
        outcome.extinguished as f64
    };
    (1..=seeds).map(run).collect()
}

#[test]
fn built_in_planners_are_told_apart_by_five_standard_errors() {
    // A quarter of the hundred seeds for which that is promised.
    let of = |kind: TruckPlannerKind| move || put_out(kind.name(), 25, &Planners::default());
    let workers = TruckPlannerKind::ALL.map(|kind| (kind, thread::spawn(of(kind))));
    let found = workers.map(|(kind, worker)| (kind, worker.join().expect("its runs take place")));
    for (place, (one, ours)) in found.iter().enumerate() {
        for (other, theirs) in &found[place + 1..] {
            let differences: Vec<f64> = ours.iter().zip(theirs).map(|(ours, theirs)| theirs - ours).collect();
            let series = Series::from_values(&differences);
            let (mean, error) = series.mean().zip(series.standard_error()).expect("25 differences");
            assert!(mean.abs() > 5.0 * error, "{other} less {one}: {mean} +- {error}");
        }
    }
}

/// A planner with one answer.
struct Always(fn(Pose) -> Plan);

impl TruckPlanner for Always {
    fn plan(&mut self, start: Pose, _: Goal) -> Plan {
        (self.0)(start)
    }
}

#[test]
fn empty_answers_save_nothing() {
    let answers: [fn(Pose) -> Plan; 2] =
        [|_| Plan::from(Err(PlanFailure::Disconnected)), |start| Plan::from(Ok(Path { start, segments: Vec::new() }))];
    for answer in answers {
        let maker =
            move |_: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> { Ok(Box::new(Always(answer))) };
        let planners = Planners::default().with("silent", maker).expect("the name is free");
        assert_eq!(put_out("silent", 3, &planners), [0.0; 3]);
    }
}
