//! Asynchronous read-back of texels.

use std::ops::{ControlFlow, Range};

use glow::{HasContext, PixelPackData};

use super::texture::{as_floats, of_floats_mut};
use super::{Context, GpuError, RenderTarget};
use crate::platform;

/// Longest wait in one call, in nanoseconds. After each wait the reader checks whether the driver has lost the context.
const WAIT_NANOSECONDS: i32 = 100_000_000;

/// A reader of texels: a GL buffer receives the texels, and a fence signals when the copy is complete. The reader holds
/// at most one pending read, and reuses the buffer.
///
/// Dropping the reader frees the buffer and cancels a pending read.
#[derive(Debug)]
pub struct AsyncRead {
    context: Context,
    buffer: glow::Buffer,
    capacity: usize,
    pending: Option<Pending>,
}

/// A pending read.
#[derive(Debug)]
struct Pending {
    fence: glow::Fence,
    floats: usize,
}

impl AsyncRead {
    /// A reader without a pending read.
    ///
    /// # Errors
    /// GL errors.
    pub fn new(context: &Context) -> Result<AsyncRead, GpuError> {
        // SAFETY: the context is current.
        let buffer = unsafe { context.gl().create_buffer() }
            .map_err(GpuError::not_created("a pixel buffer"))?;
        Ok(AsyncRead {
            context: context.clone(),
            buffer,
            capacity: 0,
            pending: None,
        })
    }

    /// Requests the first `width` texels of each of the first `rows` rows of some attachments, one attachment after the
    /// other, and returns at once. Cancels a pending read.
    ///
    /// # Errors
    /// [`GpuError::ReadOutOfRange`], and GL errors.
    pub fn begin(
        &mut self,
        target: &RenderTarget,
        attachments: Range<usize>,
        width: u32,
        rows: u32,
    ) -> Result<(), GpuError> {
        self.cancel();
        let floats_of_one = 4 * width as usize * rows as usize;
        let floats = attachments.len() * floats_of_one;
        self.reserve(floats);
        for (index, attachment) in attachments.enumerate() {
            target.select_for_reading(attachment, width, rows)?;
            self.copy_to_buffer(width, rows, index * floats_of_one);
        }
        // SAFETY: the context is current.
        let fence = unsafe {
            self.context
                .gl()
                .fence_sync(glow::SYNC_GPU_COMMANDS_COMPLETE, 0)
        };
        let fence = fence.map_err(GpuError::not_created("a fence"))?;
        // SAFETY: the context is current. Without the flush the driver may never submit the fence.
        unsafe { self.context.gl().flush() };
        self.pending = Some(Pending { fence, floats });
        self.context.debug_check("an asynchronous read-back")
    }

    /// Makes room for this number of floats in the buffer.
    fn reserve(&mut self, floats: usize) {
        let length = floats * size_of::<f32>();
        if length <= self.capacity {
            return;
        }
        let gl = self.context.gl();
        // SAFETY: the context is current and owns the buffer.
        unsafe {
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(self.buffer));
            let usage = platform::READ_BACK_USAGE;
            gl.buffer_data_size(glow::PIXEL_PACK_BUFFER, length as i32, usage);
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
        }
        self.capacity = length;
    }

    /// Copies texels of the selected attachment to the buffer, behind its first `offset` floats.
    fn copy_to_buffer(&self, width: u32, rows: u32, offset: usize) {
        let gl = self.context.gl();
        // SAFETY: the context is current and owns the buffer and bound framebuffer, and the buffer holds the texels.
        unsafe {
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(self.buffer));
            gl.read_pixels(
                0,
                0,
                width as i32,
                rows as i32,
                glow::RGBA,
                glow::FLOAT,
                PixelPackData::BufferOffset((offset * size_of::<f32>()) as u32),
            );
            // Later reads into memory would otherwise go to the buffer.
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
        }
    }

    /// Returns the result of `read` on the texels once they have arrived; the read is then complete. Never waits.
    ///
    /// # Errors
    /// GL errors.
    pub fn poll<T>(&mut self, read: impl FnOnce(&[f32]) -> T) -> Result<Option<T>, GpuError> {
        match self.wait_for(0)? {
            ControlFlow::Break(floats) => self.take(floats, read).map(Some),
            ControlFlow::Continue(()) => Ok(None),
        }
    }

    /// Waits for the texels without a time limit; returns `None` if no read is pending.
    ///
    /// # Errors
    /// GL errors; [`GpuError::ContextLost`] if the driver reports a lost context.
    pub fn wait<T>(&mut self, read: impl FnOnce(&[f32]) -> T) -> Result<Option<T>, GpuError> {
        if self.pending.is_none() {
            return Ok(None);
        }
        let floats = if platform::CAN_WAIT_FOR_GL {
            until_there(|| self.wait_for(WAIT_NANOSECONDS))?
        } else {
            self.floats_begun()
        };
        self.take(floats, read).map(Some)
    }

    /// Cancels the pending read, if any.
    pub fn cancel(&mut self) {
        if let Some(pending) = self.pending.take() {
            // SAFETY: the context is current; the fence belongs to it and is not used again.
            unsafe { self.context.gl().delete_sync(pending.fence) };
        }
    }

    /// Cancels the pending read and returns its number of floats. Used on platforms where reading the texels is the
    /// only way to wait for them.
    fn floats_begun(&mut self) -> usize {
        let floats = self.pending.as_ref().map_or(0, |pending| pending.floats);
        self.cancel();
        floats
    }

    /// Waits for the fence, at most for the given time. Returns `Break` with the number of floats once the texels have
    /// arrived, and `Continue` otherwise.
    fn wait_for(&mut self, nanoseconds: i32) -> Result<ControlFlow<usize>, GpuError> {
        let Some(pending) = &self.pending else {
            return Ok(ControlFlow::Continue(()));
        };
        // SAFETY: the context is current, and the fence belongs to it.
        let answer = unsafe {
            let gl = self.context.gl();
            gl.client_wait_sync(pending.fence, glow::SYNC_FLUSH_COMMANDS_BIT, nanoseconds)
        };
        match answer {
            glow::ALREADY_SIGNALED | glow::CONDITION_SATISFIED => {
                let floats = pending.floats;
                self.cancel();
                // All fences of a lost context are signalled.
                self.context.check_not_lost()?;
                Ok(ControlFlow::Break(floats))
            }
            // The driver is slow or has lost the context: its reset status decides.
            glow::TIMEOUT_EXPIRED => match self.context.check_not_lost() {
                Ok(()) => Ok(ControlFlow::Continue(())),
                Err(lost) => {
                    self.cancel();
                    Err(lost)
                }
            },
            _ => {
                self.cancel();
                self.context.check("the wait for a read-back")?;
                Err(GpuError::lost("a fence could not be waited for"))
            }
        }
    }

    /// Passes the texels to `read`.
    fn take<T>(&self, floats: usize, read: impl FnOnce(&[f32]) -> T) -> Result<T, GpuError> {
        if platform::CAN_MAP_BUFFERS {
            self.take_mapped(floats, read)
        } else {
            self.take_copied(floats, read)
        }
    }

    fn take_copied<T>(&self, floats: usize, read: impl FnOnce(&[f32]) -> T) -> Result<T, GpuError> {
        let mut copied = vec![0.0; floats];
        let gl = self.context.gl();
        // SAFETY: the context is current and owns the buffer, which holds the requested number of bytes.
        unsafe {
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(self.buffer));
            let bytes = of_floats_mut(&mut copied);
            gl.get_buffer_sub_data(glow::PIXEL_PACK_BUFFER, 0, bytes);
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
        }
        self.context.check_and_wait("the copy of a pixel buffer")?;
        Ok(read(&copied))
    }

    /// Passes the texels to `read` in mapped memory, because copying a large texture would take as long as summing it.
    fn take_mapped<T>(&self, floats: usize, read: impl FnOnce(&[f32]) -> T) -> Result<T, GpuError> {
        let length = floats * size_of::<f32>();
        let gl = self.context.gl();
        // SAFETY: the context is current and owns the buffer. GL maps the requested number of bytes or returns null,
        // and the bytes are read before the buffer is unmapped.
        let result = unsafe {
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(self.buffer));
            let mapped = gl.map_buffer_range(
                glow::PIXEL_PACK_BUFFER,
                0,
                length as i32,
                glow::MAP_READ_BIT,
            );
            let result = (!mapped.is_null()).then(|| {
                let mapped = std::slice::from_raw_parts(mapped, length);
                let result = read(&as_floats(mapped));
                gl.unmap_buffer(glow::PIXEL_PACK_BUFFER);
                result
            });
            gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
            result
        };
        let Some(result) = result else {
            self.context.check("the mapping of a pixel buffer")?;
            return Err(GpuError::lost("a pixel buffer could not be mapped"));
        };
        self.context.debug_check("the end of a read-back")?;
        Ok(result)
    }
}

/// Polls without a time limit until a result is available; only an error ends the wait early.
fn until_there(
    mut ask: impl FnMut() -> Result<ControlFlow<usize>, GpuError>,
) -> Result<usize, GpuError> {
    loop {
        if let ControlFlow::Break(floats) = ask()? {
            return Ok(floats);
        }
    }
}

impl Drop for AsyncRead {
    fn drop(&mut self) {
        let fence = self.pending.take().map(|pending| pending.fence);
        // SAFETY: the context is current and owns the fence and buffer, which are not used again.
        self.context.free(|gl| unsafe {
            if let Some(fence) = fence {
                gl.delete_sync(fence);
            }
            gl.delete_buffer(self.buffer);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gl::backend::Backend;
    use crate::gl::osmesa::OsMesa;
    use crate::gl::{Api, Texture};
    use std::cell::Cell;
    use std::ffi::{CStr, c_void};
    use std::rc::Rc;

    thread_local! {
        /// The reset status that the driver of [`Resetting`] reports.
        static RESET_STATUS: Cell<u32> = const { Cell::new(glow::NO_ERROR) };
    }

    extern "system" fn reset_status() -> u32 {
        RESET_STATUS.get()
    }

    /// A driver that reports a lost context when the test sets `RESET_STATUS`.
    struct Resetting(OsMesa);

    impl Backend for Resetting {
        fn make_current(&self) -> Result<(), String> {
            self.0.make_current()
        }

        fn is_current(&self) -> bool {
            self.0.is_current()
        }

        fn release(&self) {
            self.0.release();
        }

        fn proc_address(&self, name: &CStr) -> *const c_void {
            match name.to_bytes().starts_with(b"glGetGraphicsResetStatus") {
                true => reset_status as *const c_void,
                false => self.0.proc_address(name),
            }
        }
    }

    /// Protects from using the results of a lost context and from waiting for them forever: the next poll reports the
    /// reset, whether or not the fence is signalled.
    #[test]
    fn a_reset_is_told() {
        let driver = Rc::new(Resetting(OsMesa::new().unwrap()));
        let context = Context::from_backend(driver, Api::OsMesa).unwrap();
        let texture = Texture::new(&context, 2, 2).unwrap();
        let target = RenderTarget::new(&context, &[&texture]).unwrap();
        let mut read = AsyncRead::new(&context).unwrap();
        read.begin(&target, 0..1, 2, 2).unwrap();
        assert_eq!(read.wait(<[f32]>::len).unwrap(), Some(16));
        read.begin(&target, 0..1, 2, 2).unwrap();
        // The status named GUILTY_CONTEXT_RESET in KHR_robustness.
        const GUILTY_CONTEXT_RESET: u32 = 0x8253;
        RESET_STATUS.set(GUILTY_CONTEXT_RESET);
        let lost = |error| matches!(error, GpuError::ContextLost { .. });
        assert!(read.wait(<[f32]>::len).is_err_and(lost));
        assert!(read.pending.is_none());
        assert!(target.read(0).is_err_and(lost));
        assert!(Texture::new(&context, 2, 2).is_err_and(lost));
        RESET_STATUS.set(glow::NO_ERROR);
    }

    /// Protects frames that take minutes: timed-out waits are never taken for a lost context, and a lost context is
    /// reported at once.
    #[test]
    fn slowness_is_no_loss() {
        let mut asked = 0;
        let slow = until_there(|| {
            asked += 1;
            Ok(match asked {
                100_000 => ControlFlow::Break(4),
                _ => ControlFlow::Continue(()),
            })
        });
        assert!(matches!(slow, Ok(4)));
        let lost = until_there(|| Err(GpuError::lost("reset")));
        assert!(matches!(lost, Err(GpuError::ContextLost { .. })));
    }
}
