//! The window: events of the system in, frames out.

use super::app::App;
use super::wish::Report;
use egui_wgpu::WgpuConfiguration;
use egui_wgpu::winit::Painter;
use std::num::NonZeroU32;
use std::sync::Arc;
use std::time::{Duration, Instant};
use steradian::{Error, Result};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::error::EventLoopError;
use winit::event::{ElementState, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

const VIEWPORT: egui::ViewportId = egui::ViewportId::ROOT;

/// The engine has news.
pub(super) struct News;

/// Opens the event loop; without a display this fails.
pub(super) fn event_loop() -> Result<EventLoop<News>> {
    EventLoop::with_user_event().build().map_err(|error| {
        let reason = match error {
            // Its own text is about its source code.
            EventLoopError::Os(_) => {
                "there is no display, or it does not answer (WAYLAND_DISPLAY, DISPLAY)".to_owned()
            }
            other => other.to_string(),
        };
        Error::NoDevice(format!("no window can be opened: {reason}; `steradian render` needs none"))
    })
}

/// A way to wake the loop from another thread.
pub(super) fn waker(events: &EventLoop<News>) -> impl Fn() + Send + Sync + 'static {
    let proxy: EventLoopProxy<News> = events.create_proxy();
    move || {
        // After the loop's end there is nobody to wake.
        let _ = proxy.send_event(News);
    }
}

/// Runs until the window is closed, or `should_end`.
pub(super) fn run(
    events: EventLoop<News>,
    app: &mut App,
    should_end: impl Fn() -> bool,
) -> Result<()> {
    let mut shell = Shell { app, open: None, failure: None, should_end, was_titled: String::new() };
    events.run_app(&mut shell).map_err(|e| Error::NoDevice(format!("the window: {e}")))?;
    shell.failure.map_or(Ok(()), Err)
}

/// Everything between the system and [`App`].
struct Shell<'a, F> {
    app: &'a mut App,
    open: Option<Open>,
    failure: Option<Error>,
    should_end: F,
    was_titled: String,
}

/// An open window.
struct Open {
    window: Arc<Window>,
    context: egui::Context,
    input: egui_winit::State,
    painter: Painter,
    /// When egui wants to draw again by itself.
    next: Option<Instant>,
}

impl Open {
    fn new(events: &ActiveEventLoop, size: (f32, f32)) -> Result<Self> {
        let failure = |what: String| Error::NoDevice(format!("no window can be opened: {what}"));
        let attributes = Window::default_attributes()
            .with_title("Steradian")
            .with_min_inner_size(LogicalSize::new(480.0, 320.0))
            .with_inner_size(LogicalSize::new(size.0, size.1));
        let window = events.create_window(attributes).map_err(|e| failure(e.to_string()))?;
        let window = Arc::new(window);
        let context = egui::Context::default();
        super::theme::apply(&context);
        let configuration = WgpuConfiguration {
            wgpu_setup: egui_wgpu::WgpuSetup::from_display_handle(events.owned_display_handle()),
            surface: egui_wgpu::SurfaceConfig::LOW_LATENCY,
            ..Default::default()
        };
        // Bytes of the picture reach the display as they are.
        let options = egui_wgpu::RendererOptions { dithering: false, ..Default::default() };
        let mut painter =
            pollster::block_on(Painter::new(context.clone(), configuration, false, options));
        pollster::block_on(painter.set_window(VIEWPORT, Some(window.clone())))
            .map_err(|e| failure(e.to_string()))?;
        let scale = Some(window.scale_factor() as f32);
        let side = painter.max_texture_side();
        let input =
            egui_winit::State::new(context.clone(), VIEWPORT, &window, scale, window.theme(), side);
        Ok(Self { window, context, input, painter, next: None })
    }

    /// Draws one frame and shows it.
    fn draw(&mut self, app: &mut App) {
        let raw = self.input.take_egui_input(&self.window);
        let mut output = self.context.run_ui(raw, |ui| app.ui(ui));
        self.input.handle_platform_output(&self.window, output.platform_output);
        let shapes = self.context.tessellate(output.shapes, output.pixels_per_point);
        self.painter.paint_and_update_textures(
            VIEWPORT,
            output.pixels_per_point,
            [0.0, 0.0, 0.0, 1.0],
            &shapes,
            &mut output.textures_delta,
            Vec::new(),
            &self.window,
        );
        let delay = output.viewport_output.get(&VIEWPORT).map(|v| v.repaint_delay);
        self.next = match delay {
            Some(Duration::ZERO) => {
                self.window.request_redraw();
                None
            }
            delay => delay.and_then(|d| Instant::now().checked_add(d)),
        };
    }
}

impl<F: Fn() -> bool> Shell<'_, F> {
    fn title(&mut self, report: &Report) {
        let Some(open) = &self.open else { return };
        let title = match &report.scene {
            Some(scene) => format!("{} - Steradian", scene.name),
            None => "Steradian".into(),
        };
        if title != self.was_titled {
            open.window.set_title(&title);
            self.was_titled = title;
        }
    }

    fn draw(&mut self, events: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        let size = open.window.inner_size();
        if size.width == 0 || size.height == 0 {
            // Minimised.
            return;
        }
        open.draw(self.app);
        let shown = self.app.canvas.shown.as_ref();
        let is_first = self.app.latency.is_new();
        self.app.latency.presented(shown);
        if is_first {
            crate::cli::talk::line("window open");
        }
        if self.app.is_over {
            events.exit();
        }
    }
}

impl<F: Fn() -> bool> ApplicationHandler<News> for Shell<'_, F> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match Open::new(events, self.app.preferences.window) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(error) => {
                self.failure = Some(error);
                events.exit();
            }
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, _: News) {
        if (self.should_end)() {
            events.exit();
        }
        self.title(&self.app.report());
        if let Some(open) = &self.open {
            open.window.request_redraw();
        }
    }

    fn new_events(&mut self, events: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &mut self.open) {
            open.next = None;
            open.window.request_redraw();
        }
        if (self.should_end)() {
            events.exit();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let next = self.open.as_ref().and_then(|open| open.next);
        // Signals come without an event.
        let soon = Instant::now() + Duration::from_millis(250);
        events.set_control_flow(ControlFlow::WaitUntil(next.map_or(soon, |n| n.min(soon))));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match &event {
            WindowEvent::CloseRequested => return events.exit(),
            WindowEvent::RedrawRequested => return self.draw(events),
            WindowEvent::Resized(size) => {
                let sides = (NonZeroU32::new(size.width), NonZeroU32::new(size.height));
                if let (Some(width), Some(height)) = sides {
                    open.painter.on_window_resized(VIEWPORT, width, height);
                    let points = size.to_logical(open.window.scale_factor());
                    self.app.preferences.window = (points.width, points.height);
                }
            }
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                self.app.latency.input();
            }
            WindowEvent::MouseInput { .. }
            | WindowEvent::MouseWheel { .. }
            | WindowEvent::CursorMoved { .. } => self.app.latency.input(),
            _ => {}
        }
        if open.input.on_window_event(&open.window, &event).repaint {
            open.window.request_redraw();
        }
    }
}
