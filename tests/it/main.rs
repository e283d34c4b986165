//! Public behaviour.

mod archive;
mod budgets;
mod client;
mod command;
mod draws;
mod elisions;
mod errors;
mod files;
mod formats;
mod frames;
mod gallery;
mod guard;
mod measure;
mod metrics;
mod pick;
mod pictures;
mod plan;
mod random_scene;
mod reference;
mod render_once;
mod reports;
mod scenes;
mod service;
mod slopes;
mod socket;
mod streams;
mod turntables;
mod unchanged;

use rasterd::report::random;
use rasterd::report::selftest::instruments::{box_on_floor, closed_form, draw};
