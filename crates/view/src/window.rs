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
use super::{FrameBuffer, Player, PlayerPlugin, RunSet, ScreenPlugin, ViewError, Viewer, ViewerConfig};
use wildfire_picture::film::FrameLayout;

/// Opens the window and returns when it is closed.
///
/// # Errors
/// Where there is no display, or nothing to draw with, or where that is lost.
pub fn play(config: ViewerConfig) -> Result<(), ViewError> {
    let mut app = window(config)?;
    let failure = RenderFailure::default();
    app.insert_resource(failure.clone()).insert_resource(RenderErrorHandler(give_up));
    app.run();
    failure.take().map_or(Ok(()), |reason| Err(ViewError::AdapterLost { reason }))
}

/// The window, which opens when the app runs.
///
/// # Errors
/// Where there is no display, or nothing to draw with.
pub fn window(config: ViewerConfig) -> Result<App, ViewError> {
    let display = display()?;
    let renderer = quietly(renderer).map_err(|_| ViewError::NoAdapter)?;
    quietly(|| app(config, renderer)).map_err(|report| ViewError::from_window_panic(report, display))
}

/// Made here and not by bevy's plugin, so that a missing adapter is told from a missing display.
fn renderer() -> RenderResources {
    let backends = Backends::from_env().unwrap_or(Backends::PRIMARY);
    let settings = WgpuSettings { backends: Some(backends), ..WgpuSettings::default() };
    block_on(initialize_renderer(backends, None, &settings))
}

fn app(config: ViewerConfig, renderer: RenderResources) -> App {
    let plugins = DefaultPlugins
        .set(WindowPlugin { primary_window: Some(primary_window(config.size)), ..WindowPlugin::default() })
        .set(RenderPlugin {
            render_creation: RenderCreation::Manual(renderer),
            synchronous_pipeline_compilation: true,
            ..RenderPlugin::default()
        })
        // Where a pixel of the frame is one of the display, it shows as it is.
        .set(ImagePlugin::default_nearest())
        // The command line has its own ways with both.
        .disable::<PanicHandlerPlugin>()
        .disable::<TerminalCtrlCHandlerPlugin>();
    let mut app = App::new();
    app.add_plugins(plugins).add_plugins((PlayerPlugin, ScreenPlugin));
    insert_resources(&mut app, config);
    app
}

/// Gives an app with a [`PlayerPlugin`] what it needs.
pub fn insert_resources(app: &mut App, config: ViewerConfig) {
    let runs = RunSet::new(config.runs);
    let mut player = Player::new(config.start, runs.end(), config.speed);
    if config.is_paused {
        player.pause();
    }
    app.insert_resource(FrameBuffer::new(config.size, runs.runs().len()))
        .insert_resource(Viewer { options: config.options, message: None })
        .insert_resource(player)
        .insert_resource(runs);
}

fn primary_window((width, height): (u32, u32)) -> Window {
    Window {
        title: "wildfire".into(),
        name: Some("wildfire".into()),
        resolution: WindowResolution::new(width, height),
        resize_constraints: WindowResizeConstraints {
            min_width: FrameLayout::MIN_WIDTH as f32,
            min_height: FrameLayout::MIN_HEIGHT as f32,
            ..WindowResizeConstraints::default()
        },
        present_mode: PresentMode::AutoVsync,
        ..Window::default()
    }
}

/// Why the adapter could not go on, kept for when the window is closed.
#[derive(Clone, Default, Resource)]
struct RenderFailure(Arc<Mutex<Option<String>>>);

impl RenderFailure {
    fn take(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

fn give_up(error: &RenderError, world: &mut World, _: &mut World) -> RenderErrorPolicy {
    let parts: Vec<&str> = error.description.split_whitespace().collect();
    let reason = format!("{:?}: {}", error.ty, parts.join(" "));
    let failure = world.resource::<RenderFailure>();
    failure.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(reason);
    world.write_message(AppExit::Error(NonZero::<u8>::MIN));
    RenderErrorPolicy::StopRendering
}
