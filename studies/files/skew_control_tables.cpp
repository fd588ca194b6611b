#include "volcal/studies/files/skew_control_tables.h"

#include <string>

#include "volcal/studies/files/control_words.h"

namespace volcal {

sim::ControlTables klipper_control(std::span<const TableFile> files) {
  sim::ControlSkew skew;
  for (const Words& line : lines_of_words(file_named(files, "skew_correction.cfg").content, " \t=:")) {
    if (line[0] == "xy_skew") skew.xy = std::stod(line.at(1));
    if (line[0] == "xz_skew") skew.xz = std::stod(line.at(1));
    if (line[0] == "yz_skew") skew.yz = std::stod(line.at(1));
  }
  sim::ControlTables tables;
  tables.skews.push_back(skew);
  return tables;
}

sim::ControlTables marlin_control(std::span<const TableFile> files) {
  sim::ControlSkew skew;
  for (const Words& line : lines_of_words(file_named(files, "skew.gcode").content, " \t")) {
    if (line[0] != "M852") continue;
    for (const std::string& word : line) {
      if (word[0] == 'I' || word[0] == 'S') skew.xy = std::stod(word.substr(1));
      if (word[0] == 'J') skew.xz = std::stod(word.substr(1));
      if (word[0] == 'K') skew.yz = std::stod(word.substr(1));
    }
  }
  sim::ControlTables tables;
  tables.skews.push_back(skew);
  return tables;
}

}  // namespace volcal
