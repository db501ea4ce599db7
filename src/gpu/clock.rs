//! How long a pass takes.

use std::time::{Duration, Instant};

use glow::HasContext;

use super::{Api, Context, GpuError};

/// Measures how long GL works on something.
///
/// A graphics card is measured by GL's timer query: the time on the card alone. Software renderers answer it wrongly
/// (llvmpipe far too short), and OpenGL ES may lack it; there it is the wall clock, with glFinish before and
/// after.
#[derive(Debug)]
pub struct Clock {
    context: Context,
    query: Option<glow::Query>,
}

impl Clock {
    /// The clock that is right for the context.
    ///
    /// # Errors
    /// What GL reports.
    pub fn for_context(context: &Context) -> Result<Clock, GpuError> {
        if context.api() == Api::Gl && !context.is_software() {
            Clock::query(context)
        } else {
            Ok(Clock::wall(context))
        }
    }

    fn query(context: &Context) -> Result<Clock, GpuError> {
        let failed = |code: String| GpuError::Gl {
            what: "a timer query".into(),
            code,
        };
        // SAFETY: the context is current.
        let query = unsafe { context.gl().create_query() }.map_err(failed)?;
        Ok(Clock {
            context: context.clone(),
            query: Some(query),
        })
    }

    /// The wall clock around glFinish, on every context.
    pub fn wall(context: &Context) -> Clock {
        Clock {
            context: context.clone(),
            query: None,
        }
    }

    /// What the figures come from.
    pub fn name(&self) -> &'static str {
        match self.query {
            Some(_) => "GL timer query",
            None => "wall clock around glFinish",
        }
    }

    /// Runs `work`, waits until GL has done it, and says how long that took. Only work for this clock's context
    /// counts; measurements must not be nested.
    ///
    /// # Errors
    /// What GL reports. `work` may itself return a result, which is passed on.
    pub fn measure<T>(&self, work: impl FnOnce() -> T) -> Result<(T, Duration), GpuError> {
        match self.query {
            Some(query) => self.measure_by_query(query, work),
            None => self.measure_by_wall(work),
        }
    }

    fn measure_by_wall<T>(&self, work: impl FnOnce() -> T) -> Result<(T, Duration), GpuError> {
        // SAFETY: the context is made current.
        let finish = || unsafe { self.context.gl().finish() };
        finish();
        let start = Instant::now();
        let result = work();
        finish();
        let took = start.elapsed();
        self.context.check("a measurement")?;
        Ok((result, took))
    }

    fn measure_by_query<T>(
        &self,
        query: glow::Query,
        work: impl FnOnce() -> T,
    ) -> Result<(T, Duration), GpuError> {
        // SAFETY: the context is current, and the query its own.
        unsafe { self.context.gl().begin_query(glow::TIME_ELAPSED, query) };
        let result = work();
        // SAFETY: as above, whatever the work made current.
        let nanoseconds = unsafe {
            let gl = self.context.gl();
            gl.end_query(glow::TIME_ELAPSED);
            gl.get_query_parameter_u64(query, glow::QUERY_RESULT)
        };
        self.context.check("a measurement")?;
        Ok((result, Duration::from_nanos(nanoseconds)))
    }
}

impl Drop for Clock {
    fn drop(&mut self) {
        let _entered = self.context.enter();
        if let Some(query) = self.query {
            // SAFETY: the context is current, and the query its own and not used again.
            unsafe { self.context.gl().delete_query(query) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::ContextOptions;
    use super::*;

    /// The timer query is used rightly, though software renderers, for which it is not chosen, answer too little.
    #[test]
    fn timer_queries_answer_without_gl_errors() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let clock = Clock::query(&context).unwrap();
        for round in 0..3 {
            let (result, _) = clock.measure(|| round).unwrap();
            assert_eq!(result, round);
        }
        assert_eq!(clock.name(), "GL timer query");
    }
}
