//! Intel Open Image Denoise 2, a C library that is looked for when it is asked for. The program
//! neither links to it nor needs it.
#![allow(unsafe_code, reason = "functions of a C library that is loaded at run time")]

use super::Guides;
use crate::image::Picture;
use crate::{Error, Result};
use libloading::{Library, library_filename};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::io::{Error as IoError, ErrorKind};
use std::path::PathBuf;
use std::ptr;

/// Environment variable that names the library's file.
pub const LIBRARY_VARIABLE: &str = "STERADIAN_OIDN";

/// `OIDN_DEVICE_TYPE_CPU`: the same picture whatever graphics card there is.
const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;
/// `OIDN_ERROR_NONE`.
const NO_ERROR: c_int = 0;

type Object = *mut c_void;
type Of<R> = unsafe extern "C" fn(Object) -> R;

/// The functions that are used, as `oidn.h` of version 2 declares them.
struct Functions {
    new_device: unsafe extern "C" fn(c_int) -> Object,
    commit_device: Of<()>,
    release_device: Of<()>,
    device_error: unsafe extern "C" fn(Object, *mut *const c_char) -> c_int,
    new_filter: unsafe extern "C" fn(Object, *const c_char) -> Object,
    set_image: unsafe extern "C" fn(
        Object,
        *const c_char,
        *mut c_void,
        c_int,
        usize,
        usize,
        usize,
        usize,
        usize,
    ),
    set_bool: unsafe extern "C" fn(Object, *const c_char, bool),
    commit_filter: Of<()>,
    execute_filter: Of<()>,
    release_filter: Of<()>,
}

/// The library, loaded.
pub struct Oidn {
    functions: Functions,
    path: PathBuf,
    /// Last, so that it is unloaded last.
    _library: Library,
}

impl Oidn {
    /// Loads the library: the file that [`LIBRARY_VARIABLE`] names, or the one that the system finds.
    ///
    /// # Errors
    /// [`Error::Io`] that says how to get it, where there is none or it is not version 2.
    pub fn load() -> Result<Self> {
        match std::env::var_os(LIBRARY_VARIABLE) {
            Some(path) => Self::load_file(PathBuf::from(path)),
            None => {
                let versioned = if cfg!(target_os = "macos") {
                    "libOpenImageDenoise.2.dylib".into()
                } else {
                    PathBuf::from("libOpenImageDenoise.so.2")
                };
                let plain = PathBuf::from(library_filename("OpenImageDenoise"));
                Self::load_file(versioned).or_else(|_| Self::load_file(plain))
            }
        }
    }

    fn load_file(path: PathBuf) -> Result<Self> {
        let missing = |path: &PathBuf, reason: String| {
            let message = format!(
                "Intel Open Image Denoise 2 cannot be loaded ({reason}); install it (the Python package \
                 pyoidn holds it) and let {LIBRARY_VARIABLE} name the file libOpenImageDenoise.so"
            );
            Error::io(path, IoError::new(ErrorKind::NotFound, message))
        };
        // SAFETY: the library's initialisers run, as those of any that a program links to; which
        // file that is, the user says.
        let library = unsafe { Library::new(&path) }.map_err(|e| missing(&path, e.to_string()))?;
        // SAFETY: the types are those of the header.
        let functions = unsafe { Functions::of(&library) }
            .map_err(|e| missing(&path, format!("it is not version 2: {e}")))?;
        Ok(Self { functions, path, _library: library })
    }

    /// `picture` with less noise. Guides are filtered first. Pixels that are not finite count as
    /// black.
    ///
    /// # Errors
    /// [`Error::Io`] with the library's words.
    ///
    /// # Panics
    /// If a guide has not the picture's pixels.
    pub fn denoise(&self, picture: &Picture, guides: Guides) -> Result<Picture> {
        let size = (picture.width as usize, picture.height as usize);
        let Guides { mut albedo, mut normal } = guides;
        for guide in [&albedo, &normal] {
            assert_eq!(guide.len(), picture.rgb.len(), "pixels of a guide");
        }
        let finite = |pixel: &[f32; 3]| match pixel.iter().all(|v| v.is_finite()) {
            true => *pixel,
            false => [0.0; 3],
        };
        let mut color: Vec<_> = picture.rgb.iter().map(finite).collect();
        let mut output = vec![[0.0; 3]; color.len()];
        let device = Device::new(self)?;
        device.filter(size, &mut [(c"albedo", &mut albedo)], None, &[])?;
        device.filter(size, &mut [(c"normal", &mut normal)], None, &[])?;
        let mut images =
            [(c"color", &mut color), (c"albedo", &mut albedo), (c"normal", &mut normal)];
        device.filter(size, &mut images, Some(&mut output), &[c"hdr", c"cleanAux"])?;
        Ok(Picture::new(picture.width, picture.height, output))
    }
}

impl Functions {
    /// # Safety
    /// `library` is Open Image Denoise 2.
    unsafe fn of(library: &Library) -> std::result::Result<Self, libloading::Error> {
        // SAFETY: as the caller says.
        unsafe {
            Ok(Self {
                new_device: *library.get(b"oidnNewDevice\0")?,
                commit_device: *library.get(b"oidnCommitDevice\0")?,
                release_device: *library.get(b"oidnReleaseDevice\0")?,
                device_error: *library.get(b"oidnGetDeviceError\0")?,
                new_filter: *library.get(b"oidnNewFilter\0")?,
                set_image: *library.get(b"oidnSetSharedFilterImage\0")?,
                set_bool: *library.get(b"oidnSetFilterBool\0")?,
                commit_filter: *library.get(b"oidnCommitFilter\0")?,
                execute_filter: *library.get(b"oidnExecuteFilter\0")?,
                release_filter: *library.get(b"oidnReleaseFilter\0")?,
            })
        }
    }
}

/// A device of the library: the processor.
struct Device<'a> {
    oidn: &'a Oidn,
    object: Object,
}

impl<'a> Device<'a> {
    fn new(oidn: &'a Oidn) -> Result<Self> {
        // SAFETY: a device type of the header. A null device is what errors are asked of below.
        let object = unsafe { (oidn.functions.new_device)(CPU) };
        let device = Self { oidn, object };
        device.check()?;
        // SAFETY: the device is there, or the check had failed.
        unsafe { (oidn.functions.commit_device)(object) };
        device.check()?;
        Ok(device)
    }

    /// Runs the filter `RT` over images of `size` pixels, row by row: into `output`, or into the only
    /// image itself.
    fn filter(
        &self,
        (width, height): (usize, usize),
        images: &mut [(&CStr, &mut Vec<[f32; 3]>)],
        output: Option<&mut Vec<[f32; 3]>>,
        switches: &[&CStr],
    ) -> Result<()> {
        let f = &self.oidn.functions;
        let mut last = ptr::null_mut();
        // SAFETY: the device is alive; the filter is released before this ends, and with it what it
        // knows of the images, which are borrowed for as long and have width × height pixels of three
        // floats without gaps (offset and strides of 0 say so).
        unsafe {
            let filter = (f.new_filter)(self.object, c"RT".as_ptr());
            let set = |name: &CStr, pixels: *mut c_void| {
                (f.set_image)(filter, name.as_ptr(), pixels, FLOAT3, width, height, 0, 0, 0);
            };
            for (name, pixels) in images {
                last = pixels.as_mut_ptr().cast();
                set(name, last);
            }
            set(c"output", output.map_or(last, |pixels| pixels.as_mut_ptr().cast()));
            for switch in switches {
                (f.set_bool)(filter, switch.as_ptr(), true);
            }
            (f.commit_filter)(filter);
            (f.execute_filter)(filter);
            (f.release_filter)(filter);
        }
        self.check()
    }

    fn check(&self) -> Result<()> {
        let mut message = ptr::null();
        // SAFETY: the message, if there is one, is the library's until the next call.
        let text = unsafe {
            if (self.oidn.functions.device_error)(self.object, &raw mut message) == NO_ERROR {
                return Ok(());
            }
            match message.is_null() {
                true => "unknown error".into(),
                false => CStr::from_ptr(message).to_string_lossy().into_owned(),
            }
        };
        Err(Error::io(&self.oidn.path, IoError::other(format!("Open Image Denoise: {text}"))))
    }
}

impl Drop for Device<'_> {
    fn drop(&mut self) {
        if !self.object.is_null() {
            // SAFETY: nothing uses it any more.
            unsafe { (self.oidn.functions.release_device)(self.object) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_such_library_is_refused_with_the_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let text = folder.path().join("libOpenImageDenoise.so");
        std::fs::write(&text, b"text").unwrap();
        for path in [text, folder.path().join("missing.so")] {
            let Err(error) = Oidn::load_file(path.clone()) else { panic!("loaded {path:?}") };
            assert_eq!(error.exit_code(), 1);
            let message = error.to_string();
            for word in [path.to_str().unwrap(), "pyoidn", LIBRARY_VARIABLE] {
                assert!(message.contains(word), "{message}");
            }
            assert!(!message.contains('\n'), "{message}");
        }
    }

    /// A library that is there, but another: the C library of every program here.
    #[cfg(target_os = "linux")]
    #[test]
    fn another_library_is_refused() {
        let Err(error) = Oidn::load_file("libc.so.6".into()) else { panic!("loaded") };
        assert!(error.to_string().contains("not version 2"), "{error}");
    }
}
