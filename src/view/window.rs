//! Opens the window.

use std::num::NonZero;
use std::sync::{Arc, Mutex, PoisonError};

use bevy::DefaultPlugins;
use bevy::app::{App, AppExit, PanicHandlerPlugin, PluginGroup, TerminalCtrlCHandlerPlugin};
use bevy::prelude::{ImagePlugin, Resource, World};
use bevy::render::RenderPlugin;
use bevy::render::error_handler::{RenderError, RenderErrorHandler, RenderErrorPolicy};
use bevy::render::renderer::initialize_renderer;
use bevy::render::settings::{Backends, RenderCreation, RenderResources, WgpuSettings};
use bevy::tasks::block_on;
use bevy::window::{PresentMode, Window, WindowPlugin, WindowResizeConstraints, WindowResolution};

use super::failure::{display, quietly};
use super::{Player, PlayerPlugin, Programme, Reels, ScreenPlugin, Sheet, ViewError, Viewer};
use crate::picture::film::Layout;

/// Opens the window and returns when it is closed.
///
/// # Errors
/// Where there is no display, or nothing to draw with, or where that is lost.
pub fn play(programme: Programme) -> Result<(), ViewError> {
    let mut app = window(programme)?;
    let last_words = LastWords::default();
    app.insert_resource(last_words.clone()).insert_resource(RenderErrorHandler(give_up));
    app.run();
    last_words.take().map_or(Ok(()), |reason| Err(ViewError::AdapterLost { reason }))
}

/// The window, which opens when the app runs.
///
/// # Errors
/// Where there is no display, or nothing to draw with.
pub fn window(programme: Programme) -> Result<App, ViewError> {
    let display = display()?;
    let renderer = quietly(renderer).map_err(|_| ViewError::NoAdapter)?;
    quietly(|| app(programme, renderer)).map_err(|report| ViewError::of_window(report, display))
}

/// Made here and not by bevy's plugin, so that a missing adapter is told from a missing display.
fn renderer() -> RenderResources {
    let backends = Backends::from_env().unwrap_or(Backends::PRIMARY);
    let settings = WgpuSettings { backends: Some(backends), ..WgpuSettings::default() };
    block_on(initialize_renderer(backends, None, &settings))
}

fn app(programme: Programme, renderer: RenderResources) -> App {
    let plugins = DefaultPlugins
        .set(WindowPlugin { primary_window: Some(primary_window(programme.size)), ..WindowPlugin::default() })
        .set(RenderPlugin {
            render_creation: RenderCreation::Manual(renderer),
            synchronous_pipeline_compilation: true,
            ..RenderPlugin::default()
        })
        // Where a pixel of the sheet is one of the display, it shows as it is.
        .set(ImagePlugin::default_nearest())
        // The command line has its own ways with both.
        .disable::<PanicHandlerPlugin>()
        .disable::<TerminalCtrlCHandlerPlugin>();
    let mut app = App::new();
    app.add_plugins(plugins).add_plugins((PlayerPlugin, ScreenPlugin));
    seat(&mut app, programme);
    app
}

/// Gives an app with a [`PlayerPlugin`] what it needs.
pub fn seat(app: &mut App, programme: Programme) {
    let reels = Reels::new(programme.films);
    let mut player = Player::new(programme.start, reels.end(), programme.speed);
    if programme.is_paused {
        player.pause();
    }
    app.insert_resource(Sheet::new(programme.size, reels.films().len()))
        .insert_resource(Viewer { look: programme.look, message: None })
        .insert_resource(player)
        .insert_resource(reels);
}

fn primary_window((width, height): (u32, u32)) -> Window {
    Window {
        title: "wildfire".into(),
        name: Some("wildfire".into()),
        resolution: WindowResolution::new(width, height),
        resize_constraints: WindowResizeConstraints {
            min_width: Layout::LEAST_WIDTH as f32,
            min_height: Layout::LEAST_HEIGHT as f32,
            ..WindowResizeConstraints::default()
        },
        present_mode: PresentMode::AutoVsync,
        ..Window::default()
    }
}

/// Why the adapter could not go on, kept for when the window is closed.
#[derive(Clone, Default, Resource)]
struct LastWords(Arc<Mutex<Option<String>>>);

impl LastWords {
    fn take(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

fn give_up(error: &RenderError, world: &mut World, _: &mut World) -> RenderErrorPolicy {
    let words: Vec<&str> = error.description.split_whitespace().collect();
    let reason = format!("{:?}: {}", error.ty, words.join(" "));
    let last_words = world.resource::<LastWords>();
    last_words.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(reason);
    world.write_message(AppExit::Error(NonZero::<u8>::MIN));
    RenderErrorPolicy::StopRendering
}
