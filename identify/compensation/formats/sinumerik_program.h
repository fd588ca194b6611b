#pragma once
/// Assignments of SINUMERIK compensation files: $NAME[index,index]=value lines between a %_N_ header and M17.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/text/table_text.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

struct SinumerikAssignment {
  std::string variable;              ///< "$AA_ENC_COMP_STEP"
  std::vector<std::string> indices;  ///< "0", "X1"
  std::string value;                 ///< as written, brackets and quotes left out
  SourcePlace place;
};

/// Reads a program. Comments (;) and N numbers are skipped. Throws InputError for another header, a line that
/// is no assignment, a variable assigned twice, a program that assigns nothing or does not end in M17.
std::vector<SinumerikAssignment> sinumerik_assignments(const TableFile& file, std::string_view header);

/// Throws InputError at the assignment.
double sinumerik_number(const SinumerikAssignment& assignment);
int sinumerik_index(const SinumerikAssignment& assignment, std::size_t index);

/// X1, Y1, Z1, A1, B1, C1: machine axes.
std::string sinumerik_axis_name(char letter);
/// Throws InputError at `place`.
AxisName sinumerik_axis(std::string_view name, const SourcePlace& place);
/// The same of a linear axis.
AxisName sinumerik_linear_axis(std::string_view name, const SourcePlace& place);

/// Values of a table by their number, m or rad, and where they stand.
struct SinumerikValues {
  std::map<int, double> value;
  std::optional<double> low, high, step;  ///< MIN, MAX, STEP, m or rad
  bool is_modulo = false;                 ///< IS_MODULO
  SourcePlace place;
};
/// Positions of the values. Throws InputError unless they are numbered from 0 and reach from MIN to MAX,
/// which must be given.
std::vector<double> sinumerik_positions(const SinumerikValues& values);

}  // namespace volcal
