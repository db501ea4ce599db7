//! The order of starts on the GPU: a table that shaders read (`glsl/order.glsl`), kept until the starts change.

use super::Grid;
use super::start_order::{StartOrder, Starts};
use crate::gl::{Context, GpuError, Program, Texture};
use glam::Vec3;
use std::rc::Rc;

/// The texture unit of the table. The other units hold waves, scene data and lists.
const ORDER_UNIT: u32 = 4;

/// The table for textures of one size.
pub(super) struct OrderTable {
    texture: Texture,
    order: Rc<StartOrder>,
    /// The starts whose order the table has; `None` if a caller gave the directions.
    of: Option<Starts>,
}

impl OrderTable {
    /// The table of an order for textures of this size.
    fn new(
        context: &Context,
        [width, height]: [u32; 2],
        order: StartOrder,
        of: Option<Starts>,
    ) -> Result<OrderTable, GpuError> {
        let texture = Texture::new(context, width, height)?;
        texture.upload(order.table(height).as_flattened())?;
        Ok(OrderTable {
            texture,
            order: Rc::new(order),
            of,
        })
    }

    /// The table of these starts in a grid, for textures of `height` rows. `known` is returned if it has the same
    /// starts.
    pub fn of_starts(
        context: &Context,
        known: Option<OrderTable>,
        starts: Starts,
        (grid, height): (Grid, u32),
    ) -> Result<OrderTable, GpuError> {
        match known {
            Some(known) if known.of.as_ref() == Some(&starts) => Ok(known),
            _ => {
                let order = starts.order(grid);
                OrderTable::new(context, [grid.width, height], order, Some(starts))
            }
        }
    }

    /// The table of waves whose start directions are these unit vectors.
    pub fn of_directions(
        context: &Context,
        directions: impl Iterator<Item = Vec3>,
        (grid, height): (Grid, u32),
    ) -> Result<OrderTable, GpuError> {
        let order = StartOrder::of_directions(directions, grid);
        OrderTable::new(context, [grid.width, height], order, None)
    }

    /// The order itself.
    pub fn order(&self) -> &Rc<StartOrder> {
        &self.order
    }

    /// Binds the table for a program that reads it.
    pub fn bind(&self, program: &Program) {
        program.set_texture("uOrder", ORDER_UNIT, &self.texture);
    }
}
