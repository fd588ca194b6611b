#pragma once
/// Files as instruments write them, made from their public description, and what is said of them.

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/import/import_format.h"

namespace volcal::testing {

inline const char* const kImportMachine =
    "format = \"volcal-machine-1\"\nstructure = \"w X' b Y Z t\"\n"
    "[axes.X]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n"
    "[axes.Y]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n"
    "[axes.Z]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n"
    "[tools.probe]\noffset_mm = [0.0, 0.0, 0.0]\n";

inline const Machine& import_machine() {
  static const Machine machine = parse_machine(kImportMachine, "machine.toml");
  return machine;
}

struct SampleImport {
  std::string name;
  std::string bytes;
  std::string format;
  ImportAnswers answers;
  std::size_t readings = 0;
  std::string nominal = {};  ///< content of the file of commanded positions
};

inline std::string with_line_ends(const std::string& text, const std::string& end) {
  std::string out;
  for (const char c : text) out += c == '\n' ? end : std::string(1, c);
  return out;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// Four runs over 0, 100, 200 mm. By hand (ISO 230-2), in um: forward means 1, 3, 5, backward means -2, 0, 2,
/// every s = sqrt(2); B = 3, E = 7, M = 4, A = 7 + 4 sqrt(2), R = 4 sqrt(2) + 3.
inline const char* const kRtlHead =
    "HEADER::\nFile type  : rtl\nOwner      : Linear\nVersion no : V20.02.02\n\n"
    "TARGET DATA::\nFiletype  : ISO\nTarget-count: 3\nTargets :\n0.000  100.000 \n 200.000 \nFlags: 0 0 2 "
    "0\n\n"
    "USER-TEXT::\nMachine: VMC 7\nSerial No: 4711\nDate: 2024-05-06 10:20:30\nBy: NN\nAxis: X\nLocation: "
    "hall 2\n\n";
inline const char* const kRtlRuns =
    "RUNS::\nRun-count: 4\n\nDEVIATIONS::\nRun Target Data:\n"
    "1   1      0.0\n1   2      2.0\n1   3      4.0\n"
    "2   3      1.0\n2   2      -1.0\n2   1      -3.0\n"
    "3   1      2.0\n3   2      4.0\n3   3      6.0\n"
    "4   3      3.0\n4   2      1.0\n4   1      -1.0\n\n";
inline const char* const kRtlTail =
    "ENVIRONMENT::\nAir temp   : 21.50\nAir Press  : 1013.2\nAir Humid  : 45\nMat temp 1 : 20.80\nMat temp 2 "
    ": 0.00\n"
    "Exp coeff  : 11.7\n\nEQUIPMENT::\nLaser: 0815\n\nEOF::\n\n";
inline std::string rtl_text() { return std::string(kRtlHead) + kRtlRuns + kRtlTail; }
/// The same runs, each sorted by target.
inline std::string sorted_rtl_text() {
  return replaced(replaced(rtl_text(), "2   3      1.0\n2   2      -1.0\n2   1      -3.0\n",
                           "2   1      -3.0\n2   2      -1.0\n2   3      1.0\n"),
                  "4   3      3.0\n4   2      1.0\n4   1      -1.0\n",
                  "4   1      -1.0\n4   2      1.0\n4   3      3.0\n");
}

inline ImportAnswers rtl_answers() {
  ImportAnswers answers;
  answers.unit = "um";
  answers.at = {{AxisName::Y, 250.0}, {AxisName::Z, 150.0}};
  return answers;
}

/// Points of a square of 200 mm, and one above it, in the frame of a tracker that stands at (-1000, 300, 50)
/// mm with its x along the machine's y: p_s = (y', -x', z') of p_w - t. `stretch_mm`: corners lie that much
/// further out along x and y each.
inline std::vector<Eigen::Vector3d> tracker_points_mm(double stretch_mm) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& corner :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(200, 0, 0), Eigen::Vector3d(200, 200, 0),
        Eigen::Vector3d(0, 200, 0), Eigen::Vector3d(100, 100, 100)}) {
    Eigen::Vector3d p = corner;
    for (int k = 0; k < 2; ++k) p[k] += stretch_mm * (corner[k] - 100.0) / 100.0;
    p -= Eigen::Vector3d(-1000, 300, 50);
    points.emplace_back(p.y(), -p.x(), p.z());
  }
  return points;
}
inline const char* const kNominalPoints =
    "name,x_mm,y_mm,z_mm\nP1,0,0,0\nP2,200,0,0\nP3,200,200,0\nP4,0,200,0\nP5,100,100,100\n";

inline std::string cartesian_list(double stretch_mm) {
  std::string text = "// exported points\n// Units: Millimeters\n";
  int number = 0;
  for (const Eigen::Vector3d& p : tracker_points_mm(stretch_mm))
    text += fmt::format("A, cloud, P{}, {:.7f}, {:.7f}, {:.7f}\n", ++number, p.x(), p.y(), p.z());
  return text;
}

/// `turns`: units of a full turn; horizontal angle clockwise, vertical angle from the zenith, length in m.
inline std::string polar_list(const std::string& header, double turns, const std::string& delimiter) {
  std::string text = header + "\n";
  int number = 0;
  for (const Eigen::Vector3d& p : tracker_points_mm(0.0)) {
    const double turn = 2.0 * std::numbers::pi;
    double hz = -std::atan2(p.y(), p.x()) / turn * turns;
    if (hz < 0.0) hz += turns;
    const double zenith = std::atan2(std::hypot(p.x(), p.y()), p.z()) / turn * turns;
    text += fmt::format("P{1}{0}{2:.10f}{0}{3:.10f}{0}{4:.10f}\n", delimiter, ++number, hz, zenith,
                        p.norm() * 1e-3);
  }
  return text;
}

inline std::string utf16(const std::string& ascii) {
  std::string bytes = "\xFF\xFE";
  for (const char c : ascii) bytes += std::string{c, '\0'};
  return bytes;
}

inline std::vector<SampleImport> sample_lasers() {
  std::vector<SampleImport> all;
  const auto add = [&](const std::string& name, const std::string& bytes,
                       std::size_t readings) -> ImportAnswers& {
    all.push_back({name, bytes, "rtl", rtl_answers(), readings});
    return all.back().answers;
  };
  add("crlf.rtl", with_line_ends(rtl_text(), "\r\n"), 12);
  add("mark.rtl", "\xEF\xBB\xBF" + replaced(rtl_text(), "By: NN", "By: M\u00FCller"), 12);
  add("cp1252.rtl", replaced(rtl_text(), "By: NN", "By: M\xFCller"), 12).encoding = TextEncoding::Cp1252;
  add("gbk.rtl", replaced(rtl_text(), "VMC 7", "\xBB\xFA\xB4\xB2 7"), 12).encoding = TextEncoding::Gbk;
  add("comma.rtl", replaced(rtl_text(), ".", ","), 12);
  add("sorted.rtl", sorted_rtl_text(), 12).runs = "alternating";
  add("no-environment.rtl", std::string(kRtlHead) + kRtlRuns, 12);
  add("there-and-back.rtl",
      replaced(replaced(replaced(replaced(rtl_text(), "\n2   ", "\n1   "), "\n3   ", "\n2   "), "\n4   ",
                        "\n2   "),
               "Run-count: 4", "Run-count: 2"),
      12);
  add("one-run.rtl",
      std::string(kRtlHead) +
          "RUNS::\nRun-count: 1\nDEVIATIONS::\nRun Target Data:\n1 1 0.1\n1 2 0.2\n1 3 -0.3\n",
      3)
      .runs = "forward";
  add("falling.rtl", replaced(replaced(rtl_text(), "0.000  100", "200.000  100"), "\n 200.000", "\n 0.000"),
      12);
  ImportAnswers& angular = add("angular.rtl", replaced(rtl_text(), ": Linear", ": Angular"), 12);
  angular.unit = "arcsec";
  angular.measures = "ECX";
  add("straightness.rtl", replaced(replaced(rtl_text(), ": Linear", ": Straightness"), ": rtl", ": rts"), 12)
      .measures = "EYX";
  add("utf16.rtl", utf16(with_line_ends(rtl_text(), "\r\n")), 12);
  return all;
}

inline std::vector<SampleImport> sample_point_lists() {
  std::vector<SampleImport> all;
  const auto add = [&](const std::string& name, const std::string& bytes) -> ImportAnswers& {
    all.push_back({name, bytes, "tracker", {}, 5, kNominalPoints});
    return all.back().answers;
  };
  add("cartesian.txt", cartesian_list(0.0)).columns = "x,y,z";
  ImportAnswers& gon =
      add("gon.txt", replaced(polar_list("Point\tHz [gon]\tV [gon]\tSD [m]", 400.0, "\t"), ".", ","));
  gon.horizontal = "clockwise";
  gon.vertical = "zenith";
  ImportAnswers& degrees =
      add("deg.txt", "// Units: Meters, Degrees\n" + polar_list("Name;Hz;Zenith;Distance", 360.0, ";"));
  degrees.horizontal = "clockwise";
  return all;
}

inline std::vector<SampleImport> sample_tables() {
  std::vector<SampleImport> all;
  const auto add = [&](const std::string& name, const std::string& bytes) -> ImportAnswers& {
    all.push_back({name, bytes, "csv", {}, 3});
    all.back().answers.at = {{AxisName::Y, 250.0}, {AxisName::Z, 150.0}};
    all.back().answers.instrument = "displacement";
    all.back().answers.keys["direction"] = "[1, 0, 0]";
    return all.back().answers;
  };
  add("semicolon.csv", "Soll X [mm];Abweichung [\u00B5m];Richtung\n0,0;-1,5;1\n100,0;2,25;1\n200,0;3,0;1\n");
  add("tabs.csv",
      "report of a test\nPosition X (mm)\tDeviation "
      "(mm)\tcomment\n0.0\t0.001\tok\n100.0\t0.002\tok\n200.0\t0.003\tok\n");
  add("units-row.csv", "Target,Error,Time\n[mm],[nm],[min]\n0,1500,0\n100,2500,1\n200,-500,2\n").axis = "X";
  add("standard.csv", "x_mm,dir_x,deviation_um\n0,1,1\n100,1,2\n200,1,3\n");
  return all;
}

inline std::vector<SampleImport> sample_imports() {
  std::vector<SampleImport> all = sample_lasers();
  for (const auto& more : {sample_point_lists(), sample_tables()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace volcal::testing
