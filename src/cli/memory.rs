//! Memory for commands that use much of it at once.

/// Lets the allocator of glibc take memory in large pieces and keep it: the system then gives pages of 2 MB
/// where it has them, and gives them once. Otherwise each array of more than 128 kB is mapped by itself, in pages of
/// 4 kB, and given back after use. No effect elsewhere.
pub(super) fn take_in_large_pieces() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    glibc::tune();
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(
    unsafe_code,
    reason = "a first table comes a fifth sooner; there is no safe way to tune the allocator"
)]
mod glibc {
    /// Below this size arrays come from the heap: the most that glibc allows. The sums of a node and the maps of
    /// a table are smaller.
    const MAPPED: i32 = 32 << 20;
    /// The heap grows by so much: many large pages.
    const PIECE: i32 = 64 << 20;

    pub(super) fn tune() {
        // SAFETY: sets numbers of the allocator, under its own lock; each is within its range, and one that is
        // refused changes nothing.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, MAPPED);
            libc::mallopt(libc::M_TRIM_THRESHOLD, i32::MAX);
            libc::mallopt(libc::M_TOP_PAD, PIECE);
        }
    }
}
