//! Hands what happens to the window to the desk, in the order in which it happened.

use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::{MouseButton, MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::prelude::{Local, MessageReader, ResMut};
use bevy::window::WindowEvent;

use super::Command;
use super::desk::Desk;
use super::mouse::{Gesture, Mouse};

/// So many pixels of a smooth wheel are a notch of a coarse one.
const NOTCH_PIXELS: f32 = 40.0;

/// Does all that was asked for since the last frame. The stream of all events is read, since those of one kind alone do
/// not say whether a button was pressed before or after the mouse moved.
pub fn listen(
    mut events: MessageReader<WindowEvent>,
    mut is_shifted: Local<bool>,
    mut mouse: ResMut<Mouse>,
    mut desk: Desk,
) {
    for event in events.read() {
        let gesture = match event {
            WindowEvent::KeyboardInput(key) => {
                press_key(key, &mut is_shifted, &mut desk);
                None
            }
            WindowEvent::KeyboardFocusLost(_) => {
                *is_shifted = false;
                None
            }
            WindowEvent::CursorMoved(moved) => {
                mouse.go_to(desk.sheet.place(moved.position.into()), desk.sheet.layout())
            }
            WindowEvent::MouseButtonInput(button) => click(button, &mut mouse, &desk),
            WindowEvent::MouseWheel(wheel) => mouse.wheel(notches(wheel), desk.sheet.layout()),
            _ => None,
        };
        if let Some(gesture) = gesture {
            desk.follow(gesture);
        }
    }
}

fn press_key(key: &KeyboardInput, is_shifted: &mut bool, desk: &mut Desk) {
    let is_pressed = key.state == ButtonState::Pressed;
    if key.logical_key == Key::Shift {
        *is_shifted = is_pressed;
        return;
    }
    let command = Command::of(&key.logical_key, *is_shifted).filter(|command| !key.repeat || command.repeats());
    if let (true, Some(command)) = (is_pressed, command) {
        desk.obey(command);
    }
}

fn click(button: &MouseButtonInput, mouse: &mut Mouse, desk: &Desk) -> Option<Gesture> {
    match (button.button, button.state) {
        (MouseButton::Left, ButtonState::Pressed) => mouse.press(desk.sheet.layout()),
        (MouseButton::Left, ButtonState::Released) => mouse.release(desk.sheet.layout()),
        _ => None,
    }
}

fn notches(wheel: &MouseWheel) -> f64 {
    f64::from(match wheel.unit {
        MouseScrollUnit::Line => wheel.y,
        MouseScrollUnit::Pixel => wheel.y / NOTCH_PIXELS,
    })
}
