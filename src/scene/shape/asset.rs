//! Large objects that the value of a shape depends on: height images and users' fields. Sampled fields and meshes have
//! files of their own.
//!
//! A user's field is GLSL text with a `float field(vec3 p)`, and optionally a `vec3 fieldGradient(vec3 p)`. If the text
//! does not define the gradient, the crate differentiates the text where possible. Only a GPU can evaluate a user's
//! field. Tests on the CPU (whether a source is in a solid, where a walker may go) use samples of the field, which the
//! GPU computes once when the field is checked; see `crate::tracer`.

use super::sampled_field::SampledField;
use super::user_glsl;
use super::user_glsl::derivative::{self, Along};
use crate::file_input::read;
use crate::scene::SceneError;
use crate::scene::mesh::TriangleMesh;
use glam::{DVec2, DVec3, UVec2, Vec3};
use png::{BitDepth, ColorType, DecodingError};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// A large object that a shape's value depends on, in addition to its numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Asset<'a> {
    /// The heights of an image.
    Image(&'a Arc<HeightImage>),
    /// A user's field.
    User(&'a Arc<UserField>),
    /// Distances sampled on a grid.
    Samples(&'a Arc<SampledField>),
    /// The faces of a mesh.
    Mesh(&'a Arc<TriangleMesh>),
}

/// Maximum number of pixels along a side. The heights of an image of this size take 16 MB on the GPU.
const LARGEST_SIDE: u32 = 1024;

/// Maximum size of an image file in bytes. An uncompressed image of the maximum size, with four channels of 16 bits,
/// takes 8 MiB.
const LARGEST_FILE: u64 = 32 << 20;

/// Maximum memory of the decoder in bytes, excluding the decoded image: rows, and colour data in the file.
const DECODER_BYTES: usize = 64 << 20;

/// Weights of red, green and blue in the height of a coloured pixel: the luminances of the sRGB primaries with white
/// point D65 (IEC 61966-2-1). The rounding is that of earlier versions, so that existing files keep their heights.
const LUMA: [f32; 3] = [0.212_647_84, 0.715_179_2, 0.072_173_04];

/// A grid of heights from 0 (black) to 1 (white), upper row first. The image is a view from above, with its upper edge
/// at −z.
#[derive(Clone, Debug)]
pub struct HeightImage {
    size: UVec2,
    heights: Vec<f32>,
    name: String,
    /// The first horizontal size for which the steepest slope was computed, and this slope.
    steepest: OnceLock<(DVec2, f64)>,
}

impl PartialEq for HeightImage {
    fn eq(&self, other: &HeightImage) -> bool {
        self.has_heights_of(other) && self.name == other.name
    }
}

impl HeightImage {
    /// Whether both images have the same heights, regardless of their files.
    pub(crate) fn has_heights_of(&self, other: &HeightImage) -> bool {
        self.size == other.size && self.heights == other.heights
    }

    /// Creates an image from heights in rows; `name` is the name in reports.
    ///
    /// # Errors
    /// [`SceneError::BadHeightImage`] if the grid is smaller than 2 × 2 or larger than 1024 × 1024, or if a height is
    /// outside 0 to 1.
    pub fn new(name: &str, size: UVec2, heights: Vec<f32>) -> Result<HeightImage, SceneError> {
        if size.min_element() < 2 || size.max_element() > LARGEST_SIDE {
            return Err(bad(wrong_size(name, size)));
        }
        if heights.len() != (size.x * size.y) as usize {
            return Err(bad(format!(
                "the height image {name} must have exactly one height per pixel"
            )));
        }
        if !heights.iter().all(|h| (0.0..=1.0).contains(h)) {
            return Err(bad(format!(
                "the height image {name} has heights outside 0 to 1"
            )));
        }
        let name = name.to_owned();
        Ok(HeightImage {
            size,
            heights,
            name,
            steepest: OnceLock::new(),
        })
    }

    /// Reads a PNG file with 8 or 16 bits per channel, grey or coloured. The heights of a coloured image are its luma.
    ///
    /// # Errors
    /// [`SceneError::BadHeightImage`], with the name of the file, if the file cannot be read, is larger than 32 MiB, or
    /// has more than 1024 pixels along a side. The side is checked before decoding.
    pub fn from_file(path: &Path) -> Result<HeightImage, SceneError> {
        let shown = path.display().to_string();
        let refused = |why: String| bad(format!("cannot read the height image {shown}: {why}"));
        let bytes = read(path, LARGEST_FILE).map_err(|error| refused(error.to_string()))?;
        let (size, lumas) = luma(&bytes).map_err(|error| match error {
            PngError::Side(size) => bad(wrong_size(&shown, size)),
            PngError::Refused(why) => refused(why),
        })?;
        let heights = lumas.into_iter().map(|luma| f32::from(luma) / 65535.0);
        HeightImage::new(&shown, size, heights.collect())
    }

    /// Name in reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Pixels along x and z.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Width, height and all heights, each as four bytes in little-endian order.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let size = self.size.to_array().into_iter().flat_map(u32::to_le_bytes);
        let heights = self.heights.iter().flat_map(|height| height.to_le_bytes());
        size.chain(heights).collect()
    }

    /// The heights in rows, the upper row first.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    fn height(&self, x: u32, z: u32) -> f64 {
        f64::from(self.heights[(z * self.size.x + x) as usize])
    }

    /// The grid cell that contains a point, and the point's position in that cell. `at` is 0 to 1 along x and z.
    fn cell(&self, at: DVec2) -> (UVec2, DVec2) {
        let cells = (self.size - 1).as_dvec2();
        let place = (at * cells).clamp(DVec2::ZERO, cells);
        let cell = place.floor().min(cells - 1.0);
        (cell.as_uvec2(), place - cell)
    }

    /// Bilinearly interpolated height, 0 to 1. `at` is 0 to 1 along x and z, clamped at the edges.
    pub fn at(&self, at: DVec2) -> f64 {
        let (cell, within) = self.cell(at);
        let row = |z: u32| {
            let left = self.height(cell.x, z);
            left + (self.height(cell.x + 1, z) - left) * within.x
        };
        let near = row(cell.y);
        near + (row(cell.y + 1) - near) * within.y
    }

    /// The steepest slope for a terrain of the horizontal size `size` (x, z): change of the height (0 to 1) per unit of
    /// `size`.
    ///
    /// The first call visits the whole image. The result for the same size is cached.
    pub fn steepest(&self, size: DVec2) -> f64 {
        let (known_size, known) = self
            .steepest
            .get_or_init(|| (size, self.walk_for_steepest(size)));
        if *known_size == size {
            return *known;
        }
        self.walk_for_steepest(size)
    }

    fn walk_for_steepest(&self, size: DVec2) -> f64 {
        let step = size / (self.size - 1).as_dvec2();
        let mut steepest: f64 = 0.0;
        for z in 0..self.size.y - 1 {
            for x in 0..self.size.x - 1 {
                // The gradient of a bilinear patch is greatest at one of its corners.
                let corner = |dx: u32, dz: u32| self.height(x + dx, z + dz);
                let along_x = [0, 1].map(|dz| (corner(1, dz) - corner(0, dz)) / step.x);
                let along_z = [0, 1].map(|dx| (corner(dx, 1) - corner(dx, 0)) / step.y);
                for slope_x in along_x {
                    for slope_z in along_z {
                        steepest = steepest.max(slope_x.hypot(slope_z));
                    }
                }
            }
        }
        steepest
    }
}

fn bad(why: String) -> SceneError {
    SceneError::BadHeightImage { why }
}

fn wrong_size(name: &str, size: UVec2) -> String {
    format!(
        "the height image {name} has {} x {} pixels: it must have 2 to {LARGEST_SIDE} along each side",
        size.x, size.y
    )
}

/// The reason why a PNG file is rejected.
enum PngError {
    /// The size in pixels is out of range.
    Side(UVec2),
    /// Any other reason, as a message.
    Refused(String),
}

impl From<DecodingError> for PngError {
    fn from(error: DecodingError) -> PngError {
        PngError::Refused(error.to_string())
    }
}

/// The size of the image, and the luma of its pixels from 0 to 65535. The size is checked before decoding.
fn luma(bytes: &[u8]) -> Result<(UVec2, Vec<u16>), PngError> {
    let limits = png::Limits {
        bytes: DECODER_BYTES,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(png::Transformations::EXPAND);
    let head = decoder.read_header_info()?;
    let size = UVec2::new(head.width, head.height);
    if size.max_element() > LARGEST_SIDE {
        return Err(PngError::Side(size));
    }
    let mut reader = decoder.read_info()?;
    check_palette(reader.info())?;
    let length = reader.output_buffer_size();
    let mut pixels = vec![0; length.ok_or(DecodingError::LimitsExceeded)?];
    let found = reader.next_frame(&mut pixels)?;
    pixels.truncate(found.buffer_size());
    if UVec2::new(found.width, found.height) != size {
        let why = "its first frame does not cover the whole image".to_owned();
        return Err(PngError::Refused(why));
    }
    let (colour, depth) = (found.color_type, found.bit_depth);
    let lumas = lumas(colour, depth, &pixels)
        .ok_or_else(|| PngError::Refused(format!("it has {:?} pixels", (colour, depth))))?;
    Ok((size, lumas))
}

/// Checks the palette, because the decoder panics if the last colour is incomplete.
fn check_palette(info: &png::Info) -> Result<(), PngError> {
    /// Bytes per colour: red, green and blue. A palette has at most 256 colours.
    const COLOUR: usize = 3;
    const MOST: usize = 256 * COLOUR;
    let length = info.palette.as_ref().map_or(0, |palette| palette.len());
    if length.is_multiple_of(COLOUR) && length <= MOST {
        return Ok(());
    }
    Err(PngError::Refused(format!(
        "its palette has {length} bytes: it must be 1 to 256 colours of {COLOUR} bytes"
    )))
}

/// The luma of pixels in the decoder's output, which is big-endian with at least 8 bits; `None` for unsupported types.
fn lumas(colour: ColorType, depth: BitDepth, bytes: &[u8]) -> Option<Vec<u16>> {
    let (levels, most): (Vec<u16>, u16) = match depth {
        BitDepth::Eight => (bytes.iter().copied().map(u16::from).collect(), 255),
        BitDepth::Sixteen => {
            let (pairs, _) = bytes.as_chunks();
            (
                pairs.iter().copied().map(u16::from_be_bytes).collect(),
                65535,
            )
        }
        _ => return None,
    };
    let channels = colour.samples();
    let pixels = levels.chunks_exact(channels);
    Some(match colour {
        ColorType::Grayscale | ColorType::GrayscaleAlpha => {
            pixels.map(|pixel| pixel[0] * (65535 / most)).collect()
        }
        ColorType::Rgb | ColorType::Rgba => {
            let unit = 1.0 / f32::from(most);
            let luma = |pixel: &[u16]| -> f32 {
                let parts = pixel.iter().zip(LUMA);
                parts
                    .map(|(level, share)| f32::from(*level) * unit * share)
                    .sum()
            };
            pixels
                .map(|pixel| (luma(pixel) * 65535.0).round() as u16)
                .collect()
        }
        ColorType::Indexed => return None,
    })
}

/// A user's field with its stated properties.
#[derive(Debug)]
pub struct UserField {
    /// The file that contains the text, or another name for reports.
    pub file: PathBuf,
    /// GLSL text with a `float field(vec3 p)`. Helper functions, constants and macros are allowed. A function `vec3
    /// fieldGradient(vec3 p)` defines the gradient, in units of the value per metre.
    pub text: String,
    /// Full size in metres of the field's box, which is centred on the origin. The field ends at the box, and is never
    /// evaluated outside it.
    pub size: Vec3,
    /// Lipschitz constant of the value, in metres per metre.
    pub lipschitz: f32,
    /// Upper bound, per metre, of −f″ along any straight line, where f is the value; 0 for a function that is convex
    /// along every line. The bound must hold wherever waves can be: in all air within the box, and in the solid near
    /// the surface. `None` if no bound is stated.
    pub bend: Option<f32>,
    samples: OnceLock<Arc<UserSamples>>,
    passed_on_both_sides: OnceLock<()>,
    read: OnceLock<Read>,
    evaluation_seconds: OnceLock<f64>,
    cpu: Option<Cpu>,
    /// Result of the renderer's test whether the derivative of the text agrees with its values.
    derivative_agrees: OnceLock<bool>,
}

/// The value of a field at a point in metres.
pub(crate) type CpuValue = dyn Fn(DVec3) -> f64 + Send + Sync;

/// A caller's own function.
#[derive(Clone)]
struct Cpu(Arc<CpuValue>);

impl fmt::Debug for Cpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("function")
    }
}

impl PartialEq for Cpu {
    fn eq(&self, other: &Cpu) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// The part of a user's field that waves can reach. The renderer checks the field there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) enum WaveDomain {
    /// The air, where the value is positive, and the solid near the surface.
    Air,
    /// The whole box. An operator above the field exchanges air and solid, or moves the surface inwards.
    BothSides,
}

/// Properties of the text that every frame needs. They are cached, so that the text is parsed only once.
#[derive(Clone, Copy, Debug, Default)]
struct Read {
    has_loops: bool,
    loop_turns: Option<u64>,
    states_gradient: bool,
    has_derivative: bool,
}

/// The values of a field on a grid that covers its box, including the faces.
#[derive(Clone, Debug, PartialEq)]
pub struct UserSamples {
    /// Number of samples along each side.
    pub side: usize,
    /// The values: x varies fastest, then y, then z.
    pub values: Vec<f32>,
}

impl UserField {
    /// Creates a field from text; `file` is the name in reports.
    pub fn new(file: impl Into<PathBuf>, text: String, size: Vec3, lipschitz: f32) -> UserField {
        UserField {
            file: file.into(),
            text,
            size,
            lipschitz,
            bend: None,
            samples: OnceLock::new(),
            passed_on_both_sides: OnceLock::new(),
            read: OnceLock::new(),
            evaluation_seconds: OnceLock::new(),
            cpu: None,
            derivative_agrees: OnceLock::new(),
        }
    }

    /// Returns the field with its value on the CPU, a function in `f64` of a point in metres in the field's own axes. Exact
    /// paths and distances then use the function instead of interpolated samples of the text, whose error is larger. It
    /// is called within the box only, from several threads, and must not panic.
    ///
    /// The tracer compares it with the text before the field is used, and fails with
    /// [`TraceError::FieldDiffers`](crate::tracer::TraceError::FieldDiffers) if they differ.
    ///
    /// ```
    /// use echomarch::glam::Vec3;
    /// use echomarch::scene::UserField;
    ///
    /// let text = "float field(vec3 p) { return length(p) - 1.0; }".to_owned();
    /// let field = UserField::new("ball.glsl", text, Vec3::splat(3.0), 1.0).with_cpu(|p| p.length() - 1.0);
    /// assert_eq!(field.value([0.5, 0.0, 0.0].into()), -0.5);
    /// ```
    #[must_use]
    pub fn with_cpu(mut self, value: impl Fn(DVec3) -> f64 + Send + Sync + 'static) -> UserField {
        self.cpu = Some(Cpu(Arc::new(value)));
        self
    }

    /// The function on the CPU, if there is one.
    pub(crate) fn cpu(&self) -> Option<&CpuValue> {
        self.cpu.as_ref().map(|cpu| &*cpu.0)
    }

    /// Whether [`UserField::value`] evaluates the caller's own function.
    pub fn has_cpu(&self) -> bool {
        self.cpu.is_some()
    }

    /// Returns the field with a stated [`UserField::bend`], per metre.
    #[must_use]
    pub fn with_bend(mut self, bend: f32) -> UserField {
        self.bend = Some(bend);
        self
    }

    /// Whether the field has passed the renderer's checks in this domain.
    pub(crate) fn has_passed(&self, waves: WaveDomain) -> bool {
        let is_on_both_sides = self.passed_on_both_sides.get().is_some();
        self.samples.get().is_some() && (is_on_both_sides || waves == WaveDomain::Air)
    }

    /// Stores the results of checks that the field has passed. Later calls can only extend the domain.
    pub(crate) fn set_passed(&self, waves: WaveDomain, samples: Arc<UserSamples>, seconds: f64) {
        self.set_samples(samples);
        self.set_evaluation_seconds(seconds);
        if waves == WaveDomain::BothSides {
            self.passed_on_both_sides.get_or_init(|| ());
        }
    }

    /// Stores the samples from the GPU. Later calls have no effect.
    pub(crate) fn set_samples(&self, samples: Arc<UserSamples>) {
        // The same text over the same box gives the same samples.
        let _ = self.samples.set(samples);
    }

    /// The samples from the GPU, if they have been computed.
    pub(crate) fn samples(&self) -> Option<&Arc<UserSamples>> {
        self.samples.get()
    }

    /// Stores the time of one evaluation in seconds. Later calls have no effect.
    pub(crate) fn set_evaluation_seconds(&self, seconds: f64) {
        // Measurements of the same text differ only by the effect of other load.
        let _ = self.evaluation_seconds.set(seconds);
    }

    /// Time in seconds per evaluation on the renderer with many parallel evaluations, if measured.
    pub(crate) fn evaluation_seconds(&self) -> Option<f64> {
        self.evaluation_seconds.get().copied()
    }

    /// Whether the text is built into the program.
    pub(crate) fn is_own(&self) -> bool {
        crate::scene::is_own_text(&self.text)
    }

    /// The value by the function on the CPU, or else by cubic interpolation of the samples, at the point clamped to the
    /// box. Before the renderer has computed samples, no surface is known: the value is that of air as far from a surface
    /// as the box is long.
    pub fn value(&self, point: DVec3) -> f64 {
        if let Some(cpu) = self.cpu() {
            let half = 0.5 * self.size.as_dvec3();
            return cpu(point.clamp(-half, half));
        }
        let Some(samples) = self.samples.get() else {
            return f64::from(self.lipschitz * self.size.max_element());
        };
        let share = point / self.size.as_dvec3() + 0.5;
        samples.at(share)
    }

    /// The text for use within a shader: in ASCII, with macros expanded, without directives and `precision` statements,
    /// and with unchanged line numbers. Empty for a text that [`UserField::check_text`] rejects.
    pub fn shader_text(&self) -> String {
        user_glsl::read(&self.text).map_or_else(|_| String::new(), |text| text.code)
    }

    /// Performs all checks of the text that need no compiler.
    ///
    /// # Errors
    /// A message, and the line if the error has one. The text lacks a `float field(vec3 p)`, needs an external input,
    /// contains something that is not allowed in a function of one point, or exceeds the limits that protect compilers.
    pub fn check_text(&self) -> Result<(), (Option<u32>, String)> {
        user_glsl::read(&self.text).map(|_| ())
    }

    /// Whether the text contains loops; false if it cannot be parsed.
    pub fn has_loops(&self) -> bool {
        self.read().has_loops
    }

    /// The most turns that all loops in one evaluation take together; `None` if a loop of the text does not count to a
    /// constant end, or if the text cannot be parsed.
    pub(crate) fn loop_turns(&self) -> Option<u64> {
        self.read().loop_turns
    }

    /// Whether the text defines its gradient by `vec3 fieldGradient(vec3 p)`.
    pub fn states_gradient(&self) -> bool {
        self.read().states_gradient
    }

    /// Whether gradients are computed from a derivative of the text: the text defines no gradient, it can be
    /// differentiated, and the renderer has found no differences between the derivative and the values.
    pub(crate) fn is_differentiated(&self) -> bool {
        self.read().has_derivative && self.derivative_agrees() != Some(false)
    }

    /// Whether the derivative of the text agrees with its values; `None` if this has not been tested.
    pub(crate) fn derivative_agrees(&self) -> Option<bool> {
        self.derivative_agrees.get().copied()
    }

    /// Stores the result of the test of the derivative. Later calls have no effect.
    pub(crate) fn set_derivative_agrees(&self, agrees: bool) {
        // The same text over the same box gives the same result.
        let _ = self.derivative_agrees.set(agrees);
    }

    /// Text that follows the field's own text in a shader, in which `field` is renamed to `user<index>_field`. It
    /// defines `float dual<index>_field(vec3 p, out vec3 gradient)`, which returns the value. Empty for a text that
    /// cannot be differentiated.
    pub(crate) fn gradient_text(&self, index: usize) -> String {
        self.derivative(Along::Axes, index)
    }

    /// The derivative along one direction: `float slope<index>_field(vec3 p, vec3 direction, out float slope)`. Empty
    /// for a text that cannot be differentiated.
    pub(crate) fn slope_text(&self, index: usize) -> String {
        self.derivative(Along::Line, index)
    }

    fn derivative(&self, along: Along, index: usize) -> String {
        derivative::written(&self.shader_text(), along, index).unwrap_or_default()
    }

    fn read(&self) -> Read {
        let is_derived = |text: &user_glsl::Text| {
            !text.states_gradient && derivative::written(&text.code, Along::Axes, 0).is_ok()
        };
        let read = |text: user_glsl::Text| Read {
            has_loops: text.has_loops,
            loop_turns: derivative::loop_turns(&text.code),
            has_derivative: is_derived(&text),
            states_gradient: text.states_gradient,
        };
        *self
            .read
            .get_or_init(|| user_glsl::read(&self.text).map(read).unwrap_or_default())
    }

    /// All names in the text that GLSL does not define. They are renamed when the text becomes part of a shader, so
    /// that fields do not clash with each other or with the rest of the shader. Empty for a text that
    /// [`UserField::check_text`] rejects.
    pub fn names(&self) -> Vec<String> {
        user_glsl::read(&self.text).map_or_else(|_| Vec::new(), |text| text.names)
    }

    /// Whether both fields have the same text and properties, regardless of their files.
    pub(crate) fn has_text_of(&self, other: &UserField) -> bool {
        self.text == other.text
            && self.size == other.size
            && self.lipschitz == other.lipschitz
            && self.bend == other.bend
    }
}

impl PartialEq for UserField {
    fn eq(&self, other: &UserField) -> bool {
        self.has_text_of(other) && self.file == other.file && self.cpu == other.cpu
    }
}

impl UserSamples {
    /// The places of the samples, 0 to 1 along each side of the box.
    pub(crate) fn places(&self) -> impl Iterator<Item = DVec3> + use<> {
        let side = self.side;
        let last = side.saturating_sub(1).max(1) as f64;
        (0..side.pow(3)).map(move |index| {
            let along = [index % side, index / side % side, index / (side * side)];
            DVec3::from(along.map(|along| along as f64)) / last
        })
    }

    /// The value by cubic interpolation along each axis (Catmull and Rom 1974), which preserves curvature. `share` is 0 to 1
    /// along each side, clamped at the edges. Beyond the faces the samples continue as straight lines.
    fn at(&self, share: DVec3) -> f64 {
        let last = (self.side - 1) as f64;
        let place = (share * last).clamp(DVec3::ZERO, DVec3::splat(last));
        let cell = place.floor().min(DVec3::splat(last - 1.0));
        let within = place - cell;
        let [x, y, z] = [0, 1, 2].map(|axis| self.taps(cell[axis] as usize, within[axis]));
        let mut value = 0.0;
        for (layer, of_z) in z {
            for (row, of_y) in y {
                let start = (layer * self.side + row) * self.side;
                let along = x.map(|(column, of_x)| of_x * f64::from(self.values[start + column]));
                value += of_z * of_y * along.iter().sum::<f64>();
            }
        }
        value
    }

    /// The indices of the samples about a cell, and their weights.
    fn taps(&self, cell: usize, t: f64) -> [(usize, f64); 4] {
        let last = self.side - 1;
        let mut weights = [
            0.5 * t * (t * (2.0 - t) - 1.0),
            0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
            0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
            0.5 * t * t * (t - 1.0),
        ];
        if cell == 0 {
            let [beyond, first, second, _] = &mut weights;
            *first += 2.0 * *beyond;
            *second -= *beyond;
            *beyond = 0.0;
        }
        if cell + 2 > last {
            let [_, before, end, beyond] = &mut weights;
            *end += 2.0 * *beyond;
            *before -= *beyond;
            *beyond = 0.0;
        }
        let indices = [cell.saturating_sub(1), cell, cell + 1, (cell + 2).min(last)];
        std::array::from_fn(|tap| (indices[tap], weights[tap]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the CPU's values of a field: none before there are samples, then interpolated samples, or those of the caller's own function.
    #[test]
    fn samples_are_interpolated() {
        let size = Vec3::new(2.0, 4.0, 8.0);
        let field = UserField::new("x", String::new(), size, 1.0);
        assert_eq!(field.value(DVec3::ZERO), 8.0);
        let values = (0..8).map(|i| [0.0, 1.0][i & 1]).collect();
        field.set_samples(Arc::new(UserSamples { side: 2, values }));
        assert_eq!(field.value(DVec3::ZERO), 0.5);
        assert_eq!(field.value(DVec3::X * 5.0), 1.0);
        assert_eq!(field.value(DVec3::new(-0.5, 2.0, 1.0)), 0.25);
        let exact = field.with_cpu(|p| p.x + 10.0);
        assert_eq!(exact.value(DVec3::new(0.25, 9.0, 0.0)), 10.25);
        assert_eq!(exact.value(DVec3::X * 5.0), 11.0, "clamped to the box");
        let values = (0..27).map(|i| [0.0, 1.0, 4.0][i % 3]).collect();
        let finer = UserField::new("x", String::new(), size, 1.0);
        finer.set_samples(Arc::new(UserSamples { side: 3, values }));
        assert_eq!(finer.value(DVec3::ZERO), 1.0);
        let off = finer.value(DVec3::new(0.5, 0.3, -2.0)) - 2.375;
        assert!(off.abs() < 1e-12, "{off}");
    }

    /// Protects the heights of existing files of every colour type: they equal those of earlier versions, with the same
    /// weights of red, green and blue, and regardless of opacity.
    #[test]
    fn heights_are_the_luma_of_every_colour_type() {
        use BitDepth::{Eight, Four, Sixteen};
        use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
        let cases: [(ColorType, BitDepth, &[u8], &[u16]); 6] = [
            (Grayscale, Eight, &[0, 77, 255], &[0, 77 * 257, 65535]),
            (GrayscaleAlpha, Sixteen, &[1, 2, 9, 9], &[0x0102]),
            (
                Rgb,
                Eight,
                &[10, 200, 77, 0, 0, 255, 255, 255, 255],
                &[38735, 4730, 65535],
            ),
            (Rgba, Eight, &[10, 200, 77, 9], &[38735]),
            (Rgb, Sixteen, &[3, 232, 78, 32, 183, 152], &[17908]),
            (Rgb, Sixteen, &[255; 6], &[65535]),
        ];
        for (colour, depth, bytes, expected) in cases {
            let read = lumas(colour, depth, bytes);
            assert_eq!(read.as_deref(), Some(expected), "{colour:?} {depth:?}");
        }
        assert!(lumas(Indexed, Eight, &[0]).is_none());
        assert!(lumas(Grayscale, Four, &[0]).is_none());
    }
}
