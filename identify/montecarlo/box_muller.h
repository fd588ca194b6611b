#pragma once
/// Normal numbers from uniform ones, many at a time, the same to the bit on every processor: polynomials in
/// plain double arithmetic instead of the library's functions, whose vector forms differ between
/// instruction sets.

#include <cstddef>

namespace volcal {

/// Box and Muller (1958), Annals of Mathematical Statistics 29, 610: first[i] and second[i], in (0, 1],
/// become sqrt(-2 log first) times the cosine and the sine of 2 pi second, to about 1e-15 of the radius.
void box_muller(std::size_t count, double* first, double* second);

}  // namespace volcal
