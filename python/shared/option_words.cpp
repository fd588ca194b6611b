#include "volcal/python/shared/option_words.h"

#include <algorithm>
#include <array>
#include <regex>
#include <string_view>
#include <utility>

namespace volcal::python {
namespace {

/// Options whose values are written otherwise, before the others.
const std::array<std::pair<std::regex, const char*>, 15>& phrases() {
  static const std::array<std::pair<std::regex, const char*>, 15> phrases = {{
      {std::regex(R"(volcal diagnose --list prints)"), "volcal.effect_kinds() has"},
      {std::regex(R"(volcal budget MACHINE\.toml --tolerances FILE)"), "budget(machine, tolerances=FILE)"},
      {std::regex(R"(--work-offset (G[0-9.]+)=X\.\.\.,Y\.\.\.,Z\.\.\. in mm)"),
       "work_offsets={\"$1\": (x, y, z)}, mm"},
      {std::regex(R"(--tool-length H([0-9]+)=LENGTH in mm)"), "tool_lengths={$1: LENGTH}, mm"},
      {std::regex(R"(--block-delete on \(skip\) or off \(run\))"),
       "block_delete=True (skip) or block_delete=False (run)"},
      {std::regex(R"(--units mm or inch)"), "units=\"mm\" or units=\"inch\""},
      {std::regex(R"(--readings N, --time HOURS or both)"), "readings, time_h or both"},
      {std::regex(R"(--parameter ([a-z]=[0-9+-]+)( |$))"), "parameters=[\"$1\"]$2"},
      {std::regex(R"(--set ([a-z_]+)=([a-z0-9]+))"), "settings={\"$1\": \"$2\"}"},
      {std::regex(R"(--format ([a-z]+(-[a-z]+)*))"), "format=\"$1\""},
      {std::regex(R"(\(--list says how\))"), "(volcal tables --list says how)"},
      {std::regex(R"(, or overwrite it with --force|; --force overwrites files of the same names)"), ""},
      {std::regex(R"(another folder with -o)"), "another folder"},
      {std::regex(R"(\(--verbose\))"), "(Result.findings has all)"},
      {std::regex(R"(hold lines out: volcal compare --held-out)"), "hold lines out: compare(held_out=True)"},
  }};
  return phrases;
}

constexpr std::array kArguments = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"arc-tolerance-um", "arc_tolerance_um"},
    {"bar-mm", "bar_mm"},
    {"bar-sigma-um", "bar_sigma_um"},
    {"block-delete", "block_delete"},
    {"campaign", "campaign"},
    {"conditions", "conditions"},
    {"decimals", "decimals"},
    {"disturb", "disturb"},
    {"extend", "extend"},
    {"format", "format"},
    {"formula", "formula"},
    {"grid", "grid"},
    {"instrument", "instrument"},
    {"model", "model"},
    {"no-extrapolation", "within_readings"},
    {"origin", "origin"},
    {"parameter", "parameters"},
    {"positions", "positions"},
    {"primary", "primary"},
    {"readings", "readings"},
    {"record", "record"},
    {"rotary-step", "rotary_step_deg"},
    {"secondary", "secondary"},
    {"set", "settings"},
    {"start", "start"},
    {"stations", "stations"},
    {"step", "step_mm"},
    {"time", "time_h"},
    {"tolerance", "tolerance_um"},
    {"tolerance-um", "tolerance_um"},
    {"tolerances", "tolerances"},
    {"tool", "tool"},
    {"tool-length", "tool_lengths"},
    {"tools", "tools"},
    {"type", "type"},
    {"units", "units"},
    {"work-offset", "work_offsets"},
});

/// An option, or a line of the command line with its options, to the end of a part of the sentence. Not what
/// stands within a word, as in the name of a file.
const std::regex& options() {
  static const std::regex options(R"(volcal [a-z]+[^;,)]*|\B--([a-z]+(-[a-z]+)*))");
  return options;
}

std::string argument_of(const std::smatch& found) {
  const auto argument = std::ranges::find(kArguments, std::string_view(found[1].str()),
                                          &std::pair<std::string_view, std::string_view>::first);
  return argument == kArguments.end() ? found.str() : std::string(argument->second);
}

}  // namespace

std::string argument_of_setting(const std::string& name) {
  const auto argument = std::ranges::find(kArguments, std::string_view(name),
                                          &std::pair<std::string_view, std::string_view>::first);
  return argument == kArguments.end() ? "--" + name : std::string(argument->second);
}

std::string with_arguments(const std::string& message) {
  if (message.find('-') == std::string::npos) return message;
  std::string text = message;
  for (const auto& [option, argument] : phrases()) text = std::regex_replace(text, option, argument);
  std::string replaced;
  auto from = text.cbegin();
  for (std::sregex_iterator each(text.cbegin(), text.cend(), options()), end; each != end; ++each) {
    const std::smatch& found = *each;
    replaced.append(from, text.cbegin() + found.position()).append(argument_of(found));
    from = text.cbegin() + found.position() + found.length();
  }
  return replaced.append(from, text.cend());
}

}  // namespace volcal::python
