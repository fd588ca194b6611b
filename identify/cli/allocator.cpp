/// How jemalloc serves the program (jemalloc(3), TUNING), where it is linked with it: matrices of a hundred
/// megabytes come and go in an adjustment, and giving their pages back and fetching them again, 4 KiB at a
/// time, took half of a diagnosis of 100,000 readings. So pages are large and stay with the program, in one
/// arena: threads live for one piece of work, and an arena of their own would have to be filled anew.

// NOLINTNEXTLINE(*-avoid-non-const-global-variables): the name and type that jemalloc looks for
extern "C" {
extern const char* malloc_conf;
const char* malloc_conf = "thp:always,narenas:1,dirty_decay_ms:-1,muzzy_decay_ms:-1";
}
