//! The project's own sprites. The header of each file says what its units are.

use std::sync::LazyLock;

use super::sprite::Sprite;

pub static BUSH: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/bush.txt")));
pub static EMBERS: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/embers.txt")));
pub static BURNED: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/burned.txt")));
pub static WET: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/wet.txt")));
pub static FLAME: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/flame.txt")));
pub static WUMPUS: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/wumpus.txt")));
pub static UNIMOG: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/unimog.txt")));
pub static WHEEL: LazyLock<Sprite> = LazyLock::new(|| read(include_str!("../../../../assets/sprites/wheel.txt")));

fn read(text: &str) -> Sprite {
    Sprite::read(text).expect("sprites are part of the program, and a test reads all of them")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sprites_stay_near_what_they_stand_for() {
        // Points pull smooth lines, which stay inside them; a torch and its flame stick out of the square body.
        for (name, sprite, (along, across)) in [
            ("bush", &BUSH, (0.65, 0.65)),
            ("embers", &EMBERS, (0.65, 0.65)),
            ("burned", &BURNED, (0.65, 0.65)),
            ("wet", &WET, (0.65, 0.65)),
            ("flame", &FLAME, (0.5, 1.15)),
            ("wumpus", &WUMPUS, (0.95, 0.6)),
            ("unimog", &UNIMOG, (2.45, 1.1)),
            ("wheel", &WHEEL, (0.5, 0.2)),
        ] {
            let reach = sprite.reach();
            assert!(reach.0 <= along && reach.1 <= across, "{name} reaches {reach:?}");
        }
    }
}
