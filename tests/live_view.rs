//! `--tev`: what comes over the wire is the picture, read as tev reads it.

#![allow(clippy::unwrap_used)] // all of it is test

use exr::prelude::read_first_rgba_layer_from_file;
use std::io::Read;
use std::net::TcpListener;
use std::process::Command;

fn render(port: u16, folder: &std::path::Path) -> std::process::Output {
    let line = format!(
        "-q render human --model chiang --skin ball --strands 3000 --res 40x30 --crop 4,2,30,25 --spp 4 --tev=127.0.0.1:{port}"
    );
    Command::new(env!("CARGO_BIN_EXE_vair"))
        .args(line.split(' '))
        .args(["-o", "live.exr"])
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Numbers and texts of a packet, as they come.
struct Packet(std::vec::IntoIter<u8>);

impl Packet {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.0.next().unwrap())
    }

    fn int(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }

    fn text(&mut self) -> String {
        let bytes: Vec<u8> = self.0.by_ref().take_while(|&b| b != 0).collect();
        String::from_utf8(bytes).unwrap()
    }
}

/// All packets of a connection.
fn packets(mut stream: impl Read) -> Vec<Packet> {
    let mut all = Vec::new();
    stream.read_to_end(&mut all).unwrap();
    let mut packets = Vec::new();
    let mut rest = &all[..];
    while !rest.is_empty() {
        let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
        packets.push(Packet(Vec::from(&rest[4..length]).into_iter()));
        rest = &rest[length..];
    }
    packets
}

#[test]
fn tev_gets_the_picture_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let tev = std::thread::spawn(move || packets(listener.accept().unwrap().0));
    let output = render(port, folder.path());
    assert!(output.status.success(), "{output:?}");
    let mut packets = tev.join().unwrap().into_iter();

    let mut create = packets.next().unwrap();
    assert_eq!(create.bytes(), [4, 1]);
    assert_eq!(create.text(), "live.exr");
    assert_eq!([create.int(), create.int(), create.int()], [40, 30, 4]);
    let names = std::array::from_fn(|_| create.text());
    assert_eq!(names, ["R", "G", "B", "A"]);

    let mut last = packets.last().unwrap();
    assert_eq!(last.bytes(), [6, 0]);
    assert_eq!((last.text().as_str(), last.int()), ("live.exr", 4));
    let names = std::array::from_fn(|_| last.text());
    assert_eq!(names, ["R", "G", "B", "A"]);
    assert_eq!(
        [last.int(), last.int(), last.int(), last.int()],
        [4, 2, 30, 25]
    );
    let longs: [u64; 8] = std::array::from_fn(|_| u64::from_le_bytes(last.bytes()));
    assert_eq!(longs, [0, 1, 2, 3, 4, 4, 4, 4]);
    let sent: Vec<[f32; 4]> = (0..30 * 25)
        .map(|_| std::array::from_fn(|_| f32::from_le_bytes(last.bytes())))
        .collect();
    assert!(last.0.next().is_none());

    let image = read_first_rgba_layer_from_file(
        folder.path().join("live.exr"),
        |size, _| vec![vec![[0.0f32; 4]; size.width()]; size.height()],
        |rows, at, (r, g, b, a): (f32, f32, f32, f32)| rows[at.y()][at.x()] = [r, g, b, a],
    );
    let written = image.unwrap().layer_data.channel_data.pixels.concat();
    assert_eq!(sent, written);
}

#[test]
fn a_tev_that_is_not_there_is_said_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let port = {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.local_addr().unwrap().port()
    };
    let output = render(port, folder.path());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("no tev answers at 127.0.0.1:") && said.contains("--tev="),
        "{said}"
    );
    assert!(!folder.path().join("live.exr").exists());
}
