//! The reference against closed forms, and the renderer against the reference.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod closed_forms;
mod everything;
mod forms;
mod lobes;
mod media;
mod renderer;
