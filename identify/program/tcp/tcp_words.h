#pragma once
/// Where tool centre point motion begins and ends in the text of a program.

#include <optional>
#include <string_view>

#include "volcal/identify/program/nc_block.h"

namespace volcal {

inline constexpr std::string_view kTcpLetters = "XYZABC";  ///< of the coordinates that are followed
/// G codes in tenths that begin and end it.
inline constexpr int kTcpOn = 434, kTcpOff = 490;

enum class TcpBegin { ByCode, ByName };  ///< G43.4 H, TRAORI
/// Nothing where a line does not begin tool centre point motion.
std::optional<TcpBegin> tcp_begin(std::string_view line);

enum class TcpName { None, On, Off };  ///< TRAORI, TRAFOOF
/// Throws InputError for transformations that are not followed.
TcpName tcp_name(std::string_view line, const NcPlace& place);

}  // namespace volcal
