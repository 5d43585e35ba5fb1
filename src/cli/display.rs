//! The picture as it gets better, in the viewer tev (<https://github.com/Tom94/tev>).
//!
//! A render never fails, and hardly waits, because of a viewer: what cannot be sent is told once,
//! and tried again later.

use super::talk;
use super::values::Parsed;
use std::io::{self, ErrorKind};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};
use steradian::Renderer;
use steradian::image::Picture;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// Least time from one picture to the next.
const INTERVAL: Duration = Duration::from_secs(1);
/// The same in units of what a picture takes, so that it costs a twentieth of the render at most.
const COST: u32 = 20;
/// Until the next attempt where one failed.
const RETRY: Duration = Duration::from_secs(10);
/// A viewer that does not answer is given up after this time.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(1);
const SEND_TIMEOUT: Duration = Duration::from_secs(3);
/// Pixels of one packet, about.
const PACKET_PIXELS: usize = 1 << 18;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A viewer, or none.
pub(super) struct Display<'a> {
    address: Option<&'a str>,
    /// Of the image in the viewer.
    name: String,
    client: Option<TevClient>,
    next: Instant,
    has_warned: bool,
}

impl<'a> Display<'a> {
    /// Nothing is sent yet. Without an address nothing ever is.
    pub(super) fn new(address: Option<&'a str>, name: &str) -> Self {
        let name = name.replace('\0', "");
        Self { address, name, client: None, next: Instant::now(), has_warned: false }
    }

    /// Sends the picture if it is time to.
    pub(super) fn update(&mut self, renderer: &Renderer) {
        if self.address.is_some() && Instant::now() >= self.next {
            self.show(renderer);
        }
    }

    /// Sends the last picture, unless the viewer was not there a moment ago.
    pub(super) fn finish(mut self, renderer: &Renderer) {
        if self.address.is_some() && (self.client.is_some() || Instant::now() >= self.next) {
            self.show(renderer);
        }
    }

    fn show(&mut self, renderer: &Renderer) {
        let begin = Instant::now();
        // A device that is lost is the renderer's to tell.
        let Ok(preview) = renderer.preview() else { return };
        let sent = self.send(&preview.picture);
        self.next = Instant::now() + INTERVAL.max(COST * begin.elapsed());
        let Err(error) = sent else { return };
        self.client = None;
        self.next = Instant::now() + RETRY;
        if !self.has_warned {
            let address = self.address.unwrap_or_default();
            talk::line(&format!("warning: the viewer at {address}: {error}; the render goes on"));
            self.has_warned = true;
        }
    }

    fn send(&mut self, picture: &Picture) -> io::Result<()> {
        let client = match &mut self.client {
            Some(client) => client,
            none => {
                let mut client = TevClient::wrap(connect(self.address.unwrap_or_default())?);
                client.send(PacketCreateImage {
                    image_name: &self.name,
                    grab_focus: true,
                    width: picture.width,
                    height: picture.height,
                    channel_names: &CHANNELS,
                })?;
                none.insert(client)
            }
        };
        let width = picture.width as usize;
        let rows = (PACKET_PIXELS / width).max(1);
        for (strip, y) in picture.rgb.chunks(rows * width).zip((0..).step_by(rows)) {
            client.send(PacketUpdateImage {
                image_name: &self.name,
                grab_focus: false,
                channel_names: &CHANNELS,
                channel_offsets: &[0, 1, 2],
                channel_strides: &[3; 3],
                x: 0,
                y,
                width: picture.width,
                height: (strip.len() / width) as u32,
                data: strip.as_flattened(),
            })?;
        }
        Ok(())
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(ErrorKind::NotFound, "the name has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
            Ok(stream) => {
                stream.set_write_timeout(Some(SEND_TIMEOUT))?;
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// `HOST:PORT`.
pub(super) fn address(text: &str) -> Parsed<String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok_and(|p| p > 0) => {
            Ok(text.to_owned())
        }
        _ => Err("expected HOST:PORT; tev itself listens at 127.0.0.1:14158".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_a_host_and_a_port() {
        for good in ["127.0.0.1:14158", "[::1]:14158", "farm:1"] {
            assert_eq!(address(good).as_deref(), Ok(good));
        }
        for bad in ["", "127.0.0.1", ":14158", "host:", "host:x", "host:0", "host:65536"] {
            assert!(address(bad).is_err(), "{bad}");
        }
    }
}
