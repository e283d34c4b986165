//! `rasterd render`

use super::Failure;
use super::beside::Gathered;
use super::destination::Destination;
use rasterd::http::Problem;
use rasterd::jobs::{Product, Renderer};
use rasterd::plan::FrameRequest;
use rasterd::plan::request::Query;
use rasterd::scene::{Files, ModelOptions, NewScene, UpAxis};
use rasterd::settings::{Machine, Settings};
use std::path::{Path, PathBuf};

/// The arguments of `rasterd render`.
#[derive(Debug, clap::Args)]
pub(super) struct Render {
    /// A scene document or models; files that they name are looked up beside them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// The file to write, of the kind that its ending says: .png, .jpg, .webp, .exr, .hdr; a turntable
    /// as .gif or .apng; several outputs as .zip. - is standard output, PNG
    #[arg(short, long, value_name = "OUT", value_parser = Destination::parser())]
    out: Destination,

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
    /// Texels along a side of every shadow map
    #[arg(long, allow_hyphen_values = true, value_name = "TEXELS")]
    shadow_resolution: Option<String>,
    /// Samples of every PCF
    #[arg(long, allow_hyphen_values = true, value_name = "TAPS")]
    pcf_taps: Option<String>,
    /// Samples with which PCSS looks for blockers
    #[arg(long, allow_hyphen_values = true, value_name = "TAPS")]
    search_taps: Option<String>,
    /// Samples with which PCSS filters
    #[arg(long, allow_hyphen_values = true, value_name = "TAPS")]
    filter_taps: Option<String>,
    /// nearest, bilinear or trilinear, in place of every texture's but those that are nearest themselves
    #[arg(long, allow_hyphen_values = true, value_name = "FILTER")]
    texture_filter: Option<String>,
    /// The picture is drawn with so many times the pixels along each side, and resampled
    #[arg(long, allow_hyphen_values = true, value_name = "TIMES")]
    render_scale: Option<String>,
    /// Seconds
    #[arg(long, allow_hyphen_values = true)]
    t: Option<String>,
    /// JPEG quality, 1 to 100
    #[arg(long, allow_hyphen_values = true)]
    quality: Option<String>,
    /// color, depth, normal, albedo, instance, wireframe; of the stages ids, shadow_map, tiles or shaded
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
    /// Of a turntable: frames of a whole turn [default: 36]
    #[arg(long, allow_hyphen_values = true)]
    frames: Option<String>,
    /// Of an archive: outputs with commas between [default: all but the stages]
    #[arg(long, allow_hyphen_values = true)]
    outputs: Option<String>,
}

impl FrameFlags {
    fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        let flags: [(&str, _); 23] = [
            ("width", &self.width),
            ("height", &self.height),
            ("samples", &self.samples),
            ("shadow_resolution", &self.shadow_resolution),
            ("pcf_taps", &self.pcf_taps),
            ("search_taps", &self.search_taps),
            ("filter_taps", &self.filter_taps),
            ("texture_filter", &self.texture_filter),
            ("render_scale", &self.render_scale),
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
            ("frames", &self.frames),
            ("outputs", &self.outputs),
        ];
        flags.into_iter().filter_map(|(name, value)| Some((name, value.as_deref()?)))
    }
}

impl Render {
    /// Files → scene → picture → file.
    pub(super) fn run(self) -> Result<(), Failure> {
        self.check_usage().unwrap_or_else(|error| error.exit());
        let (product, request) = self.query()?;
        let new = read(&self.files, ModelOptions { up: self.up, floor: self.floor })?;
        let settings = Settings { machine: self.machine, ..environment()? };
        let renderer =
            Renderer::new(&settings).map_err(|error| Failure::new("cannot start threads", error))?;
        let scene = std::sync::Arc::new(renderer.build(|| new.compile(renderer.limits()))?);
        for warning in &scene.warnings {
            super::say(format_args!("{}{}", place(warning), warning.detail));
        }
        let rendered = renderer.render_now(&scene, &request, product)?;
        self.out.write(&rendered.bytes).map_err(|error| Failure::new(&self.out, error))
    }

    /// Refuses flags that the kind of file has no use for.
    fn check_usage(&self) -> Result<(), clap::Error> {
        let flags = [("frames", &self.frame.frames), ("outputs", &self.frame.outputs)];
        let idle = flags.iter().find(|(name, value)| value.is_some() && !self.out.takes(name));
        idle.map_or(Ok(()), |(name, _)| {
            let detail = format!("--{name} says nothing about {}: {}\n", self.out, Destination::USES);
            Err(clap::Error::raw(clap::error::ErrorKind::ArgumentConflict, detail))
        })
    }

    /// What to draw, by the reader of the server's query.
    fn query(&self) -> Result<(Product, FrameRequest), Problem> {
        let mut query = Query::new(self.frame.pairs());
        let product = self.out.product(&mut query);
        let request = FrameRequest::read(&mut query);
        query.finish().map_err(|faults| Problem::query(&faults))?;
        Ok((product, request))
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

#[cfg(test)]
mod tests {
    use super::*;

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
    fn flags_of_another_kind_of_file_are_wrong_usage() {
        let usage = |arguments: &[&str]| {
            let arguments = ["render", "a.obj", "-o"].iter().chain(arguments).copied();
            parse(&arguments.collect::<Vec<_>>()).check_usage()
        };
        assert!(usage(&["a.gif", "--frames", "3"]).is_ok());
        assert!(usage(&["a.zip", "--outputs", "depth"]).is_ok());
        let error = usage(&["a.png", "--frames", "3"]).expect_err("a fault").to_string();
        assert!(error.contains("--frames says nothing about a.png"), "{error}");
        assert!(usage(&["a.gif", "--outputs", "depth"]).is_err());
    }
}
