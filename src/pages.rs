//! Tables in large pages. A photon or a ray comes to places all over a tree; in pages of 4 KB most of them cost a
//! walk through the page tables besides, on virtual machines two. Trees of 40 000 and 170 000 triangles were
//! measured between a sixteenth and a third faster in pages of 2 MB, on a busy machine.

use rayon::prelude::*;
use std::ops::{Index, IndexMut};

/// Bytes of a large page.
const LARGE: usize = 2 << 20;

/// A table that does not grow.
#[derive(Clone, Debug)]
pub(crate) struct Table<T> {
    /// Fillers up to the first large page, then the table.
    all: Vec<T>,
    first: usize,
}

impl<T> Default for Table<T> {
    fn default() -> Self {
        Self {
            all: Vec::new(),
            first: 0,
        }
    }
}

impl<T: Clone> Table<T> {
    pub(crate) fn new(entries: Vec<T>) -> Self {
        let Some(filler) = entries.first().cloned() else {
            return Self::default();
        };
        Self::filled(entries.len(), &filler, |all| all.extend(entries))
    }

    /// Entries made in their places, on several threads.
    ///
    /// * `filler`: any entry.
    pub(crate) fn collect(filler: &T, entries: impl IndexedParallelIterator<Item = T>) -> Self
    where
        T: Send,
    {
        Self::filled(entries.len(), filler, |all| all.par_extend(entries))
    }

    /// Entries put in by `fill`, `count` of them, behind fillers that are there already.
    fn filled(count: usize, filler: &T, fill: impl FnOnce(&mut Vec<T>)) -> Self {
        let each = size_of::<T>();
        // A tree's nodes are fewer than its leaves and read more often: a table a fifth of a large page long gains a
        // thirtieth of a walk; much shorter ones would take more memory than they hold.
        if each * count < LARGE / 16 {
            let mut all = Vec::with_capacity(count);
            fill(&mut all);
            return Self { all, first: 0 };
        }
        // Room for the last page too to be whole.
        let mut all: Vec<T> = Vec::with_capacity(count + 2 * LARGE / each + 1);
        let begin = all.as_ptr().addr();
        let bytes = each * all.capacity();
        let first = (begin.next_multiple_of(LARGE) - begin).div_ceil(each);
        ask_for_large_pages(all.as_mut_ptr().cast(), bytes);
        all.resize(first, filler.clone());
        fill(&mut all);
        Self { all, first }
    }
}

impl<T> Table<T> {
    pub(crate) fn len(&self) -> usize {
        self.all.len() - self.first
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All entries.
    pub(crate) fn entries(&self) -> &[T] {
        &self.all[self.first..]
    }

    pub(crate) fn entries_mut(&mut self) -> &mut [T] {
        &mut self.all[self.first..]
    }
}

/// Bytes of a line of a cache.
const LINE: usize = 64;

impl<T> Table<T> {
    /// As [`fetch`].
    #[inline(always)]
    pub(crate) fn fetch(&self, index: usize) {
        fetch(&self[index]);
    }

    #[inline(always)]
    pub(crate) fn place(&self) -> Place {
        Place {
            begin: self.entries().as_ptr().cast(),
            each: size_of::<T>(),
        }
    }
}

/// Where a table lies, whatever it holds: to have an entry of one of several fetched without a branch.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    begin: *const i8,
    /// Bytes of an entry.
    each: usize,
}

impl Place {
    /// Has the first lines of an entry, or what lies in their place, brought into the nearest cache.
    #[inline(always)]
    pub(crate) fn fetch<const LINES: usize>(self, index: usize) {
        let entry = self.begin.wrapping_add(self.each.wrapping_mul(index));
        for line in 0..LINES {
            fetch_line(entry.wrapping_add(LINE * line));
        }
    }
}

/// Has an entry brought into the nearest cache, without waiting for it. Rays that scatter in fur were
/// measured a tenth to a third faster by it.
#[inline(always)]
pub(crate) fn fetch<T>(entry: &T) {
    let entry: *const i8 = (&raw const *entry).cast();
    for line in (0..size_of::<T>()).step_by(LINE) {
        fetch_line(entry.wrapping_add(line));
    }
}

#[inline(always)]
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "there is no safe call for it")]
fn fetch_line(line: *const i8) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: a hint reads nothing, wherever it points, and every x86-64 has it.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(line) };
}

/// Does nothing where there is no way to ask.
#[cfg(not(target_arch = "x86_64"))]
fn fetch_line(_line: *const i8) {}

impl<T> Index<usize> for Table<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, index: usize) -> &T {
        &self.all[self.first + index]
    }
}

impl<T> IndexMut<usize> for Table<T> {
    fn index_mut(&mut self, index: usize) -> &mut T {
        &mut self.all[self.first + index]
    }
}

/// Gives memory that was freed in small pieces back to the system, which the allocator keeps else: a quarter of what
/// five million strands take while their tree is built.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code, reason = "there is no safe call for it")]
pub(crate) fn give_back() {
    // SAFETY: touches nothing but what is free, and may be called at any time from any thread.
    unsafe { libc::malloc_trim(0) };
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(crate) fn give_back() {}

/// Advice that the system may follow or not; contents stay what they are.
#[cfg(target_os = "linux")]
#[allow(unsafe_code, reason = "there is no safe call for it")]
fn ask_for_large_pages(begin: *mut u8, bytes: usize) {
    let skip = begin.addr().next_multiple_of(LARGE) - begin.addr();
    let whole = bytes.saturating_sub(skip) / LARGE * LARGE;
    if whole > 0 {
        // SAFETY: the range lies within an allocation that the caller owns, and this advice changes
        // neither what it holds nor who may use it. A refusal does no harm.
        unsafe {
            libc::madvise(begin.wrapping_add(skip).cast(), whole, libc::MADV_HUGEPAGE);
        }
    }
}

#[cfg(not(target_os = "linux"))]
fn ask_for_large_pages(_begin: *mut u8, _bytes: usize) {}
