//! What a ray starts on as one number, to be held in a lane.

use super::super::surface::OuterState;
use super::super::{Element, HitState};

pub(super) const FACE: u64 = 0;
pub(super) const RISER: u64 = 1;
pub(super) const RISER_OF_LOWER: u64 = 2;
const VOID: u64 = 3;

impl HitState {
    /// As one number: the kind of the boundary in the upper half, its place in the lower one.
    pub(crate) fn bits(self) -> u64 {
        let outer = |sector: u16, strip: u16| u64::from(sector) | u64::from(strip) << 16;
        match self.element {
            Element::Outer(OuterState::Face { sector, strip }) => outer(sector, strip) | FACE << 32,
            Element::Outer(OuterState::Riser {
                sector,
                strip,
                solid_below: false,
            }) => outer(sector, strip) | RISER << 32,
            Element::Outer(OuterState::Riser { sector, strip, .. }) => {
                outer(sector, strip) | RISER_OF_LOWER << 32
            }
            Element::Void(index) => u64::from(index) | VOID << 32,
            // Fibers that have these have no packets.
            Element::Outer(OuterState::Smooth)
            | Element::Outline
            | Element::Rim(_)
            | Element::Fusus(_)
            | Element::Triangle { .. } => u64::MAX,
        }
    }

    /// The state of a number.
    pub(crate) fn of_bits(bits: u64) -> Self {
        let (sector, strip) = (bits as u16, (bits >> 16) as u16);
        let riser = |solid_below| {
            Element::Outer(OuterState::Riser {
                sector,
                strip,
                solid_below,
            })
        };
        Self {
            element: match bits >> 32 {
                FACE => Element::Outer(OuterState::Face { sector, strip }),
                RISER => riser(false),
                RISER_OF_LOWER => riser(true),
                _ => Element::Void(bits as u32),
            },
        }
    }
}
