//! The curves between two poses.

use crate::cli::curve::args::{CurveArguments, End};
use crate::geometry::Pose;
use crate::vehicle::curve::Letters;
use crate::vehicle::{CurvePrice, Dubins, Path, ReedsShepp, reeds_shepp};

/// The curves between one pair of poses.
pub struct CurveReport {
    pub from: End,
    pub to: End,
    pub radius_m: f64,
    /// The shortest Reeds-Shepp curve, the shortest Dubins curve, and, if prices were given, the cheapest Reeds-Shepp
    /// curve.
    pub curves: Vec<FoundCurve>,
}

/// A curve of some kind, laid out from the start.
pub struct FoundCurve {
    /// As programs read it.
    pub kind: &'static str,
    /// As people read it.
    pub name: &'static str,
    pub word: String,
    /// The number of letters of the word; those of no length are not in the path.
    pub letters: usize,
    /// The paper's family, of Reeds-Shepp curves.
    pub family: Option<String>,
    pub length_m: f64,
    /// The prices that were to be minimal, and the sum; `None` if the length was.
    pub price: Option<(CurvePrice, f64)>,
    pub path: Path,
}

impl CurveReport {
    /// Computes the curves between two poses.
    pub fn new(from: End, to: End, arguments: &CurveArguments) -> Self {
        let radius_m = arguments.radius;
        let (start, goal) = (from.pose(), to.pose());
        let reeds_shepp = ReedsShepp { radius_m };
        let mut curves = vec![
            reeds_shepp_curve("reeds_shepp", "Reeds-Shepp", &reeds_shepp.shortest(start, goal), start),
            dubins_curve(&Dubins { radius_m }, start, goal),
        ];
        if let Some(price) = arguments.price() {
            let cheapest = reeds_shepp.cheapest(start, goal, &price);
            let curve = reeds_shepp_curve("cheapest_reeds_shepp", "Cheapest Reeds-Shepp", &cheapest.curve, start);
            curves.push(FoundCurve { price: Some((price, cheapest.price)), ..curve });
        }
        Self { from, to, radius_m, curves }
    }
}

fn reeds_shepp_curve(kind: &'static str, name: &'static str, curve: &reeds_shepp::Curve, start: Pose) -> FoundCurve {
    FoundCurve {
        kind,
        name,
        word: curve.word.to_string(),
        letters: curve.word.letters().count(),
        family: Some(curve.word.family().to_string()),
        length_m: curve.length_m,
        price: None,
        path: curve.path(start),
    }
}

fn dubins_curve(dubins: &Dubins, start: Pose, goal: Pose) -> FoundCurve {
    let curve = dubins.shortest(start, goal);
    FoundCurve {
        kind: "dubins",
        name: "Dubins",
        word: curve.word.to_string(),
        letters: curve.word.letters().count(),
        family: None,
        length_m: curve.length_m,
        price: None,
        path: curve.path(start),
    }
}
