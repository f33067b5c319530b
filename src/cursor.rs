//! A place in the bytes of a file, from which numbers are read.

/// Something wrong in the bytes of a file.
#[derive(Debug)]
pub(crate) struct Misread {
    /// Where.
    pub(crate) at: u64,
    /// What is wrong there.
    pub(crate) reason: String,
}

/// Reads little-endian numbers one after the other; never past the end.
#[derive(Clone)]
pub(crate) struct Cursor<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Cursor<'b> {
    /// From a place on, which may be beyond the end: then nothing can be read.
    pub(crate) fn new(bytes: &'b [u8], at: u64) -> Self {
        Self {
            bytes,
            at: usize::try_from(at).unwrap_or(usize::MAX).min(bytes.len()),
        }
    }

    pub(crate) fn at(&self) -> u64 {
        self.at as u64
    }

    pub(crate) fn error(&self, reason: impl Into<String>) -> Misread {
        Misread {
            at: self.at(),
            reason: reason.into(),
        }
    }

    pub(crate) fn take(&mut self, count: u64) -> Result<&'b [u8], Misread> {
        let rest = &self.bytes[self.at..];
        let count = usize::try_from(count).ok().filter(|&n| n <= rest.len());
        let count = count.ok_or_else(|| self.error("the file ends too early"))?;
        self.at += count;
        Ok(&rest[..count])
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N], Misread> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N as u64)?);
        Ok(out)
    }

    pub(crate) fn u8(&mut self) -> Result<u8, Misread> {
        Ok(self.array::<1>()?[0])
    }

    pub(crate) fn u16(&mut self) -> Result<u16, Misread> {
        self.array().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, Misread> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, Misread> {
        self.array().map(u64::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Result<f64, Misread> {
        self.array().map(f64::from_le_bytes)
    }

    pub(crate) fn ivec(&mut self) -> Result<glam::IVec3, Misread> {
        let mut axis = || self.u32().map(|v| v as i32);
        Ok(glam::IVec3::new(axis()?, axis()?, axis()?))
    }

    /// Text with its length before it.
    pub(crate) fn text(&mut self) -> Result<String, Misread> {
        let length = self.u32()?;
        let text = self.take(u64::from(length))?;
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    /// A number of things of at least `size` bytes each that follow.
    pub(crate) fn count(&mut self, size: u64) -> Result<u64, Misread> {
        let count = self.u64()?;
        let room = (self.bytes.len() - self.at) as u64;
        match count.checked_mul(size).is_some_and(|bytes| bytes <= room) {
            true => Ok(count),
            false => Err(self.error(format!(
                "{count} things announced, more than the file holds"
            ))),
        }
    }
}
