//! What a key asks for.

use bevy::input::keyboard::Key;

use crate::picture::film::Layer;

/// What a viewer asks for with one key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    TogglePause,
    NextEvent,
    PreviousEvent,
    /// By so many seconds, back where they are negative.
    Seek(f64),
    Faster,
    Slower,
    ToStart,
    ToEnd,
    WholeField,
    FollowNext,
    Deselect,
    /// From the beginning, with the next seed.
    Rerun,
    NextSeed,
    PreviousSeed,
    SaveStill,
    Toggle(Layer),
    ToggleHelp,
    Quit,
}

impl Command {
    /// What a key asks for; letters in either case, signs wherever the layout of the keyboard has them.
    pub fn from_key(key: &Key, is_shifted: bool) -> Option<Self> {
        let step = if is_shifted { 60.0 } else { 10.0 };
        match key {
            Key::Space => Some(Self::TogglePause),
            Key::ArrowLeft => Some(Self::Seek(-step)),
            Key::ArrowRight => Some(Self::Seek(step)),
            Key::Home => Some(Self::ToStart),
            Key::End => Some(Self::ToEnd),
            Key::Escape => Some(Self::Deselect),
            Key::Character(text) => Self::from_text(text),
            _ => None,
        }
    }

    /// Whether a key that is held down asks for it again and again; what is switched is switched once.
    pub fn repeats(self) -> bool {
        matches!(self, Self::NextEvent | Self::PreviousEvent | Self::Seek(_) | Self::Faster | Self::Slower)
    }

    fn from_text(text: &str) -> Option<Self> {
        let mut letters = text.chars();
        let (Some(letter), None) = (letters.next(), letters.next()) else { return None };
        let letter = letter.to_ascii_lowercase();
        match letter {
            '.' => Some(Self::NextEvent),
            ',' => Some(Self::PreviousEvent),
            '+' | '=' => Some(Self::Faster),
            '-' => Some(Self::Slower),
            'z' => Some(Self::WholeField),
            'f' => Some(Self::FollowNext),
            'r' => Some(Self::Rerun),
            'n' => Some(Self::NextSeed),
            'p' => Some(Self::PreviousSeed),
            's' => Some(Self::SaveStill),
            '?' | 'h' => Some(Self::ToggleHelp),
            'q' => Some(Self::Quit),
            _ => Layer::ALL.into_iter().find(|layer| layer.key().eq_ignore_ascii_case(&letter)).map(Self::Toggle),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::film::{BINDINGS, Binding};

    fn typed(text: &str) -> Option<Command> {
        Command::from_key(&Key::Character(text.into()), false)
    }

    #[test]
    fn arrows_seek_further_with_shift() {
        assert_eq!(Command::from_key(&Key::ArrowRight, false), Some(Command::Seek(10.0)));
        assert_eq!(Command::from_key(&Key::ArrowLeft, true), Some(Command::Seek(-60.0)));
    }

    #[test]
    fn letters_count_in_either_case_and_other_keys_do_nothing() {
        assert_eq!(typed("q"), Some(Command::Quit));
        assert_eq!(typed("Q"), Some(Command::Quit));
        assert_eq!(typed("="), typed("+"));
        assert_eq!(typed("ü"), None);
        assert_eq!(typed("qq"), None);
        assert_eq!(Command::from_key(&Key::Tab, false), None);
    }

    #[test]
    fn every_layer_has_its_key() {
        for layer in Layer::ALL {
            assert_eq!(typed(&layer.key().to_string()), Some(Command::Toggle(layer)), "{}", layer.name());
        }
    }

    #[test]
    fn every_key_that_help_names_does_something() {
        let is_typed = |binding: &&Binding| binding.keys.split(' ').all(|key| key.len() == 1);
        let typed_bindings: Vec<_> = BINDINGS.iter().filter(is_typed).collect();
        assert!(typed_bindings.len() > 5);
        for binding in typed_bindings {
            assert!(binding.keys.split(' ').all(|key| typed(key).is_some()), "{}", binding.keys);
        }
    }
}
