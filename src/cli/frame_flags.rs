//! The frame query as flags.

/// The frame query, each parameter a flag. Values stay text: the query's own reader checks them, so
/// that a flag takes what a URL takes.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct FrameFlags {
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
    #[arg(long, alias = "shadow_resolution", allow_hyphen_values = true, value_name = "TEXELS")]
    shadow_resolution: Option<String>,
    /// Samples of every PCF
    #[arg(long, alias = "pcf_taps", allow_hyphen_values = true, value_name = "TAPS")]
    pcf_taps: Option<String>,
    /// Samples with which PCSS looks for blockers
    #[arg(long, alias = "search_taps", allow_hyphen_values = true, value_name = "TAPS")]
    search_taps: Option<String>,
    /// Samples with which PCSS filters
    #[arg(long, alias = "filter_taps", allow_hyphen_values = true, value_name = "TAPS")]
    filter_taps: Option<String>,
    /// nearest, bilinear or trilinear, in place of every texture's but those that are nearest themselves
    #[arg(long, alias = "texture_filter", allow_hyphen_values = true, value_name = "FILTER")]
    texture_filter: Option<String>,
    /// The picture is drawn with so many times the pixels along each side, and resampled
    #[arg(long, alias = "render_scale", allow_hyphen_values = true, value_name = "TIMES")]
    render_scale: Option<String>,
    /// draft, normal, high or reference, in place of the settings above that are not given
    #[arg(long, allow_hyphen_values = true)]
    preset: Option<String>,
    /// Settings with the least error that take at most so many milliseconds
    #[arg(long, alias = "max_ms", allow_hyphen_values = true, value_name = "MS")]
    max_ms: Option<String>,
    /// The fastest settings with at most this root mean square error
    #[arg(long, alias = "max_error", allow_hyphen_values = true, value_name = "ERROR")]
    max_error: Option<String>,
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
    pub(super) frames: Option<String>,
    /// Of an archive: outputs with commas between [default: all but the stages]
    #[arg(long, allow_hyphen_values = true)]
    pub(super) outputs: Option<String>,
}

impl FrameFlags {
    /// Those that are given, by the names of the query.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        let flags: [(&str, _); 26] = [
            ("width", &self.width),
            ("height", &self.height),
            ("samples", &self.samples),
            ("shadow_resolution", &self.shadow_resolution),
            ("pcf_taps", &self.pcf_taps),
            ("search_taps", &self.search_taps),
            ("filter_taps", &self.filter_taps),
            ("texture_filter", &self.texture_filter),
            ("render_scale", &self.render_scale),
            ("preset", &self.preset),
            ("max_ms", &self.max_ms),
            ("max_error", &self.max_error),
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
