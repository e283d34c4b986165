//! Pictures against closed forms in f64, and a small set of golden pictures.

mod coverage;
mod cube_sides;
mod effects;
mod examples;
mod faces;
mod golden;
mod knobs;
mod lighting;
mod maps;
mod outputs;
mod post;
mod radiance;
mod relief;
mod sampler;
mod shadows;
mod sky;
mod soft_shadows;
mod stages;
mod textures;
mod transparency;
