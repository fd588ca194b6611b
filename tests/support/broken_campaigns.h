#pragma once
/// Campaigns that must be refused: each is the small good campaign of tests/data/small with one thing broken,
/// and says which file and line the message must name, what is wrong and what to do. Used against the readers
/// (tests/io) and as text against the program (tests/cli).

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace volcal::testing {

enum class Edit { Replace, Content, Prepend, Remove, MakeDirectory, MakePipe };

struct BrokenCampaign {
  std::string name;  ///< letters and digits: also the name of the test
  std::string file;  ///< which file is broken
  Edit edit;
  std::string find;     ///< for Replace: must occur once
  std::string text;     ///< replacement or content
  std::string place;    ///< file named by the message
  int line;             ///< line named by the message; 0 = the whole file
  std::string problem;  ///< part of the message
  std::string remedy;   ///< part of the message
};

/// Google Test prints this beside a failure.
inline void PrintTo(const BrokenCampaign& broken, std::ostream* out) { *out << broken.name; }

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void spill(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// Applies the edit to a copy of the good campaign in `folder`.
inline void break_campaign(const BrokenCampaign& broken, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / broken.file;
  switch (broken.edit) {
    case Edit::Replace: {
      std::string content = slurp(path);
      const auto at = content.find(broken.find);
      if (at == std::string::npos || content.find(broken.find, at + 1) != std::string::npos) {
        throw std::logic_error(broken.name + ": \"" + broken.find + "\" does not occur once");
      }
      spill(path, content.replace(at, broken.find.size(), broken.text));
      return;
    }
    case Edit::Content:
      spill(path, broken.text);
      return;
    case Edit::Prepend:
      spill(path, broken.text + slurp(path));
      return;
    case Edit::Remove:
      std::filesystem::remove(path);
      return;
    case Edit::MakeDirectory:
      std::filesystem::remove(path);
      std::filesystem::create_directory(path);
      return;
    case Edit::MakePipe:  // that nobody writes to: opening it waits for ever
      std::filesystem::remove(path);
      if (::mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error(broken.name + ": mkfifo failed");
      return;
  }
}

inline const std::vector<BrokenCampaign>& broken_campaigns() {
  using enum Edit;
  using namespace std::string_literals;
  static const std::vector<BrokenCampaign> all = {
      // Files
      {"CampaignMissing", "campaign.toml", Remove, "", "", "campaign.toml", 0, "does not exist", "relative"},
      {"CampaignIsADirectory", "campaign.toml", MakeDirectory, "", "", "campaign.toml", 0, "is a directory",
       "name the file inside"},
      {"CampaignIsAPipe", "campaign.toml", MakePipe, "", "", "campaign.toml", 0, "is a pipe",
       "save what it gives to a file"},
      {"CampaignEmpty", "campaign.toml", Content, "", "", "campaign.toml", 0, "the file is empty",
       "name another file"},
      {"CampaignBinary", "campaign.toml", Content, "", "format\0\1\2"s, "campaign.toml", 1, "binary",
       "text file"},
      {"CampaignIsAMachine", "campaign.toml", Replace, "volcal-campaign-1", "volcal-machine-1",
       "campaign.toml", 1, "format is \"volcal-machine-1\"", "another kind of file"},
      {"CampaignOfAnotherVersion", "campaign.toml", Replace, "volcal-campaign-1", "volcal-campaign-9",
       "campaign.toml", 1, "format is \"volcal-campaign-9\"", "another version"},
      {"FormatMissing", "campaign.toml", Replace, "format = \"volcal-campaign-1\"\n", "", "campaign.toml", 0,
       "key format is missing", "add format = \"volcal-campaign-1\""},
      {"MachineMissing", "machine.toml", Remove, "", "", "campaign.toml", 2, "does not exist",
       "relative to that file"},
      {"MachineIsAPipe", "machine.toml", MakePipe, "", "", "campaign.toml", 2, "is a pipe",
       "save what it gives to a file"},
      {"DataMissing", "S2.csv", Remove, "", "", "campaign.toml", 20, "does not exist",
       "did you mean \"S1.csv\""},
      {"DataNotNamed", "campaign.toml", Replace, "data = \"S2.csv\"", "data = \"\"", "campaign.toml", 20,
       "data is empty", "name the file"},
      {"DataIsADirectory", "S2.csv", MakeDirectory, "", "", "campaign.toml", 20, "is a directory",
       "name the file inside"},
      {"DataIsAPipe", "S2.csv", MakePipe, "", "", "campaign.toml", 20, "is a pipe",
       "save what it gives to a file"},
      {"DataIsADevice", "campaign.toml", Replace, "data = \"S2.csv\"", "data = \"/dev/zero\"",
       "campaign.toml", 20, "is a device", "save what it gives to a file"},
      {"DataEmpty", "S2.csv", Content, "", "", "S2.csv", 0, "the file is empty", "export it again"},
      {"DataBlank", "S2.csv", Content, "", "\r\n\n   \n", "S2.csv", 0, "the file is empty",
       "export it again"},
      {"DataBinary", "S2.csv", Content, "", "PK\3\4\0\0x_mm,y_mm"s, "S2.csv", 1, "binary",
       "text file that the instrument exports"},
      {"DataUtf16", "S2.csv", Content, "", "\xFF\xFEx\0_\0"s, "S2.csv", 1, "UTF-16",
       "save it again as UTF-8"},
      {"DataLinesEndInCr", "S2.csv", Content, "", "x_mm,y_mm,z_mm,length_mm\r0,0,-300,0\r100,0,-300,100\r",
       "S2.csv", 1, "lines end in CR alone", "LF or CRLF"},
      {"HeaderOnly", "S2.csv", Content, "", "x_mm,y_mm,z_mm,length_mm\n", "S2.csv", 1, "a header and no rows",
       "export the readings again"},
      // TOML
      {"TomlSyntax", "campaign.toml", Replace, "tool = \"long\"\nstation = ", "tool = long\nstation = ",
       "campaign.toml", 11, "TOML", "texts in double quotes"},
      {"TomlDecimalComma", "campaign.toml", Replace, "repeatability_um = 0.5", "repeatability_um = 0,5",
       "campaign.toml", 5, "TOML", "decimal point"},
      {"TomlLatin1", "campaign.toml", Replace, "name = \"level\"", "name = \"niv\xE9\"", "campaign.toml", 35,
       "is not UTF-8 text", "save the file as UTF-8"},
      {"TomlControlCharacter", "campaign.toml", Replace, "name = \"level\"", "name = \"le\\u001bvel\"",
       "campaign.toml", 35, "\"le?vel\" holds a control character", "letters, figures and signs"},
      {"NameLikeAFormula", "campaign.toml", Replace, "name = \"level\"", "name = \"=1+1\"", "campaign.toml",
       35, "begins with =", "a spreadsheet takes it for a formula"},
      {"DataLatin1", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,displacement [\xB5m]\n0,0,-300,0\n100,80,-240,1\n", "diagonal.csv", 1,
       "column displacement [?m] is not UTF-8", "encoding = \"cp1252\""},
      {"ConstantAndColumn", "campaign.toml", Replace, "data = \"diagonal.csv\"",
       "data = \"diagonal.csv\"\nconstants = { z_mm = 0.0 }", "campaign.toml", 31, "has the column \"z_mm\"",
       "remove the constant"},
      {"ConstantReading", "campaign.toml", Replace, "data = \"diagonal.csv\"",
       "data = \"diagonal.csv\"\nconstants = { displacement_mm = 0.0 }", "campaign.toml", 31,
       "gives the reading displacement_mm", "for what stood still"},
      {"TomlLinesEndInCr", "campaign.toml", Content, "",
       "format = \"volcal-campaign-1\"\rmachine = \"machine.toml\"\r", "campaign.toml", 1,
       "lines end in CR alone", "LF or CRLF"},
      {"TomlKeyTwice", "campaign.toml", Replace,
       "station_sigma_mm = 5.0\nnoise = { constant_um = 0.2, per_metre_um = 0.3 }\n\n[[setups]]\nname = "
       "\"S2\"",
       "station_sigma_mm = 5.0\nstation_sigma_mm = 5.0\n\n[[setups]]\nname = \"S2\"", "campaign.toml", 15,
       "TOML", "remove one of the two"},
      {"UnknownKey", "campaign.toml", Replace, "name = \"level\"\n", "name = \"level\"\nnaem = \"x\"\n",
       "campaign.toml", 36, "unknown key setups[4].naem", "did you mean \"name\""},
      {"MisspeltKey", "campaign.toml", Replace, "name = \"level\"\n", "nam = \"level\"\n", "campaign.toml",
       35, "unknown key setups[4].nam", "did you mean \"name\""},
      {"UnknownTopKey", "campaign.toml", Prepend, "", "operatr = \"A. Meier\"\n", "campaign.toml", 1,
       "unknown key operatr", "keys here"},
      {"KeyInAnotherUnit", "campaign.toml", Replace, "station_mm = [-201.0, -149.0, -251.0]",
       "station_m = [-0.201, -0.149, -0.251]", "campaign.toml", 23, "unknown key setups[2].station_m",
       "write station_mm, in mm: 1 m = 1000 mm"},
      {"KeyWithoutUnit", "campaign.toml", Replace, "repeatability_um", "repeatability", "campaign.toml", 5,
       "unknown key noise.repeatability", "write repeatability_um, in um"},
      {"NumberInQuotes", "campaign.toml", Replace, "repeatability_um = 0.5", "repeatability_um = \"0.5\"",
       "campaign.toml", 5, "is the text \"0.5\"", "without quotes"},
      {"TextIsANumber", "campaign.toml", Replace, "name = \"level\"", "name = 7", "campaign.toml", 35,
       "setups[4].name is an integer, expected a text", "in double quotes"},
      {"NotANumberInToml", "campaign.toml", Replace, "repeatability_um = 0.5", "repeatability_um = nan",
       "campaign.toml", 5, "not a finite number", "finite"},
      {"InfiniteStation", "campaign.toml", Replace, "[-201.0, -149.0, -251.0]", "[-201.0, inf, -251.0]",
       "campaign.toml", 23, "not a finite number", "finite"},
      {"VectorOfTwo", "campaign.toml", Replace, "[-201.0, -149.0, -251.0]", "[-201.0, -149.0]",
       "campaign.toml", 23, "has 2 numbers, expected 3", "[x, y, z]"},
      {"HugeStation", "campaign.toml", Replace, "[-201.0, -149.0, -251.0]", "[-201000, -149000, -251000]",
       "campaign.toml", 23, "too large", "wrong unit by 1000"},
      {"NegativeNoise", "campaign.toml", Replace, "constant_um = 0.3 }", "constant_um = -0.3 }",
       "campaign.toml", 32, "is -0.3", "must not be negative"},
      {"NegativeStationSigma", "campaign.toml", Replace,
       "station_sigma_mm = 5.0\nnoise = { constant_um = 0.2, per_metre_um = 0.3 }\n\n[[setups]]\nname = "
       "\"S2\"",
       "station_sigma_mm = -5\n\n[[setups]]\nname = \"S2\"", "campaign.toml", 14, "is -5",
       "must not be negative"},
      // Setups
      {"NoSetups", "campaign.toml", Content, "",
       "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n", "campaign.toml", 0,
       "key setups is missing", "take the comment marks off one"},
      {"SetupsAsOneTable", "campaign.toml", Content, "",
       "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[setups]\nname = \"S1\"\n",
       "campaign.toml", 3, "single table", "double brackets"},
      {"DuplicateSetup", "campaign.toml", Replace, "name = \"S2\"", "name = \"S1\"", "campaign.toml", 18,
       "setup name \"S1\" is used twice, first in line 7", "its own name"},
      {"ReadingsOfTwoSetups", "campaign.toml", Replace,
       "data = \"S2.csv\"\ntool = \"side\"\nstation = \"P1\"\nstation_mm = [-201.0, -149.0, -251.0]",
       "data = \"./S1.csv\"\ntool = \"long\"\nstation = \"P1\"\nstation_mm = [-200.0, -150.0, -250.0]",
       "campaign.toml", 20, "as setup \"S1\" (line 7) does", "remove one of the two setups"},
      {"NamelessSetup", "campaign.toml", Replace, "name = \"S2\"", "name = \"\"", "campaign.toml", 18,
       "setups[2].name is empty", "give it a name"},
      {"NamelessStation", "campaign.toml", Replace, "station = \"P1\"\nstation_mm = [-201.0, -149.0, -251.0]",
       "station = \" \"\nstation_mm = [-201.0, -149.0, -251.0]", "campaign.toml", 22,
       "setups[2].station is empty", "or leave station out"},
      {"UnknownInstrument", "campaign.toml", Replace, "\"displacement\"", "\"displacment\"", "campaign.toml",
       29, "instrument \"displacment\" is not known", "did you mean \"displacement\""},
      {"UnknownTool", "campaign.toml", Replace, "tool = \"side\"", "tool = \"sied\"", "campaign.toml", 21,
       "tool \"sied\" is not in the machine file", "did you mean \"side\""},
      {"ToolMissing", "campaign.toml", Replace, "tool = \"side\"\n", "", "campaign.toml", 17,
       "key tool is missing", "add tool"},
      {"StationMissing", "campaign.toml", Replace, "station_mm = [-201.0, -149.0, -251.0]\n", "",
       "campaign.toml", 17, "key station_mm is missing", "in mm"},
      {"StationInsideTheVolume", "campaign.toml", Replace,
       "station_mm = [-201.0, -149.0, -251.0]\nstation_sigma_mm = 5.0\n",
       "station_mm = [260.0, 210.0, -250.0]\n", "campaign.toml", 17,
       "inside the volume of its own measured points", "stands outside"},
      {"StationPriorsApart", "campaign.toml", Replace, "[-201.0, -149.0, -251.0]", "[-251.0, -149.0, -251.0]",
       "campaign.toml", 17, "over 5 sigma", "correct station_mm or station_sigma_mm"},
      {"StationGuessesFarApart", "campaign.toml", Replace,
       "[-201.0, -149.0, -251.0]\nstation_sigma_mm = 5.0\n", "[1999.0, -149.0, -251.0]\n", "campaign.toml",
       17, "m from where setup \"S1\"", "another name if it was moved"},
      {"FourierOnALinearAxis", "model.toml", Replace, "EAX = { basis = \"zero\" }",
       "EAX = { basis = \"fourier\", degree = 2 }", "model.toml", 8, "does not fit a linear axis",
       "choose one of bspline, legendre, zero"},
      {"NoiseMissing", "campaign.toml", Replace, "noise = { constant_um = 0.3 }\n", "", "campaign.toml", 27,
       "neither by a noise table nor by a sigma column",
       "add noise = { constant_um = ..., per_metre_um = ... }"},
      {"NoiseOfTheMachineAlone", "campaign.toml", Replace, "noise = { constant_um = 0.3 }\n",
       "noise = { repeatability_um = 0.5 }\n", "campaign.toml", 27, "repeatability_um is that of the machine",
       "constant_um = ..., per_metre_um = ... }"},
      {"NoiseAllZero", "campaign.toml", Replace, "noise = { constant_um = 0.3 }",
       "noise = { constant_um = 0 }\nrepeatability_um = 0", "campaign.toml", 27, "are all 0",
       "standard uncertainty"},
      {"NoiseOfAnotherInstrument", "campaign.toml", Replace, "noise = { constant_urad = 1 }",
       "noise = { constant_um = 1 }", "campaign.toml", 40, "unknown key setups[4].noise.constant_um",
       "write constant_urad"},
      {"UnknownChannel", "machine.toml", Replace, "[axes.Y]\n",
       "[axes.Y]\nexpansion_um_per_m_K = 11.5\ntemperature = \"Y\"\n", "campaign.toml", 7,
       "no column T_Y_degC", "add the column"},
      {"UnknownChoice", "campaign.toml", Replace, "axis = [1, 0, 0]", "axis = [1, 0, 0]\nbody = \"tabel\"",
       "campaign.toml", 40, "\"tabel\" is not known", "did you mean \"table\""},
      // Reading the CSV
      {"ColumnMissing", "S2.csv", Replace, ",length_mm\n", ",distance\n", "S2.csv", 1,
       "column length_mm is missing", "columns = { length_mm = "},
      {"ColumnInAnotherUnit", "S2.csv", Replace, ",length_mm\n", ",length_um\n", "S2.csv", 1,
       "column length_mm is missing", "scale = { length_mm = 0.001 }"},
      {"AxisColumnMissing", "S2.csv", Replace, ",z_mm,", ",Z,", "S2.csv", 1, "column z_mm is missing",
       "columns = { z_mm = "},
      {"ColumnTwice", "S2.csv", Replace, "time_s,line", "x_mm,line", "S2.csv", 1, "column x_mm appears twice",
       "rename one"},
      {"TwoReadings", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,displacement_mm,deviation_um\n0,0,-300,0,0\n100,0,-300,100,1\n", "diagonal.csv", 1,
       "both displacement_mm and deviation_um", "keep one of them"},
      {"WrongDelimiter", "diagonal.csv", Content, "",
       "x_mm;y_mm;z_mm;displacement_mm\n0;0;-300;0\n100;0;-300;100\n", "diagonal.csv", 1,
       "its header is separated by ';'", "add delimiter = \";\""},
      {"DecimalComma", "campaign.toml", Replace, "decimal = \",\"\n", "", "plate.csv", 5,
       "holds \"50,0\", a decimal comma", "add decimal = \",\""},
      {"DecimalPointWhereCommaIsDeclared", "plate.csv", Replace, "\"P3\";50,0", "\"P3\";50.0", "plate.csv", 7,
       "a decimal point", "remove decimal"},
      {"DecimalCommaBetweenCommas", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,displacement_mm\n0,0,0,0,-300,0,0,0\n", "diagonal.csv", 2,
       "has 8 cells, the header has 4", "delimiter = \";\" and decimal = \",\""},
      {"DecimalAndDelimiterEqual", "campaign.toml", Replace, "delimiter = \";\"\n", "", "campaign.toml", 48,
       "both ','", "add delimiter = \";\""},
      {"DelimiterOfTwoCharacters", "campaign.toml", Replace, "delimiter = \";\"", "delimiter = \";;\"",
       "campaign.toml", 48, "delimiter is \";;\"", "give one character"},
      {"CellMissing", "diagonal.csv", Replace, "100,80,-240,", "100,80\n", "diagonal.csv", 4,
       "has 2 cells, the header has 4; column z_mm is missing", "complete or delete it"},
      {"CellTooMany", "diagonal.csv", Replace, "100,80,-240,", "100,80,-240,1,", "diagonal.csv", 4,
       "has 5 cells, the header has 4", "remove the extra cells"},
      {"CellEmpty", "diagonal.csv", Replace, "100,80,-240,", "100,,-240,", "diagonal.csv", 4,
       "column y_mm is empty", "delete the row"},
      {"CellIsText", "diagonal.csv", Replace, "100,80,-240,", "100,80 mm,-240,", "diagonal.csv", 4,
       "column y_mm holds \"80 mm\", not a number", "without units"},
      {"CellHasTwoSigns", "diagonal.csv", Replace, "100,80,-240,", "100,+-80,-240,", "diagonal.csv", 4,
       "column y_mm holds \"+-80\", not a number", "plain numbers"},
      {"CellIsNaN", "diagonal.csv", Replace, "100,80,-240,", "100,NaN,-240,", "diagonal.csv", 4,
       "column y_mm holds \"NaN\"", "delete rows without a reading"},
      {"CellIsInfinite", "diagonal.csv", Replace, "100,80,-240,", "100,80,-inf,", "diagonal.csv", 4,
       "column z_mm holds \"-inf\"", "finite"},
      {"CellIsHuge", "diagonal.csv", Replace, "100,80,-240,", "100,8e999,-240,", "diagonal.csv", 4,
       "column y_mm holds \"8e999\"", "finite"},
      {"ComponentMisspelt", "plate.csv", Replace, ";ez_um;", ";ez;", "plate.csv", 3, "column ez is not ez_um",
       "rename it"},
      {"ComponentsAllMissingButOne", "plate.csv", Replace, ";ey_um;ez_um;", ";my;mz;", "campaign.toml", 50,
       "scale has a factor for ey_um, but", "remove the factor"},
      {"QuoteOpen", "plate.csv", Replace, "\"P3\"", "\"P3", "plate.csv", 7, "quote that does not close",
       "close the quote"},
      {"HeaderMissing", "diagonal.csv", Replace, "x_mm,y_mm,z_mm,displacement_mm\n", "", "diagonal.csv", 1,
       "the header row holds numbers", "must name the columns"},
      {"SkipRowsTooMany", "campaign.toml", Replace, "skip_rows = 2", "skip_rows = 200", "plate.csv", 0,
       "no header row", "skip_rows = 200 skips all of it"},
      {"MappedColumnMissing", "campaign.toml", Replace, "x_mm = \"Target X\"", "x_mm = \"Traget X\"",
       "campaign.toml", 47, "columns reads x_mm from \"Traget X\"", "did you mean \"Target X\""},
      {"MappedTwice", "campaign.toml", Replace, "y_mm = \"Target Y\"", "y_mm = \"Target X\"", "campaign.toml",
       47, "reads both x_mm and y_mm from \"Target X\"", "its own column"},
      {"MappingOfAnUnknownColumn", "campaign.toml", Replace, "{ x_mm = \"Target X\"", "{ xmm = \"Target X\"",
       "campaign.toml", 47, "unknown column xmm", "did you mean \"x_mm\""},
      {"ScaleOfNothing", "campaign.toml", Replace, "ex_um = 1000.0", "T_air_degC = 2.0, ex_um = 1000.0",
       "campaign.toml", 50, "scale has a factor for T_air_degC, but", "remove the factor"},
      {"ScaleZero", "campaign.toml", Replace, "ex_um = 1000.0", "ex_um = 0", "campaign.toml", 50,
       "scale.ex_um is 0", "factor"},
      // Values
      {"PositionsOutsideTheTravel", "diagonal.csv", Replace, "100,80,-240,", "100,80,240,", "diagonal.csv", 4,
       "z_mm = 240 lies outside the travel of Z, -300 to 0 mm", "sign of the column"},
      {"PositionsInMicrometres", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,displacement_mm\n0,0,-300000,0\n100000,80000,-240000,141.421\n", "diagonal.csv", 3,
       "lies outside the travel of X, 0 to 500 mm", "scale = { x_mm = 0.001 }"},
      {"UnknownSetupKey", "campaign.toml", Replace, "skip_rows = 2", "skip_rows = 2\nsigma = 1",
       "campaign.toml", 52, "unknown key setups[5].sigma", "keys here"},
      {"ReadingsInMetres", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,displacement_mm\n0,0,-300,0\n100,80,-240,0.141421\n200,160,-180,0.282842\n",
       "diagonal.csv", 2, "changes by 0.001 of what the commanded positions predict",
       "scale = { displacement_mm = 1000 }"},
      {"ReadingsInMicrometres", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,displacement_mm\n0,0,-300,0\n100,80,-240,141421\n200,160,-180,282842\n",
       "diagonal.csv", 3, "displacement_mm = 141421 is too large", "scale = { displacement_mm = 0.001 }"},
      {"ReadingsOfOppositeSign", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,displacement_mm\n0,0,-300,0\n100,80,-240,-141.421\n200,160,-180,-282.842\n",
       "diagonal.csv", 2, "changes by -1 of what", "the sign is reversed"},
      {"ReadingHuge", "level.csv", Replace, "-2.02", "9e7", "level.csv", 3, "is too large", "is believed"},
      {"DirectionOfTwo", "S2.csv", Replace, "100.0,0,23.161,250.540,-215.870,1,1,-1,",
       "100.0,0,23.161,250.540,-215.870,1,2,-1,", "S2.csv", 2, "dir_y = 2 is not a direction",
       "use -1, 1, or 0"},
      {"TimeInMilliseconds", "S2.csv", Replace, "100.0,0,23.161", "1763920000000,0,23.161", "S2.csv", 2,
       "time_s = 1.76392e+12", "scale = { time_s = 0.001 }"},
      {"LineNotAnInteger", "S2.csv", Replace, "100.0,0,23.161", "100.0,0.5,23.161", "S2.csv", 2,
       "line = 0.5 is not a line number", "use integers"},
      {"SigmaNegative", "level.csv", Replace, "200,200,-150,-4.08,1.5", "200,200,-150,-4.08,-1.5",
       "level.csv", 4, "sigma_urad = -1.5", "must be positive"},
      {"SigmaInAnotherUnit", "level.csv", Replace, "sigma_urad", "sigma_um", "level.csv", 1,
       "column sigma_um is not sigma_urad", "scale"},
      {"TemperatureInKelvin", "S2.csv", Replace, "1,1,-1,20.00,-0.00331", "1,1,-1,293.15e1,-0.00331",
       "S2.csv", 2, "T_air_degC = 2931.5", "temperature of the shop"},
      {"TemperaturesInKelvin", "S2.csv", Content, "",
       "x_mm,y_mm,z_mm,T_air_degC,length_mm\n0,0,-300,293.1,0\n100,80,-240,293.4,90\n", "S2.csv", 2,
       "T_air_degC is 293.1 to 293.4: no value lies within -20 to 60 degC", "subtract 273.15"},
      {"TemperaturesInFahrenheit", "S2.csv", Content, "",
       "x_mm,y_mm,z_mm,T_air_degC,length_mm\n0,0,-300,68,0\n100,80,-240,71.5,90\n", "S2.csv", 2,
       "T_air_degC is 68 to 71.5", "(F - 32) / 1.8"},
      {"TemperatureNotInDegC", "S2.csv", Replace, "T_air_degC", "T_air_K", "S2.csv", 1,
       "looks like a temperature", "T_<channel>_degC"},
      {"ColumnInAnotherCase", "S2.csv", Replace, "dir_x", "DIR_X", "S2.csv", 1,
       "column DIR_X is not dir_x: names are case-sensitive", "columns = { dir_x = "},
      {"MovingAxisNotInTheMachine", "diagonal.csv", Content, "",
       "x_mm,y_mm,z_mm,c_deg,displacement_mm\n0,0,-300,0,0\n100,0,-300,5,100\n", "diagonal.csv", 3,
       "c_deg moves, but the machine has no axis C", "add the axis"},
      // Machine
      {"StructureWithoutBed", "machine.toml", Replace, "w X' b Y Z t", "w X Y Z t", "machine.toml", 3,
       "b (bed) is missing", "write it workpiece to tool"},
      {"StructureWithATypographicPrime", "machine.toml", Replace, "w X' b Y Z t", "w X\xE2\x80\x99 b Y Z t",
       "machine.toml", 3, "not ASCII", "write it workpiece to tool"},
      {"StructureWithAnAxisTwice", "machine.toml", Replace, "w X' b Y Z t", "w X' b X Z t", "machine.toml", 3,
       "axis X appears twice", "write it workpiece to tool"},
      {"StructureWithAnUnknownAxis", "machine.toml", Replace, "w X' b Y Z t", "w X' b Y Z Q t",
       "machine.toml", 3, "'Q' is not one of", "write it workpiece to tool"},
      {"ParallelAxisAlone", "machine.toml", Replace, "w X' b Y Z t", "w X' b Y W t", "machine.toml", 3,
       "axis W is parallel to Z, which the structure has not", "name the axis Z"},
      {"AxisWithoutTable", "machine.toml", Replace, "w X' b Y Z t", "w X' b Y Z C t", "machine.toml", 9,
       "[axes.C] is missing", "travel_deg"},
      {"TableWithoutAxis", "machine.toml", Replace, "w X' b Y Z t", "w X' b Y t", "machine.toml", 18,
       "[axes.Z] is not an axis of the structure", "add the axis to the structure"},
      {"TravelReversed", "machine.toml", Replace, "travel_mm = [0, 400]", "travel_mm = [400, 0]",
       "machine.toml", 15, "not ascending", "[lowest, highest]"},
      {"TravelEmpty", "machine.toml", Replace, "travel_mm = [0, 400]", "travel_mm = [400, 400]",
       "machine.toml", 15, "no length", "[lowest, highest]"},
      {"TravelInMetres", "machine.toml", Replace, "travel_mm = [0, 400]", "travel_mm = [0, 0.4]",
       "machine.toml", 15, "shorter than 2 mm", "wrong unit by 1000"},
      {"TravelInDegrees", "machine.toml", Replace, "travel_mm = [0, 400]", "travel_deg = [0, 400]",
       "machine.toml", 15, "unknown key axes.Y.travel_deg", "linear axes take travel_mm"},
      {"HomeOutsideTheTravel", "machine.toml", Replace, "[-300, 0]\nhome_mm = 0", "[-300, 0]\nhome_mm = 10",
       "machine.toml", 20, "home_mm lies outside the travel", "within travel_mm"},
      {"DatumOfOneAxis", "machine.toml", Replace, "secondary = \"Y\"", "secondary = \"X\"", "machine.toml", 7,
       "both X", "two different linear axes"},
      {"DatumOfARotaryAxis", "machine.toml", Replace, "secondary = \"Y\"", "secondary = \"C\"",
       "machine.toml", 7, "is not one of X, Y, Z", "\"X\", \"Y\" or \"Z\""},
      {"NamelessTool", "machine.toml", Replace, "[tools.none]", "[tools.\"\"]", "machine.toml", 29,
       "the name of a tool is empty", "as in [tools.long]"},
      {"ToolOffsetMissing", "machine.toml", Replace, "offset_mm = [0, 0, 0]\n", "", "machine.toml", 29,
       "key offset_mm is missing", "in mm"},
      {"ToolOffsetInMicrometres", "machine.toml", Replace, "[0.0, 0.0, -150.0]", "[0.0, 0.0, -150000.0]",
       "machine.toml", 23, "too large", "write -150"},
      {"ExpansionWithoutChannel", "machine.toml", Replace, "[axes.Y]\n",
       "[axes.Y]\nexpansion_um_per_m_K = 11.5\n", "machine.toml", 15, "half described",
       "temperature = \"CHANNEL\""},
      // Model
      {"ModelMissing", "model.toml", Remove, "", "", "model.toml", 0, "does not exist", "relative"},
      {"ModelIsAPipe", "model.toml", MakePipe, "", "", "model.toml", 0, "is a pipe",
       "save what it gives to a file"},
      {"ModelBasisUnknown", "model.toml", Replace, "\"legendre\"", "\"legendrre\"", "model.toml", 9,
       "\"legendrre\" is not known", "did you mean \"legendre\""},
      {"ModelFunctionUnknown", "model.toml", Replace, "EBX = ", "EBC = ", "model.toml", 9,
       "functions.EBC is not an error motion of this machine", "did you mean"},
      {"ModelDegreeTooHigh", "model.toml", Replace, "degree = 2", "degree = 9", "model.toml", 6,
       "functions.EXX.degree is 9", "must be 1 to 3"},
      {"ModelKnotsMisspelt", "model.toml", Replace, "knots = \"auto\"", "knots = \"automatic\"", "model.toml",
       5, "\"automatic\" is not known", "values: auto"},
      {"ModelKnotsOfAnotherTravel", "model.toml", Replace, "[0, 100, 250, 500]", "[0, 100, 250, 600]",
       "model.toml", 7, "does not begin and end at the travel of X", "travel_mm"},
      {"ModelKnotsUnsorted", "model.toml", Replace, "[0, 100, 250, 500]", "[0, 250, 100, 500]", "model.toml",
       7, "not strictly ascending", "sort"},
      {"ModelKnotsOnAPolynomial", "model.toml", Replace, "degree = 4 }", "degree = 4, knots = 3 }",
       "model.toml", 9, "has no knots", "remove knots"},
      {"ModelCoefficientsMiscounted", "model.toml", Replace, "[0, 100, 250, 500]",
       "[0, 100, 250, 500], coefficients_um = [1, 2]", "model.toml", 7, "has 2 values", "6 coefficients"},
      {"ModelSquarenessOfAnotherDatum", "model.toml", Replace, "EC0Y", "EB0X", "model.toml", 12,
       "locations.EB0X is not a location error of this machine", "EC0Y, EA0Z, EB0Z"},
      {"ModelSquarenessWithoutUnit", "model.toml", Replace, "EC0Y = \"zero\"", "EC0Y = 12", "model.toml", 12,
       "unknown key locations.EC0Y", "write EC0Y_urad"},
      {"ModelEffectUnknown", "model.toml", Replace, "\"reversal\"", "\"backlash\"", "model.toml", 15,
       "effect kind \"backlash\" is not known", "reversal"},
      {"ModelEffectWithAnEmptySymbol", "model.toml", Replace, "symbol = \"EXX\"", "symbol = \"\"",
       "model.toml", 16, "effects[1].symbol is empty", "write a text"},
      {"ModelEffectWithoutSymbol", "model.toml", Replace, "symbol = \"EXX\"\n", "", "model.toml", 14,
       "key symbol is missing", "add symbol"},
      {"ModelOfAnotherMachine", "model.toml", Replace, "machine = \"machine.toml\"",
       "machine = \"other_machine.toml\"", "model.toml", 2, "the model is for another machine",
       "use a model of the same machine"},
  };
  return all;
}

}  // namespace volcal::testing
