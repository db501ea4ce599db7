//! When GL reached which point of its work, asked without waiting.

use std::time::Instant;

use glow::HasContext;

use super::{Api, Context, GpuError};

/// Points in the stream of GL's work, and the times between them.
///
/// On a graphics card a mark is a timestamp query, whose answer is fetched later; nothing waits. Software renderers
/// answer queries wrongly, and OpenGL ES may lack them: there each mark is `glFinish` and the wall clock, and waits.
#[derive(Debug)]
pub struct Marks {
    context: Context,
    by_query: bool,
    queries: Vec<glow::Query>,
    used: usize,
    instants: Vec<Instant>,
}

impl Marks {
    /// Marks of the kind that is right for the context.
    pub fn new(context: &Context) -> Marks {
        Marks {
            context: context.clone(),
            by_query: context.api() == Api::Gl && !context.is_software(),
            queries: Vec::new(),
            used: 0,
            instants: Vec::new(),
        }
    }

    /// Whether each mark waits for GL, so that its time is known at once.
    pub fn wait(&self) -> bool {
        !self.by_query
    }

    /// Forgets all marks, and sets the first.
    ///
    /// # Errors
    /// What GL reports.
    pub fn restart(&mut self) -> Result<(), GpuError> {
        self.used = 0;
        self.instants.clear();
        self.mark()
    }

    /// Sets the next mark.
    ///
    /// # Errors
    /// What GL reports.
    pub fn mark(&mut self) -> Result<(), GpuError> {
        if !self.by_query {
            // SAFETY: the context is current.
            unsafe { self.context.gl().finish() };
            self.instants.push(Instant::now());
            return Ok(());
        }
        if self.used == self.queries.len() {
            // SAFETY: the context is current.
            let query = unsafe { self.context.gl().create_query() };
            self.queries.push(query.map_err(|code| GpuError::Gl {
                what: "a timestamp query".into(),
                code,
            })?);
        }
        let query = self.queries[self.used];
        // SAFETY: the context is current, and the query its own.
        unsafe { self.context.gl().query_counter(query, glow::TIMESTAMP) };
        self.used += 1;
        Ok(())
    }

    /// Milliseconds from each mark to the next. On a graphics card this waits for the last mark: ask when a fence
    /// behind it has been passed.
    pub fn milliseconds(&self) -> Vec<f64> {
        if !self.by_query {
            let between = |pair: &[Instant]| (pair[1] - pair[0]).as_secs_f64() * 1e3;
            return self.instants.windows(2).map(between).collect();
        }
        let gl = self.context.gl();
        let stamps: Vec<u64> = self.queries[..self.used]
            .iter()
            // SAFETY: the context is current, and the queries its own and begun.
            .map(|query| unsafe { gl.get_query_parameter_u64(*query, glow::QUERY_RESULT) })
            .collect();
        let between = |pair: &[u64]| pair[1].saturating_sub(pair[0]) as f64 * 1e-6;
        stamps.windows(2).map(between).collect()
    }
}

impl Drop for Marks {
    fn drop(&mut self) {
        let _entered = self.context.enter();
        for query in &self.queries {
            // SAFETY: the context is current, and the query its own and not used again.
            unsafe { self.context.gl().delete_query(*query) };
        }
    }
}
