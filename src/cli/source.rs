//! Files on the command line → scene.

use super::Failure;
use super::beside::Gathered;
use rasterd::jobs::Renderer;
use rasterd::scene::{Files, ModelOptions, NewScene, Scene, UpAxis};
use rasterd::settings::{Machine, Settings};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a scene is made of.
#[derive(Debug, clap::Args)]
pub(super) struct Source {
    /// A scene document or models; files that they name are looked up beside them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Which of a model's axes is up
    #[arg(long, value_parser = up_axis, default_value = "y", value_name = "y|z")]
    up: UpAxis,

    /// Whether to put a floor under a model
    #[arg(long, default_value_t = true, action = clap::ArgAction::Set, value_name = "true|false")]
    floor: bool,
}

impl Source {
    /// What draws on `machine`, and the scene; its warnings go to standard error.
    pub(super) fn open(&self, machine: Machine) -> Result<(Renderer, Arc<Scene>), Failure> {
        let new = read(&self.files, ModelOptions { up: self.up, floor: self.floor })?;
        let settings = Settings { machine, ..environment()? };
        let renderer =
            Renderer::new(&settings).map_err(|error| Failure::new("cannot start threads", error))?;
        let scene = Arc::new(renderer.build(|| new.compile(renderer.limits()))?);
        for warning in &scene.warnings {
            super::say(format_args!("{}{}", place(warning), warning.detail));
        }
        Ok((renderer, scene))
    }

    /// What the first of the files is called, without folder and ending.
    pub(super) fn name(&self) -> String {
        let stem = self.files.first().and_then(|file| file.file_stem());
        stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
    }
}

/// Limits and the like, as the server takes them.
fn environment() -> Result<Settings, Failure> {
    Settings::from_environment().map_err(|error| Failure::new("the environment", error))
}

/// Where a warning points: `file, line 3: `.
fn place(warning: &rasterd::scene::Warning) -> String {
    match (&warning.file, warning.line) {
        (Some(file), Some(line)) => format!("warning: {file}, line {line}: "),
        (Some(file), None) => format!("warning: {file}: "),
        _ => "warning: ".to_owned(),
    }
}

/// The document or the models among `paths`, with all files that they name.
fn read(paths: &[PathBuf], options: ModelOptions) -> Result<NewScene, Failure> {
    let (mut document, mut gathered) = (None, Gathered::default());
    for path in paths {
        let bytes = std::fs::read(path).map_err(|error| Failure::new(path.display(), error))?;
        let read = rasterd::http::sniffed(bytes.into(), options)
            .map_err(|problem| Failure::new(path.display(), problem))?;
        match read.document {
            Some(_) if document.is_some() => {
                return Err(Failure::new(path.display(), "is a second scene document"));
            }
            Some(read) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                gathered.add_named_by_document(&read, folder)?;
                document = Some(read);
            }
            None => {
                let name = file_name(path, paths.len() == 1);
                for (_, bytes) in read.files.iter().flat_map(Files::iter) {
                    gathered.add_model(&name, path, bytes.clone())?;
                }
            }
        }
    }
    Ok(NewScene { document, files: Some(gathered.into_files()), options })
}

/// The name a file given on the command line goes by; a lone one is a model whatever it is called.
fn file_name(path: &Path, alone: bool) -> String {
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let is_obj = Path::new(&name).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj"));
    if alone && !is_obj { format!("{name}.obj") } else { name }
}

fn up_axis(text: &str) -> Result<UpAxis, String> {
    match text {
        "y" => Ok(UpAxis::Y),
        "z" => Ok(UpAxis::Z),
        _ => Err("must be y or z".to_owned()),
    }
}
