//! Keys and mouse of the player, listed once for help, documents and tests.

use super::Layer;

/// A key, or a few, and what they do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The names of keys with spaces between them.
    pub keys: &'static str,
    pub does: &'static str,
}

const fn binding(keys: &'static str, does: &'static str) -> Binding {
    Binding { keys, does }
}

/// All but those of the layers, see [`Layer::key`].
pub const BINDINGS: [Binding; 18] = [
    binding("Space", "pause, play"),
    binding(". ,", "next, previous event"),
    binding("Left Right", "10 s back, forward"),
    binding("Shift Left Right", "60 s back, forward"),
    binding("+ -", "faster, slower"),
    binding("Home End", "start, end"),
    binding("mouse on timeline", "go to that time"),
    binding("wheel", "zoom at the mouse"),
    binding("drag", "move the field"),
    binding("Z", "the whole field"),
    binding("F", "follow the fleet, the next agent"),
    binding("click", "story of a bush or agent"),
    binding("Esc", "close the story or the help"),
    binding("R", "run with the next seed"),
    binding("N P", "next, previous seed of the batch"),
    binding("S", "save a still"),
    binding("? H", "show these keys"),
    binding("Q", "quit"),
];

impl Layer {
    /// The key that switches it: digits in the order of [`Layer::ALL`], then letters.
    pub fn key(self) -> char {
        match self {
            Self::Paths => '1',
            Self::Suppression => '2',
            Self::Spread => '3',
            Self::Ages => '4',
            Self::GridLines => '5',
            Self::Roadmap => '6',
            Self::Query => '7',
            Self::LocalSearch => '8',
            Self::WumpusSearch => '9',
            Self::Clearance => '0',
            Self::CostMap => 'C',
            Self::Wavefront => 'W',
            Self::Ground => 'G',
            Self::Wet => 'B',
            Self::Embers => 'E',
            Self::Wind => 'V',
            Self::Arrival => 'A',
            Self::Intensity => 'I',
            Self::FireType => 'Y',
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_does_two_things() {
        let layers = Layer::ALL.map(|layer| layer.key().to_string());
        let others = BINDINGS.iter().filter(|binding| !binding.keys.starts_with("Shift"));
        let mut keys: Vec<&str> = others.flat_map(|binding| binding.keys.split(' ')).collect();
        keys.extend(layers.iter().map(String::as_str));
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
    }
}
