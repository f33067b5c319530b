//! Units and axes of a file.

use glam::Vec3;

/// The unit that lengths are written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// Meters, as in the groom.
    #[default]
    Meters,
    /// Centimeters, as in Unreal and Maya.
    Centimeters,
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// Y, as in the groom.
    #[default]
    Y,
    /// Z, as in Blender and Unreal.
    Z,
}

/// From the groom's meters, Y up, to those of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Unit of length.
    pub units: Units,
    /// Axis that points up.
    pub up: Up,
}

impl Frame {
    /// Length of a unit, meters.
    pub fn meters_per_unit(self) -> f64 {
        match self.units {
            Units::Meters => 1.0,
            Units::Centimeters => 0.01,
        }
    }

    /// As USD names it.
    pub fn up_axis(self) -> &'static str {
        match self.up {
            Up::Y => "Y",
            Up::Z => "Z",
        }
    }

    /// A length in the file's units.
    pub fn length(self, meters: f32) -> f32 {
        match self.units {
            Units::Meters => meters,
            Units::Centimeters => meters * 100.0,
        }
    }

    /// A direction in the file's axes.
    pub fn direction(self, v: Vec3) -> Vec3 {
        match self.up {
            Up::Y => v,
            Up::Z => Vec3::new(v.x, -v.z, v.y),
        }
    }

    /// A point in the file's units and axes.
    pub fn point(self, p: Vec3) -> Vec3 {
        let turned = self.direction(p);
        match self.units {
            Units::Meters => turned,
            Units::Centimeters => turned * 100.0,
        }
    }
}
