//! `--display-server`: a listener in place of tev decodes what it is sent.

use super::{Program, QUAD_LIGHT, talk};
use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::thread;
use steradian::image::read_exr;

const SMALL: [&str; 4] = ["--resolution", "16x12", "--spp", "8"];

/// What a packet has left.
struct Packet(Vec<u8>);

impl Packet {
    /// The next packet: a length of 32 bits that counts itself, and as many bytes; `None` at the end.
    fn read(stream: &mut TcpStream) -> Option<Self> {
        let mut length = [0; 4];
        stream.read_exact(&mut length).ok()?;
        let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
        stream.read_exact(&mut bytes).unwrap();
        Some(Self(bytes))
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let bytes: Vec<u8> = self.0.drain(..N).collect();
        bytes.try_into().unwrap()
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap();
        let text = self.0.drain(..=end).take(end).collect();
        String::from_utf8(text).unwrap()
    }

    fn channels(&mut self) -> Vec<String> {
        (0..self.u32()).map(|_| self.text()).collect()
    }
}

#[test]
fn tev_gets_the_picture_that_is_written() {
    let program = Program::new();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let viewer = thread::spawn(move || {
        let mut stream = listener.accept().unwrap().0;
        std::iter::from_fn(|| Packet::read(&mut stream)).collect::<Vec<_>>()
    });
    let flags = ["-o", "a.exr", "--display-server", &address];
    program.succeed(&[&["render", QUAD_LIGHT], &SMALL[..], &flags].concat());
    // Had nobody come, it would wait for ever.
    drop(TcpStream::connect(&address));
    let mut packets = viewer.join().unwrap();
    assert!(packets.len() >= 2, "{}", packets.len());

    let create = &mut packets[0];
    // Create, and take the focus.
    assert_eq!(create.take::<2>(), [4, 1]);
    assert_eq!(create.text(), "a.exr");
    assert_eq!([create.u32(), create.u32()], [16, 12]);
    assert_eq!(create.channels(), ["R", "G", "B"]);
    assert!(create.0.is_empty());

    let update = packets.last_mut().unwrap();
    // Update, third version, and leave the focus.
    assert_eq!(update.take::<2>(), [6, 0]);
    assert_eq!(update.text(), "a.exr");
    assert_eq!(update.channels(), ["R", "G", "B"]);
    assert_eq!([update.u32(), update.u32(), update.u32(), update.u32()], [0, 0, 16, 12]);
    let numbers: Vec<u64> = (0..6).map(|_| u64::from_le_bytes(update.take())).collect();
    assert_eq!(numbers, [0, 1, 2, 3, 3, 3]);
    let sent: Vec<f32> =
        update.0.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let written = read_exr(&program.path("a.exr")).unwrap().picture().unwrap();
    assert_eq!(sent, written.rgb.as_flattened());
    assert!(sent.iter().any(|value| *value > 0.0));
}

#[test]
fn a_viewer_that_is_not_there_or_goes_away_is_told_once() {
    let program = Program::new();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let flags = ["-o", "a.exr", "--display-server", &address];
    let render = || {
        let output = program.run(&[&["render", QUAD_LIGHT], &SMALL[..], &flags].concat());
        let said = talk(&output);
        assert_eq!(output.status.code(), Some(0), "{said}");
        said.matches("warning: the viewer at ").count()
    };
    // It hangs up. What was sent before that is noticed may be everything.
    let viewer = thread::spawn(move || drop(listener.accept().unwrap()));
    assert!(render() <= 1);
    drop(TcpStream::connect(&address));
    viewer.join().unwrap();
    // Nobody listens any more.
    assert_eq!(render(), 1);
    let refused = ["render", QUAD_LIGHT, "-o", "a.exr", "--display-server", "tev"];
    assert_eq!(program.run(&refused).status.code(), Some(2));
}
