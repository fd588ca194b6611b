#pragma once
/// What the program arranges with the system, so that it ends with a sentence and an exit code under any
/// limit.

#include <string>

namespace volcal::cli {

/// First of all, since OpenBLAS reads its variable when it is loaded: where it does not know the processor,
/// the program starts again with the kernels that the processor has (blas_core.h).
void start_with_better_kernels(char** arguments);

/// Once, at the beginning of main(): standard streams that are closed cannot be taken by a file of the
/// result; a limit of file sizes (ulimit -f) becomes an error of writing; at an interruption (SIGINT,
/// SIGTERM, SIGHUP) and at the end of the processor time (ulimit -t) temporary files are removed and the
/// program says what there is.
void prepare_process();

/// Does not return when the program is being interrupted: its last words are said already.
void stay_if_interrupted();

/// What the program is doing, for messages; empty at first.
void set_current_work(const std::string& work);
std::string current_work();

/// For std::bad_alloc: what memory was wanted for, and what to reduce.
std::string out_of_memory_message();

}  // namespace volcal::cli
