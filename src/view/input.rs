//! Hands what happens to the window to the controls, in the order in which it happened.

use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::{MouseButton, MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::prelude::{Local, MessageReader, ResMut};
use bevy::window::WindowEvent;

use super::Command;
use super::controls::Controls;
use super::mouse::{Gesture, Mouse};

/// So many pixels of a smooth wheel are a notch of a coarse one.
const NOTCH_PIXELS: f32 = 40.0;

/// Does all that was asked for since the last frame. The stream of all events is read, since those of one kind alone do
/// not say whether a button was pressed before or after the mouse moved.
pub fn listen(
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
    let command = Command::from_key(&key.logical_key, *is_shifted).filter(|command| !key.repeat || command.repeats());
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
