//! A timer for GL commands.

use glow::HasContext;

use super::{Api, Context, GpuError};
use crate::platform::{self, Instant};

/// Marks in the stream of GL commands, and the times between them.
///
/// On a graphics card a mark is a timestamp query, whose result is fetched later, so setting a mark does not wait.
/// Software renderers return wrong results for queries (llvmpipe's times are far too short), and OpenGL ES may lack
/// queries. In these cases each mark calls `glFinish`, which waits, and reads the wall clock. In a browser, where
/// `glFinish` does not wait, the times are those of the calls.
#[derive(Debug)]
pub struct GpuTimer {
    context: Context,
    by_query: bool,
    queries: Vec<glow::Query>,
    used: usize,
    instants: Vec<Instant>,
}

impl GpuTimer {
    /// Creates a timer of the kind suited to the context.
    pub fn new(context: &Context) -> GpuTimer {
        let by_query = context.api() == Api::Gl && !context.is_software();
        GpuTimer::of_kind(context, by_query)
    }

    /// Creates a timer with timestamp queries, or with the wall clock.
    pub(crate) fn of_kind(context: &Context, by_query: bool) -> GpuTimer {
        GpuTimer {
            context: context.clone(),
            by_query,
            queries: Vec::new(),
            used: 0,
            instants: Vec::new(),
        }
    }

    /// The name of the time source.
    pub fn name(&self) -> &'static str {
        match (self.by_query, platform::CAN_WAIT_FOR_GL) {
            (true, _) => "GL timer query",
            (false, true) => "wall clock around glFinish",
            (false, false) => "wall clock around calls, which do not wait for the drawing",
        }
    }

    /// Whether each mark waits for GL, so that its time is known at once.
    pub fn waits(&self) -> bool {
        !self.by_query
    }

    /// Discards all marks, and sets the first.
    ///
    /// # Errors
    /// GL errors.
    pub fn restart(&mut self) -> Result<(), GpuError> {
        self.used = 0;
        self.instants.clear();
        self.mark()
    }

    /// Sets the next mark.
    ///
    /// # Errors
    /// GL errors.
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
            self.queries
                .push(query.map_err(GpuError::not_created("a timestamp query"))?);
        }
        let query = self.queries[self.used];
        // SAFETY: the context is current and owns the query.
        unsafe { self.context.gl().query_counter(query, glow::TIMESTAMP) };
        self.used += 1;
        Ok(())
    }

    /// Milliseconds from each mark to the next. On a graphics card this waits for the last mark: call it after passing
    /// a fence set after that mark.
    pub fn milliseconds(&self) -> Vec<f64> {
        if !self.by_query {
            let between = |pair: &[Instant]| (pair[1] - pair[0]).as_secs_f64() * 1e3;
            return self.instants.windows(2).map(between).collect();
        }
        let gl = self.context.gl();
        let stamps: Vec<u64> = self.queries[..self.used]
            .iter()
            // SAFETY: the context is current; the queries belong to it and have begun.
            .map(|query| unsafe { gl.get_query_parameter_u64(*query, glow::QUERY_RESULT) })
            .collect();
        let between = |pair: &[u64]| pair[1].saturating_sub(pair[0]) as f64 * 1e-6;
        stamps.windows(2).map(between).collect()
    }
}

impl Drop for GpuTimer {
    fn drop(&mut self) {
        self.context.free(|gl| {
            for query in &self.queries {
                // SAFETY: the context is current and owns the query, which is not used again.
                unsafe { gl.delete_query(*query) };
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::ContextOptions;
    use super::*;

    /// Protects the timestamp queries of graphics cards: each pair of marks has a time, and GL reports no error.
    /// Software renderers also answer such queries, but with times that are too short, so the timer uses the wall clock
    /// there.
    #[test]
    fn timestamp_queries_answer_without_gl_errors() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut timer = GpuTimer::of_kind(&context, true);
        for marks in [1, 3, 2] {
            timer.restart().unwrap();
            for _ in 0..marks {
                timer.mark().unwrap();
            }
            assert_eq!(timer.milliseconds().len(), marks);
            context.check("timestamp queries").unwrap();
        }
        assert_eq!(timer.name(), "GL timer query");
        assert!(!timer.waits());
    }
}
