#pragma once
/// Which kernels OpenBLAS works with.

#include <optional>
#include <string>

namespace volcal {

/// Processor for which OpenBLAS has chosen its kernels, "SkylakeX"; empty with another library.
std::string blas_core();

/// What OPENBLAS_CORETYPE has to be when a program starts, where OpenBLAS does not know the processor and
/// takes it for one of 2004 ("Prescott", without AVX), as Debian 12's 0.3.21 does with Intel's of 2023 and
/// later: the kernels for the widest vectors that it has. Nothing where it has chosen by itself, or was told
/// by that variable.
std::optional<std::string> better_blas_core();

}  // namespace volcal
