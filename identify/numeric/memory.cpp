#include "volcal/identify/numeric/memory.h"

#include <cstdlib>  // __GLIBC__

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace volcal {

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kKept = 256 << 20;             // bytes
  constexpr int kLargestOfTheHeap = 32 << 20;  // bytes; the most that glibc allows
  mallopt(M_TRIM_THRESHOLD, kKept);
  mallopt(M_MMAP_THRESHOLD, kLargestOfTheHeap);
#endif
}

}  // namespace volcal
