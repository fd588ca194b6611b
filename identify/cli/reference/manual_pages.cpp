#include "volcal/identify/cli/reference/manual_pages.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "volcal/identify/cli/command.h"

namespace volcal::cli {
namespace {

constexpr std::size_t kTitleLength = 40;  // of the words that stand beside the name of an option

/// A text as roff shows it letter by letter.
std::string roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '\\':
        escaped += "\\e";
        break;
      case '-':
        escaped += "\\-";
        break;
      case '\'':
        escaped += "\\(aq";
        break;
      case '"':
        escaped += "\\(dq";
        break;
      case '`':
        escaped += "\\(ga";
        break;
      case '^':
        escaped += "\\(ha";
        break;
      case '~':
        escaped += "\\(ti";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// A line of text: one that begins with '.' is no request.
std::string roff_line(const std::string& text) {
  return (text.starts_with('.') ? "\\&" : "") + roff(text) + "\n";
}

/// The same with a line to each sentence, as roff wants them.
std::string roff_sentences(const std::string& text) {
  std::string lines;
  std::size_t start = 0;
  for (std::size_t end = text.find(". "); end != std::string::npos; end = text.find(". ", start)) {
    lines += roff_line(text.substr(start, end + 1 - start));
    start = end + 2;
  }
  return lines + roff_line(text.substr(start));
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string upper_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string section(const std::string& title) { return ".SH " + title + "\n"; }

std::string joined_choices(const OptionEntry& option, const std::string& between) {
  std::string text;
  for (const std::string& choice : option.choices) text += (text.empty() ? "" : between) + choice;
  return text;
}

bool has_many_choices(const OptionEntry& option) { return joined_choices(option, "|").size() > kTitleLength; }

/// With `|` between words that are taken, where they are few, or the kind of the value.
std::string value_text(const OptionEntry& option) {
  if (option.value.empty()) return "";
  return option.choices.empty() || has_many_choices(option) ? italic(option.value)
                                                            : bold(joined_choices(option, "|"));
}

std::string option_title(const OptionEntry& option) {
  std::string title;
  for (const std::string& name : option.names) title += (title.empty() ? "" : ", ") + bold(name);
  const std::string value = value_text(option);
  return value.empty() ? title : title + " " + value;
}

std::string option_remarks(const OptionEntry& option) {
  std::string remarks;
  const auto add = [&remarks](const std::string& remark) {
    remarks += (remarks.empty() ? "" : "; ") + remark;
  };
  if (option.required) add("required");
  if (option.repeated) add("several values may be given");
  if (has_many_choices(option)) add("one of " + joined_choices(option, ", "));
  if (!option.limits.empty()) add(option.limits);
  if (!option.default_value.empty()) add("default " + option.default_value);
  return remarks.empty() ? "" : " (" + remarks + ")";
}

std::string options_section(const CommandEntry& command) {
  std::string text = section("OPTIONS");
  for (const OptionEntry& operand : command.operands)
    text += ".TP\n" + italic(operand.names.front()) + "\n" +
            roff_sentences(operand.help + option_remarks(operand));
  for (const OptionEntry& option : command.options)
    text += ".TP\n" + option_title(option) + "\n" + roff_sentences(option.help + option_remarks(option));
  return text;
}

std::string synopsis(const CommandEntry& command) {
  std::string text = section("SYNOPSIS") + bold(command.name()) + " [" + italic("OPTION") + "]...";
  if (!command.commands.empty()) text += " " + italic("COMMAND") + " ...";
  for (const OptionEntry& operand : command.operands) {
    const std::string name = italic(operand.names.front()) + (operand.repeated ? "..." : "");
    text += operand.required ? " " + name : " [" + name + "]";
  }
  return text + "\n";
}

std::string commands_section(const CommandEntry& command) {
  std::string text = section("COMMANDS");
  for (const CommandEntry& sub : command.commands)
    text += ".TP\n.BR " + roff(sub.name('-')) + " (1)\n" + roff_sentences(sub.summary);
  return text;
}

std::string examples_section(const CommandEntry& command) {
  std::string text = section("EXAMPLES") + ".nf\n";
  for (const std::string& line : command.examples)
    text += roff_line(line.substr(std::min(line.find_first_not_of(' '), line.size())));
  return text + ".fi\n";
}

std::string exit_status_section() {
  std::string text = section("EXIT STATUS");
  const auto add = [&text](int code, const char* meaning) {
    text += ".TP\n" + bold(std::to_string(code)) + "\n" + roff_line(meaning);
  };
  add(kDone, "done");
  add(kIncomplete, "ran, but not converged, rank-deficient, or a limit that was given is exceeded");
  add(kBadInput, "bad input or usage; standard error says what, where, and what to do");
  return text;
}

std::string environment_section() {
  return section("ENVIRONMENT") + ".TP\n" + bold("SOURCE_DATE_EPOCH") + "\n" +
         roff_line("seconds since 1970: the date that files state in place of the present one");
}

/// Parent and children; of the program, whose section COMMANDS names all, none.
std::string see_also_section(const CommandEntry& program, const CommandEntry& command) {
  std::vector<const CommandEntry*> pages;
  for (const CommandEntry* other : all_commands(program)) {
    const bool parent =
        other != &command && (other->path.empty() || command.path.starts_with(other->path + " "));
    if (parent) pages.push_back(other);
  }
  std::string text;
  for (std::size_t i = 0; i < pages.size(); ++i)
    text += ".BR " + roff(pages[i]->name('-')) + " (1)" + (i + 1 < pages.size() ? " ,\n" : "\n");
  return text.empty() ? "" : section("SEE ALSO") + text;
}

}  // namespace

std::string manual_page(const CommandEntry& program, const CommandEntry& command, const std::string& date) {
  std::string text = ".TH " + upper_case(command.name('-')) + " 1 " + date + " \"volcal " + VOLCAL_VERSION +
                     "\" \"volcal manual\"\n.nh\n.ad l\n";
  text += section("NAME") + roff(command.name('-')) + " \\- " + roff(command.summary) + "\n";
  text += synopsis(command);
  text += section("DESCRIPTION") +
          roff_sentences(upper_case(command.summary.substr(0, 1)) + command.summary.substr(1) + ".");
  if (command.path.empty())
    text += ".PP\n" + roff_line("Every command has a page of its own, and knows --help.");
  if (!command.commands.empty()) text += commands_section(command);
  text += options_section(command);
  text += exit_status_section();
  text += environment_section();
  if (!command.examples.empty()) text += examples_section(command);
  return text + see_also_section(program, command);
}

}  // namespace volcal::cli
