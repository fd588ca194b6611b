#pragma once
/// Cosines and sines of many angles at once, in loops that become vector instructions.

#include <cstddef>

namespace volcal {

/// Writes cosine and sine of `count` angles, rad; each within 4e-16 of its value, the same to the bit for
/// every instruction set. Angles beyond 1e6 rad, or not finite, are left to the C library. The angle less a
/// multiple of pi/2 in three parts (Cody and Waite 1980, Software Manual for the Elementary Functions, ch.
/// 8), polynomials of fdlibm's k_sin.c and k_cos.c.
void write_cosines_and_sines(const double* angle, std::size_t count, double* cosine, double* sine);

}  // namespace volcal
