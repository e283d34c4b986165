//! Public behaviour.

mod archive;
mod box_on_floor;
mod client;
mod closed_form;
mod command;
mod draw;
mod draws;
mod errors;
mod files;
mod formats;
mod frames;
mod gallery;
mod guard;
mod measure;
mod metrics;
mod numerics;
mod pick;
mod pictures;
mod random;
mod render_once;
mod scenes;
mod service;
mod socket;
mod streams;
mod turntables;
mod unchanged;
