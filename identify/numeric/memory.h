#pragma once
/// Memory between one adjustment and the next.

namespace volcal {

/// For programs that adjust again and again: memory that an adjustment frees is kept for the next one, up to
/// some 256 MiB, instead of being given back to the system page by page, where the C library can be told so
/// (glibc). Called once, before threads start.
void keep_freed_memory();

}  // namespace volcal
