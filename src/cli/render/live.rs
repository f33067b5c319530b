//! The picture while it is made, in tev (github.com/Tom94/tev).

use crate::blame::Blame;
use crate::cli::{Console, Failure};
use crate::render::Film;
use std::io::Error;
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::time::Duration;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// Where tev listens unless it is told otherwise.
pub(super) const TEV: &str = "127.0.0.1:14158";

/// Longest wait for tev to answer, or to take a picture.
const PATIENCE: Duration = Duration::from_secs(5);

const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// A window of tev that shows a picture.
pub(super) struct Live {
    /// `None` after tev was closed.
    client: Option<TevClient>,
    name: String,
    is_open: bool,
}

impl Live {
    /// * `address`: of tev, host and port. * `path`: of the picture, which has its name there.
    ///
    /// # Errors
    /// Nobody listens.
    pub(super) fn connect(address: &str, path: &Path) -> Result<Self, Failure> {
        let socket = connect(address).map_err(|error| {
            let message = format!("no tev answers at {address}: {error}");
            let help = format!("start tev, or say where it listens: --tev={TEV}");
            Failure::with_help(Blame::Environment, message, help)
        })?;
        Ok(Self {
            client: Some(TevClient::wrap(socket)),
            name: path.to_string_lossy().into_owned(),
            is_open: false,
        })
    }

    /// Shows the picture as it is. Once tev is gone that is said, and the picture is made without.
    pub(super) fn show(&mut self, film: &Film, console: &Console) {
        if let Err(error) = self.send(film) {
            console.say(format!("warning: tev is gone: {error}"));
            self.client = None;
        }
    }

    fn send(&mut self, film: &Film) -> Result<(), Error> {
        let Some(client) = &mut self.client else {
            return Ok(());
        };
        if !self.is_open {
            let [width, height] = film.resolution;
            client.send(PacketCreateImage {
                image_name: &self.name,
                grab_focus: true,
                width,
                height,
                channel_names: &CHANNELS,
            })?;
            self.is_open = true;
        }
        let pixels = film.pixels.iter();
        let data: Vec<f32> = pixels
            .flat_map(|p| [p.radiance.x, p.radiance.y, p.radiance.z, p.alpha])
            .collect();
        // Packets tell their length in 32 bits: large pictures go in strips.
        let width = film.crop.width as usize;
        let rows = (MOST_NUMBERS / (width * CHANNELS.len())).max(1);
        for (index, strip) in data.chunks(rows * width * CHANNELS.len()).enumerate() {
            client.send(PacketUpdateImage {
                image_name: &self.name,
                grab_focus: false,
                channel_names: &CHANNELS,
                channel_offsets: &[0, 1, 2, 3],
                channel_strides: &[4; 4],
                x: film.crop.x,
                y: film.crop.y + (index * rows) as u32,
                width: film.crop.width,
                height: (strip.len() / (width * CHANNELS.len())) as u32,
                data: strip,
            })?;
        }
        Ok(())
    }
}

/// Most numbers in a packet: 64 MB.
const MOST_NUMBERS: usize = 1 << 24;

fn connect(address: &str) -> Result<TcpStream, Error> {
    let mut last = None;
    for place in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&place, PATIENCE) {
            Ok(socket) => {
                socket.set_write_timeout(Some(PATIENCE))?;
                return Ok(socket);
            }
            Err(error) => last = Some(error),
        }
    }
    Err(last.unwrap_or_else(|| Error::other("there is no such place")))
}
