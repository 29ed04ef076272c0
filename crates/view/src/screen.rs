//! Shows the frame as one texture on a sprite that covers the window, and the runs in the window's title.

use std::time::Duration;

use bevy::app::{App, Plugin, Startup, Update};
use bevy::asset::{Assets, RenderAssetUsages};
use bevy::math::Vec2;
use bevy::prelude::{
    Camera2d, Changed, Commands, Component, Image, IntoScheduleConfigs, Local, Msaa, Query, Real, Res, ResMut, Single,
    Sprite, Time, Window, With,
};
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::window::PrimaryWindow;
use bevy::winit::{UpdateMode, WinitSettings};

use crate::{FrameBuffer, Player, RunSet, ViewSystems};
use wildfire_picture::film::{RunView, format_clock};

/// While nothing changes the frame is shown again at this interval, in case the display has lost it.
const IDLE: Duration = Duration::from_secs(1);

/// At first frames follow one another for this long, while the adapter gets ready.
const WARM_UP: Duration = Duration::from_secs(2);

/// The window's part of a frame; needs [`super::PlayerPlugin`] and bevy's plugins of a window.
pub struct ScreenPlugin;

impl Plugin for ScreenPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, spawn_camera_and_screen).add_systems(
            Update,
            (fit_frame_buffer.before(ViewSystems::Time), (show_frame, set_title, set_pace).after(ViewSystems::Draw)),
        );
    }
}

/// Marks the sprite that carries the frame.
#[derive(Component)]
struct Screen;

fn spawn_camera_and_screen(mut commands: Commands, mut images: ResMut<Assets<Image>>, frame_buffer: Res<FrameBuffer>) {
    commands.spawn((Camera2d, Msaa::Off));
    commands.spawn((Screen, Sprite::from_image(images.add(texture(frame_buffer.size())))));
}

/// A texture that gets its pixels later.
fn texture((width, height): (u32, u32)) -> Image {
    let size = Extent3d { width, height, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba8UnormSrgb;
    Image::new_uninit(size, TextureDimension::D2, format, RenderAssetUsages::RENDER_WORLD)
}

/// The frame has the pixels of the display, however many of them the window counts as one.
fn fit_frame_buffer(
    windows: Query<&Window, (With<PrimaryWindow>, Changed<Window>)>,
    mut sprite: Single<&mut Sprite, With<Screen>>,
    mut frame_buffer: ResMut<FrameBuffer>,
) {
    let Ok(window) = windows.single() else { return };
    sprite.custom_size = Some(Vec2::new(window.width(), window.height()));
    let size = window.physical_size();
    let scale = f64::from(window.scale_factor());
    frame_buffer.fit((size.x, size.y), scale);
}

/// The texture keeps its place in the adapter's memory as long as the frame keeps its size.
fn show_frame(
    sprite: Single<&Sprite, With<Screen>>,
    mut images: ResMut<Assets<Image>>,
    mut frame_buffer: ResMut<FrameBuffer>,
) {
    let Some(pixels) = frame_buffer.take_painted() else { return };
    let Some(mut image) = images.get_mut(&sprite.image) else { return };
    let (width, height) = frame_buffer.size();
    image.texture_descriptor.size = Extent3d { width, height, depth_or_array_layers: 1 };
    image.data = Some(pixels);
}

/// Lets a window in which nothing moves take no processor time.
fn set_pace(mut settings: ResMut<WinitSettings>, player: Res<Player>, runs: Res<RunSet>, time: Res<Time<Real>>) {
    let rests = player.is_paused() && !runs.is_waiting() && time.elapsed() > WARM_UP;
    let mode = if rests { UpdateMode::reactive_low_power(IDLE) } else { UpdateMode::Continuous };
    // Windows that one looks at need not be those that one types in.
    *settings = WinitSettings { focused_mode: mode, unfocused_mode: mode };
}

/// While playing the title changes no more often than this.
const PERIOD: Duration = Duration::from_millis(250);

pub fn set_title(
    mut windows: Query<&mut Window, With<PrimaryWindow>>,
    mut changed: Local<Duration>,
    time: Res<Time<Real>>,
    player: Res<Player>,
    runs: Res<RunSet>,
) {
    let is_early = time.elapsed() < *changed + PERIOD;
    let (false, Ok(mut window)) = (is_early && !player.is_paused(), windows.single_mut()) else { return };
    let title = window_title(&player, &runs);
    if window.title != title {
        window.title = title;
        *changed = time.elapsed();
    }
}

fn window_title(player: &Player, runs: &RunSet) -> String {
    let runs: Vec<String> = runs.runs().into_iter().map(run_title).collect();
    let pace = if player.is_paused() { "paused".into() } else { format!("{} x", player.speed()) };
    format!("{} - {} - {pace}", runs.join(" | "), format_clock(player.clock()))
}

fn run_title(run: &RunView) -> String {
    format!("{}, seed {}", run.title(), run.timeline().setting.seed)
}
