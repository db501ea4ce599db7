//! The textures that the passes of arrivals draw to, and the read-back of these textures.

use super::super::Grid;
use super::super::order_table::OrderTable;
use super::super::start_order::{StartOrder, Starts};
use super::super::waves::{STATUS_DEAD, start_texels};
use super::block::{Listed, most_crossings};
use super::passages::Passage;
use super::replay::Chunk;
use super::settings::Start;
use crate::gl::{AsyncRead, Context, GpuError, Program, RenderTarget, Texture};
use crate::shader::{ArrivalsText, StartOrderText};
use glam::{DVec3, Vec3};
use std::ops::Range;
use std::rc::Rc;

/// Waves per row of a list.
const LIST_WIDTH: u32 = 256;

/// Rows of a list.
const LIST_HEIGHT: u32 = 64;

/// Maximum waves drawn as one list.
pub const LISTED_AT_MOST: usize = (LIST_WIDTH * LIST_HEIGHT) as usize;

/// A list entry that holds no wave.
const NO_WAVE: [f32; 4] = [-1.0, 0.0, 0.0, 0.0];

/// Number of rows of a list with `waves` waves.
pub fn listed_rows(waves: usize) -> u32 {
    (waves as u32).div_ceil(LIST_WIDTH)
}

/// The textures for blocks of waves of one size.
pub struct ArrivalTargets {
    pub grid: Grid,
    /// The text that defines the outputs.
    pub text: ArrivalsText,
    /// Two pairs of textures: position and status, direction and length of the waves.
    states: [[Texture; 2]; 2],
    /// The target of each pair, with the tally and the records, which both targets share.
    chunks: [RenderTarget; 2],
    current: usize,
    /// Read-back of tally, words and records.
    read: AsyncRead,
    /// The texels that were read.
    texels: Vec<Vec<f32>>,
    pub list: ListTargets,
    /// The texel from which the next chunk takes the wave of each texel.
    originals: Texture,
    /// The order of the starts of the last block whose starts were sorted.
    order: Option<OrderTable>,
    _shared: Vec<Texture>,
}

/// The textures for a list of waves.
pub struct ListTargets {
    pub waves: Texture,
    pub target: RenderTarget,
    first_record: usize,
    _textures: Vec<Texture>,
}

impl ArrivalTargets {
    pub fn new(
        context: &Context,
        grid: Grid,
        text: ArrivalsText,
    ) -> Result<ArrivalTargets, GpuError> {
        let texture = || Texture::new(context, grid.width, grid.height);
        let states = [[texture()?, texture()?], [texture()?, texture()?]];
        let shared = textures(text.outputs() - ArrivalsText::TALLY, texture)?;
        let target = |[first, second]: &[Texture; 2]| {
            let all: Vec<&Texture> = [first, second].into_iter().chain(&shared).collect();
            RenderTarget::new(context, &all)
        };
        let chunks = [target(&states[0])?, target(&states[1])?];
        Ok(ArrivalTargets {
            grid,
            states,
            chunks,
            current: 0,
            read: AsyncRead::new(context)?,
            texels: vec![Vec::new(); shared.len()],
            list: ListTargets::new(context, &text)?,
            originals: texture()?,
            order: None,
            text,
            _shared: shared,
        })
    }

    /// Whether these textures match the outputs of this text.
    pub fn is_for(&self, text: &ArrivalsText) -> bool {
        let outputs = |text: &ArrivalsText| (text.has_words, text.records);
        outputs(&self.text) == outputs(text)
    }

    /// Sorts the starts of a block, which are those of the settings or given starts. Returns `None` if waves start in
    /// the order of their numbers.
    pub fn sort_starts(
        &mut self,
        context: &Context,
        (block, order): (Grid, StartOrderText),
        (starts, given): (Starts, Option<&[Start]>),
    ) -> Result<Option<Rc<StartOrder>>, GpuError> {
        if order == StartOrderText::ByNumber {
            self.order = None;
            return Ok(None);
        }
        let (known, size) = (self.order.take(), (block, self.grid.height));
        let table = match given {
            None => OrderTable::of_starts(context, known, starts, size)?,
            Some(given) => {
                let directions = given.iter().map(|start| start.direction);
                OrderTable::of_directions(context, directions, size)?
            }
        };
        let table = self.order.insert(table);
        Ok(Some(Rc::clone(table.order())))
    }

    /// Binds the order of the starts, if they are sorted, for a program that reads it.
    pub fn bind_order(&self, program: &Program) {
        if let Some(order) = &self.order {
            order.bind(program);
        }
    }

    /// Writes the starts of the waves: a common position and status, and a separate direction for each wave.
    pub fn upload_starts(&self, start: [f32; 4], starts: &[Start]) -> Result<(), GpuError> {
        let texels = (self.grid.width * self.grid.height) as usize;
        let mut directions: Vec<Vec3> = starts.iter().map(|start| start.direction).collect();
        for (wave, start) in starts.iter().enumerate() {
            directions[self.texel(wave)] = start.direction;
        }
        let [origins, directions] = start_texels(start, directions.into_iter(), texels);
        self.upload([&origins, &directions])
    }

    /// Writes the starts of waves that continue passages. `local` returns a world point in the shaders' coordinates.
    pub fn upload_passages(
        &self,
        passages: &[Passage],
        local: impl Fn(DVec3) -> Vec3,
    ) -> Result<(), GpuError> {
        let texels = (self.grid.width * self.grid.height) as usize;
        let nowhere = Vec3::ZERO.extend(STATUS_DEAD).to_array();
        let (mut origins, mut directions) = (vec![nowhere; texels], vec![[0.0; 4]; texels]);
        for (wave, passage) in passages.iter().enumerate() {
            let texel = self.texel(wave);
            let status = passage.surface as f32;
            origins[texel] = local(passage.point).extend(status).to_array();
            let flown = passage.length_m as f32;
            directions[texel] = passage.direction.extend(flown).to_array();
        }
        self.upload([&origins, &directions])
    }

    /// Sets the texel from which the next chunk takes the wave of each texel.
    pub fn upload_originals(&self, texels: &[i32]) -> Result<(), GpuError> {
        let entry = |texel: &i32| [*texel as f32, 0.0, 0.0, 0.0];
        let mut entries: Vec<[f32; 4]> = texels.iter().map(entry).collect();
        entries.resize((self.grid.width * self.grid.height) as usize, [0.0; 4]);
        self.originals.upload(entries.as_flattened())
    }

    /// The texels from which a chunk after a resampling takes its waves.
    pub fn originals(&self) -> &Texture {
        &self.originals
    }

    /// The texel of a wave of the block.
    fn texel(&self, wave: usize) -> usize {
        let order = self.order.as_ref().map(OrderTable::order);
        order.map_or(wave, |order| order.texel(wave as u32) as usize)
    }

    /// Writes the waves at the start of a block.
    fn upload(&self, [origins, directions]: [&[[f32; 4]]; 2]) -> Result<(), GpuError> {
        let [first, second] = self.current();
        first.upload(origins.as_flattened())?;
        second.upload(directions.as_flattened())
    }

    /// The textures with the waves at the start of the chunk.
    pub fn current(&self) -> &[Texture; 2] {
        &self.states[self.current]
    }

    /// The target with the waves at the end of the chunk.
    pub fn next(&self) -> &RenderTarget {
        &self.chunks[1 - self.current]
    }

    /// Makes the end of the drawn chunk the start of the next one.
    pub fn flip(&mut self) {
        self.current = 1 - self.current;
    }

    /// Reads back a chunk's results, up to row `rows`: the tally, the words, and the records up to the largest
    /// number of crossings of a wave.
    pub fn read(&mut self, rows: u32) -> Result<(), GpuError> {
        let first_record = (self.text.first_record() - ArrivalsText::TALLY) as usize;
        self.read_textures(0..first_record, rows)?;
        let records = most_crossings(self.tally()).min(self.text.records) as usize;
        self.read_textures(first_record..first_record + records, rows)
    }

    /// Reads back the textures with these numbers, counted from the tally.
    fn read_textures(&mut self, textures: Range<usize>, rows: u32) -> Result<(), GpuError> {
        if textures.is_empty() {
            return Ok(());
        }
        let target = &self.chunks[1 - self.current];
        let first = ArrivalsText::TALLY as usize;
        let attachments = first + textures.start..first + textures.end;
        self.read
            .begin(target, attachments, self.grid.width, rows)?;
        let all = &mut self.texels[textures];
        self.read.wait(|floats| {
            let parts = floats.chunks_exact((floats.len() / all.len()).max(1));
            for (texels, part) in all.iter_mut().zip(parts) {
                texels.clear();
                texels.extend_from_slice(part);
            }
        })?;
        Ok(())
    }

    /// The tally, as read back.
    pub fn tally(&self) -> &[f32] {
        &self.texels[0]
    }

    /// The texels that were read back, with the records of a list.
    pub fn chunk<'a>(&'a self, listed: &'a [Vec<f32>], iterations: u32) -> Chunk<'a> {
        let first_record = (self.text.first_record() - ArrivalsText::TALLY) as usize;
        Chunk {
            tally: self.tally(),
            words: self.text.has_words.then(|| &self.texels[1][..]),
            records: &self.texels[first_record..],
            listed,
            iterations,
        }
    }
}

impl ListTargets {
    fn new(context: &Context, text: &ArrivalsText) -> Result<ListTargets, GpuError> {
        let texture = || Texture::new(context, LIST_WIDTH, LIST_HEIGHT);
        let textures = textures(text.outputs(), texture)?;
        let all: Vec<&Texture> = textures.iter().collect();
        Ok(ListTargets {
            waves: texture()?,
            target: RenderTarget::new(context, &all)?,
            first_record: text.first_record() as usize,
            _textures: textures,
        })
    }

    /// Width and height in texels.
    pub fn size(&self) -> (u32, u32) {
        (LIST_WIDTH, LIST_HEIGHT)
    }

    /// Sets the waves of the list.
    pub fn upload(&self, list: &[Listed]) -> Result<(), GpuError> {
        let entry = |listed: &Listed| [listed.texel as f32, listed.passed_over as f32, 0.0, 0.0];
        let mut entries: Vec<[f32; 4]> = list.iter().map(entry).collect();
        entries.resize(LISTED_AT_MOST, NO_WAVE);
        self.waves.upload(entries.as_flattened())
    }

    /// Appends the records of a list with `waves` waves to `records`.
    pub fn read(&self, waves: usize, records: &mut [Vec<f32>]) -> Result<(), GpuError> {
        let mut texels = Vec::new();
        for (index, record) in records.iter_mut().enumerate() {
            let attachment = self.first_record + index;
            let rows = listed_rows(waves);
            self.target
                .read_into(attachment, LIST_WIDTH, rows, &mut texels)?;
            record.extend_from_slice(&texels[..4 * waves]);
        }
        Ok(())
    }
}

fn textures(
    count: u32,
    texture: impl Fn() -> Result<Texture, GpuError>,
) -> Result<Vec<Texture>, GpuError> {
    (0..count).map(|_| texture()).collect()
}
