//! Keys and mouse: the commands of keys, and window events passed to the controls in their order.

use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::{MouseButton, MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::prelude::{Local, MessageReader, ResMut};
use bevy::window::WindowEvent;

use crate::controls::Controls;
use crate::mouse::{Gesture, Mouse};
use wildfire_picture::film::Layer;

/// Pixels of a smooth wheel that count as one notch of a coarse one.
const NOTCH_PIXELS: f32 = 40.0;

/// Does all that was asked for since the last frame. The stream of all events is read, since those of one kind alone do
/// not say whether a button was pressed before or after the mouse moved.
pub fn read_input(
    mut events: MessageReader<WindowEvent>,
    mut is_shifted: Local<bool>,
    mut mouse: ResMut<Mouse>,
    mut controls: Controls,
) {
    for event in events.read() {
        let gesture = match event {
            WindowEvent::KeyboardInput(key) => {
                press_key(key, &mut is_shifted, &mut controls);
                None
            }
            WindowEvent::KeyboardFocusLost(_) => {
                // The release of the key goes to the window that has the focus by then, and shift would stay down here.
                *is_shifted = false;
                None
            }
            WindowEvent::CursorMoved(moved) => {
                mouse.go_to(controls.frame_buffer.place(moved.position.into()), controls.frame_buffer.layout())
            }
            WindowEvent::MouseButtonInput(button) => click(button, &mut mouse, &controls),
            WindowEvent::MouseWheel(wheel) => mouse.wheel(notches(wheel), controls.frame_buffer.layout()),
            _ => None,
        };
        if let Some(gesture) = gesture {
            controls.follow(gesture);
        }
    }
}

fn press_key(key: &KeyboardInput, is_shifted: &mut bool, controls: &mut Controls) {
    let is_pressed = key.state == ButtonState::Pressed;
    if key.logical_key == Key::Shift {
        *is_shifted = is_pressed;
        return;
    }
    let command =
        KeyCommand::from_key(&key.logical_key, *is_shifted).filter(|command| !key.repeat || command.repeats());
    if let (true, Some(command)) = (is_pressed, command) {
        controls.apply_command(command);
    }
}

fn click(button: &MouseButtonInput, mouse: &mut Mouse, controls: &Controls) -> Option<Gesture> {
    match (button.button, button.state) {
        (MouseButton::Left, ButtonState::Pressed) => mouse.press(controls.frame_buffer.layout()),
        (MouseButton::Left, ButtonState::Released) => mouse.release(controls.frame_buffer.layout()),
        _ => None,
    }
}

fn notches(wheel: &MouseWheel) -> f64 {
    f64::from(match wheel.unit {
        MouseScrollUnit::Line => wheel.y,
        MouseScrollUnit::Pixel => wheel.y / NOTCH_PIXELS,
    })
}

/// The commands of keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KeyCommand {
    TogglePause,
    NextEvent,
    PreviousEvent,
    /// Moves the clock by this many seconds; negative ones go back.
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

impl KeyCommand {
    /// Returns the command of a key; letters in either case, signs wherever the layout of the keyboard has them.
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

    /// Returns whether a key that is held down asks for it again and again; what is switched is switched once.
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
            // On many keyboards `=` is the key of `+` without shift.
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
    use wildfire_picture::film::{BINDINGS, Binding};

    fn typed(text: &str) -> Option<KeyCommand> {
        KeyCommand::from_key(&Key::Character(text.into()), false)
    }

    #[test]
    fn arrows_seek_further_with_shift() {
        assert_eq!(KeyCommand::from_key(&Key::ArrowRight, false), Some(KeyCommand::Seek(10.0)));
        assert_eq!(KeyCommand::from_key(&Key::ArrowLeft, true), Some(KeyCommand::Seek(-60.0)));
    }

    #[test]
    fn letters_count_in_either_case_and_other_keys_do_nothing() {
        assert_eq!(typed("q"), Some(KeyCommand::Quit));
        assert_eq!(typed("Q"), Some(KeyCommand::Quit));
        assert_eq!(typed("="), typed("+"));
        assert_eq!(typed("ü"), None);
        assert_eq!(typed("qq"), None);
        assert_eq!(KeyCommand::from_key(&Key::Tab, false), None);
    }

    #[test]
    fn every_layer_has_its_key() {
        for layer in Layer::ALL {
            assert_eq!(typed(&layer.key().to_string()), Some(KeyCommand::Toggle(layer)), "{}", layer.name());
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
