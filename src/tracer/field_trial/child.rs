//! The child process: compiles and tries the requested texts, within limits.

use super::protocol::{self, Answer, Request, RequestedField, TriedField};
use super::{FieldTrial, STACK};
#[cfg(target_os = "linux")]
use super::{LONGEST, MOST_MEMORY};
use crate::error::Error;
use crate::gl::{
    Context, ContextOptions, DataList, GpuError, Program, RenderTarget, Texture,
    full_screen_pass_rows,
};
use crate::scene::UserField;
use crate::shader::DATA_WIDTH;
use crate::tracer::user_fields;
use glam::{Vec3, Vec4};
use std::io::{Read, Write};
use std::process::ExitCode;

/// Maximum bytes of a request. The limit allows many fields of maximum length in many programs.
const LONGEST_REQUEST: u64 = 1 << 26;

/// Size in pixels of the pass that tries a program. A pass is drawn because a driver may complete the compilation only
/// then.
const TRIED: [u32; 2] = [8, 1];

impl FieldTrial {
    /// Answers a request that another process of this program makes through [`FieldTrial::InChild`]. Reads the texts to
    /// try from standard input, tries them on a renderer, and writes the results to standard output. Call this function
    /// at the beginning of a process that does nothing else, because it limits the time and memory of the process.
    pub fn answer(options: &ContextOptions) -> ExitCode {
        limit_process();
        let mut text = String::new();
        let read = std::io::stdin()
            .take(LONGEST_REQUEST)
            .read_to_string(&mut text);
        let Some(request) = read.ok().and_then(|_| ron::from_str::<Request>(&text).ok()) else {
            return ExitCode::FAILURE;
        };
        let options = *options;
        let work = move || {
            let (answer, values) = answer(&options, &request);
            let bytes = protocol::written(&answer, &values).ok()?;
            let mut out = std::io::stdout();
            out.write_all(&bytes).and_then(|()| out.flush()).ok()
        };
        let thread = std::thread::Builder::new().stack_size(STACK).spawn(work);
        match thread.map(|thread| thread.join()) {
            Ok(Ok(Some(()))) => ExitCode::SUCCESS,
            _ => ExitCode::FAILURE,
        }
    }
}

fn answer(options: &ContextOptions, request: &Request) -> (Answer, Vec<f32>) {
    let mut values = Vec::new();
    let answer = match tried(options, request, &mut values) {
        Ok(fields) => Answer::Passed(fields),
        Err(Error::Trace(error)) => Answer::Refused(error),
        Err(error) => Answer::Failed(error.to_string()),
    };
    (answer, values)
}

fn tried(
    options: &ContextOptions,
    request: &Request,
    values: &mut Vec<f32>,
) -> Result<Vec<TriedField>, Error> {
    let context = Context::headless(options)?;
    limit_memory();
    let mut fields = Vec::new();
    for requested in &request.fields {
        let RequestedField {
            file,
            text,
            size,
            lipschitz,
            bend,
            waves,
        } = requested;
        let mut field = UserField::new(file, text.clone(), Vec3::from(*size), *lipschitz);
        field.bend = *bend;
        user_fields::check(&context, &field, *waves)?;
        if let (Some(samples), Some(cost)) = (field.samples(), field.evaluation_seconds()) {
            values.extend(&samples.values);
            fields.push(TriedField {
                evaluation_seconds: cost,
                side: samples.side,
                derivative_agrees: field.derivative_agrees(),
            });
        }
    }
    for program in &request.programs {
        try_program(&context, program)?;
    }
    Ok(fields)
}

/// Compiles a program, and draws it once. A text that does not compile is not an error here: the parent reports it,
/// because its own compiler fails too.
fn try_program(context: &Context, text: &str) -> Result<(), GpuError> {
    let program = match Program::fragment(context, "a trial", text) {
        Ok(program) => program,
        Err(GpuError::Compile { .. } | GpuError::Link { .. }) => return Ok(()),
        Err(error) => return Err(error),
    };
    let [width, height] = TRIED;
    let first = Texture::new(context, width, height)?;
    let second = Texture::new(context, width, height)?;
    let target = RenderTarget::new(context, &[&first, &second])?;
    // The scene's data are a buffer in desktop OpenGL, and samplers of two types may not read from one texture unit. All
    // other samplers read from unit 0.
    let mut data = DataList::new(context, DATA_WIDTH)?;
    data.set(&[Vec4::ZERO])?;
    data.bind(&program, "uSceneData", 1);
    full_screen_pass_rows(context, &program, &target, width, height, 0..height)?;
    // Waits for the drawing, whose result is meaningless because no uniform is set.
    target.read(0).map(drop)
}

#[cfg(target_os = "linux")]
fn limit_process() {
    use rustix::process::{Resource, Signal, set_parent_process_death_signal};
    // The parent limits the time. The limits here apply if the parent has ended.
    let _ = set_parent_process_death_signal(Some(Signal::KILL));
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u64);
    limit(Resource::Cpu, LONGEST.as_secs() * cores);
    limit(Resource::Core, 0);
}

/// Limits the memory that is allocated from now on. Memory that the driver has already reserved does not count, because
/// its amount differs between drivers.
#[cfg(target_os = "linux")]
fn limit_memory() {
    let taken = std::fs::read_to_string("/proc/self/status").ok();
    let kibibytes = taken.and_then(|status| {
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("VmData:"))?;
        line.split_whitespace().next()?.parse::<u64>().ok()
    });
    if let Some(kibibytes) = kibibytes {
        limit(
            rustix::process::Resource::Data,
            (kibibytes << 10) + MOST_MEMORY,
        );
    }
}

/// Sets a limit. If this fails, the system already has a lower limit.
#[cfg(target_os = "linux")]
fn limit(what: rustix::process::Resource, most: u64) {
    let both = rustix::process::Rlimit {
        current: Some(most),
        maximum: Some(most),
    };
    let _ = rustix::process::setrlimit(what, both);
}

#[cfg(not(target_os = "linux"))]
fn limit_process() {}

#[cfg(not(target_os = "linux"))]
fn limit_memory() {}
