//! `rasterd render`

use super::Failure;
use super::beside::Gathered;
use rasterd::http::Problem;
use rasterd::jobs::{Format, Renderer};
use rasterd::plan::FrameRequest;
use rasterd::scene::{Files, ModelOptions, NewScene, UpAxis};
use rasterd::settings::{Machine, Settings};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The arguments of `rasterd render`.
#[derive(Debug, clap::Args)]
pub(super) struct Render {
    /// A scene document or models; files that they name are looked up beside them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// The PNG to write; - is standard output
    #[arg(short, long, value_name = "OUT")]
    out: PathBuf,

    #[command(flatten)]
    frame: FrameFlags,

    /// Which of a model's axes is up
    #[arg(long, value_parser = up_axis, default_value = "y", value_name = "y|z")]
    up: UpAxis,

    /// Whether to put a floor under a model
    #[arg(long, default_value_t = true, action = clap::ArgAction::Set, value_name = "true|false")]
    floor: bool,

    #[command(flatten)]
    machine: Machine,
}

/// The frame query, each parameter a flag. Values stay text: the query's own reader checks them, so
/// that a flag takes what a URL takes.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
struct FrameFlags {
    /// Pixels in a row
    #[arg(long, allow_hyphen_values = true)]
    width: Option<String>,
    /// Rows
    #[arg(long, allow_hyphen_values = true)]
    height: Option<String>,
    /// Samples a pixel: 1, 2, 4, 8 or 16
    #[arg(long, allow_hyphen_values = true)]
    samples: Option<String>,
    /// Seconds
    #[arg(long, allow_hyphen_values = true)]
    t: Option<String>,
    /// JPEG quality, 1 to 100
    #[arg(long, allow_hyphen_values = true)]
    quality: Option<String>,
    /// color, depth, normal, albedo, instance or wireframe
    #[arg(long, allow_hyphen_values = true)]
    output: Option<String>,
    /// blinn_phong, lambert, unlit, vertex_color or normal, in place of every material's
    #[arg(long, allow_hyphen_values = true)]
    shading: Option<String>,
    /// Where the camera stands: x,y,z
    #[arg(long, allow_hyphen_values = true)]
    eye: Option<String>,
    /// What it looks at: x,y,z
    #[arg(long, allow_hyphen_values = true)]
    target: Option<String>,
    /// Vertical field of view in degrees
    #[arg(long, allow_hyphen_values = true)]
    fov: Option<String>,
    /// Nearest distance drawn
    #[arg(long, allow_hyphen_values = true)]
    near: Option<String>,
    /// Farthest distance drawn
    #[arg(long, allow_hyphen_values = true)]
    far: Option<String>,
    /// Orthographic, with this full height of the view
    #[arg(long, allow_hyphen_values = true)]
    ortho: Option<String>,
    /// About the target: yaw,pitch in degrees, and ,distance
    #[arg(long, allow_hyphen_values = true)]
    orbit: Option<String>,
    /// transparent, rrggbb, or a name of the document's backgrounds
    #[arg(long, allow_hyphen_values = true)]
    background: Option<String>,
}

impl FrameFlags {
    fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        let flags: [(&str, _); 15] = [
            ("width", &self.width),
            ("height", &self.height),
            ("samples", &self.samples),
            ("t", &self.t),
            ("quality", &self.quality),
            ("output", &self.output),
            ("shading", &self.shading),
            ("eye", &self.eye),
            ("target", &self.target),
            ("fov", &self.fov),
            ("near", &self.near),
            ("far", &self.far),
            ("ortho", &self.ortho),
            ("orbit", &self.orbit),
            ("background", &self.background),
        ];
        flags.into_iter().filter_map(|(name, value)| Some((name, value.as_deref()?)))
    }
}

impl Render {
    /// Files → scene → picture → file.
    pub(super) fn run(self) -> Result<(), Failure> {
        let request = FrameRequest::parse(self.frame.pairs()).map_err(|faults| Problem::query(&faults))?;
        let format = format_of(&self.out)?;
        let new = read(&self.files, ModelOptions { up: self.up, floor: self.floor })?;
        let settings = Settings { machine: self.machine, ..environment()? };
        let scene = std::sync::Arc::new(new.compile(&settings.limits())?);
        let renderer =
            Renderer::new(&settings).map_err(|error| Failure::new("cannot start threads", error))?;
        for warning in &scene.warnings {
            eprintln!("rasterd: {}{}", place(warning), warning.detail);
        }
        let rendered = renderer.render_now(&scene, &request, format)?;
        write(&self.out, &rendered.bytes).map_err(|error| Failure::new(self.out.display(), error))
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

/// By the file's ending; standard output takes a PNG.
fn format_of(out: &Path) -> Result<Format, Failure> {
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        None | Some("png") => Ok(Format::Png),
        Some(other) => Err(Failure(format!("this version writes pictures as .png alone, not as .{other}"))),
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

fn write(out: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if out == Path::new("-") {
        let mut stdout = std::io::stdout().lock();
        stdout.write_all(bytes)?;
        stdout.flush()
    } else {
        std::fs::write(out, bytes)
    }
}

fn up_axis(text: &str) -> Result<UpAxis, String> {
    match text {
        "y" => Ok(UpAxis::Y),
        "z" => Ok(UpAxis::Z),
        _ => Err("must be y or z".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rasterd::plan::request::Query;

    #[derive(clap::Parser)]
    struct Flags {
        #[command(flatten)]
        render: Render,
    }

    fn parse(arguments: &[&str]) -> Render {
        use clap::Parser;
        Flags::try_parse_from(arguments).expect("usage").render
    }

    #[test]
    fn every_frame_query_is_a_flag() {
        let mut query = Query::new([]);
        FrameRequest::read(&mut query);
        let command = <Flags as clap::CommandFactory>::command();
        let flags: Vec<&str> = command.get_arguments().filter_map(|flag| flag.get_long()).collect();
        for name in query.known().iter().filter(|name| !FrameRequest::NOT_YET.contains(name)) {
            assert!(flags.contains(name), "{name}");
        }
    }

    #[test]
    fn a_value_may_start_with_a_minus() {
        let render = parse(&["render", "a.obj", "-o", "-", "--orbit", "-30,20", "--eye", "-1,2,3"]);
        let pairs: Vec<_> = render.frame.pairs().collect();
        assert_eq!(pairs, [("eye", "-1,2,3"), ("orbit", "-30,20")]);
    }

    #[test]
    fn the_ending_picks_the_format() {
        assert!(format_of(Path::new("-")).is_ok() && format_of(Path::new("a/b.PNG")).is_ok());
        assert!(format_of(Path::new("a.jpg")).is_err());
    }
}
