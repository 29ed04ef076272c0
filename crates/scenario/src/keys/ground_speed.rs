//! Ground that slows trucks, by its fuel: `unimog.speed_by_ground`.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::faults::check::{Check, TablePath};
use crate::{FuelName, Terrain, Unimog};
use wildfire_base::geometry::FieldFrame;
use wildfire_base::trajectory::GroundSpeed;

/// The name of all ground that is not named.
const OTHER: &str = "other";

/// The least share of its speed that a truck keeps.
const MIN_SHARE: f64 = 0.01;

/// Shares of a truck's speed by the code of a fuel, or for all other ground.
pub type SpeedByGround = BTreeMap<String, f64>;

pub(crate) fn check(table: &TablePath, shares: &SpeedByGround) -> Check {
    let table = table.inner("speed_by_ground");
    shares.iter().try_for_each(|(name, &share)| {
        if name != OTHER && FuelName::parse(name).is_none() {
            return table.refuse(name, name.clone(), format!("the code of a fuel such as `NB9`, or `{OTHER}`"));
        }
        table.number(name, share, MIN_SHARE..=1.0)
    })
}

/// The kinds of ground of a field, which are numbers of fuel models, by cell index.
#[derive(Clone, Debug)]
pub struct GroundKinds {
    frame: FieldFrame,
    kinds: Arc<[u8]>,
}

impl GroundKinds {
    /// `None` where a field has only bushes.
    pub fn new(terrain: &Terrain) -> Option<Self> {
        let landscape = terrain.landscape.as_ref()?;
        Some(Self { frame: terrain.frame, kinds: landscape.fuel.as_slice().into() })
    }
}

impl Unimog {
    /// Returns the share of its speed that it keeps, by the number of the fuel; `None` where nothing slows it.
    pub fn ground_shares(&self) -> Option<[f64; 256]> {
        if self.speed_by_ground.is_empty() {
            return None;
        }
        let mut shares = [self.speed_by_ground.get(OTHER).copied().unwrap_or(1.0); 256];
        for (name, &share) in &self.speed_by_ground {
            FuelName::parse(name).into_iter().for_each(|fuel| shares[usize::from(fuel.number())] = share);
        }
        Some(shares)
    }

    /// Returns how fast it is where on a field.
    pub fn ground_speed(&self, ground: Option<&GroundKinds>) -> Option<GroundSpeed> {
        let GroundKinds { frame, kinds } = ground?;
        Some(GroundSpeed::new(*frame, Arc::clone(kinds), self.ground_shares()?))
    }
}
