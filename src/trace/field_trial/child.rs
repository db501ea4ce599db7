//! The child's side: compiles and tries what the parent requests, within limits.

use super::STACK;
use super::protocol::{self, Answer, Request, RequestedField, TriedField};
#[cfg(target_os = "linux")]
use super::{LONGEST, MOST_MEMORY};
use crate::error::Error;
use crate::gpu::{
    Context, ContextOptions, GpuError, Program, RenderTarget, Texture, full_screen_pass_rows,
};
use crate::scene::UserField;
use crate::trace::user_fields;
use glam::Vec3;
use std::io::{Read, Write};
use std::process::ExitCode;

/// Bytes of a request at most: many fields, each as long as may be, in many programs.
const LONGEST_REQUEST: u64 = 1 << 26;

/// Pixels of the pass by which a program is tried: a driver compiles the rest of it then.
const TRIED: [u32; 2] = [8, 1];

/// Answers a request of another process of this program by [`FieldTrial`](super::FieldTrial): reads from standard
/// input which texts to try, tries them on a renderer, and writes to standard output what came
/// of it. To be called at the beginning of a process that does nothing else: it limits the
/// time and memory that this process may take.
pub fn answer_field_trial(options: &ContextOptions) -> ExitCode {
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
        } = requested;
        let field = UserField::new(file, text.clone(), Vec3::from(*size), *lipschitz);
        user_fields::check(&context, &field)?;
        if let (Some(samples), Some(cost)) = (field.samples(), field.evaluation_seconds()) {
            values.extend(&samples.values);
            fields.push(TriedField {
                evaluation_seconds: cost,
                side: samples.side,
            });
        }
    }
    for program in &request.programs {
        try_program(&context, program)?;
    }
    Ok(fields)
}

/// Compiles a program, and draws it once. What does not compile is reported by the parent: its
/// own compiler gets no further.
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
    full_screen_pass_rows(context, &program, &target, width, height, 0..height)?;
    // Waits for it. What it has drawn means nothing: no uniform is set.
    target.read(0).map(drop)
}

#[cfg(target_os = "linux")]
fn limit_process() {
    use rustix::process::{Resource, Signal, set_parent_process_death_signal};
    // The parent keeps the time; these are for a parent that has ended.
    let _ = set_parent_process_death_signal(Some(Signal::KILL));
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u64);
    limit(Resource::Cpu, LONGEST.as_secs() * cores);
    limit(Resource::Core, 0);
}

/// Limits what is taken from now on: a driver has reserved its own already, and how much
/// differs from one to the next.
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

/// A limit that cannot be set is one that the system already has.
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
