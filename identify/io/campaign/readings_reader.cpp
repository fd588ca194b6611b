#include "volcal/identify/io/campaign/readings_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kTravelMargin = 0.05;  // share of the travel that commanded positions may lie outside
constexpr double kUnitSlip = 20.0;      // a position this many times beyond the travel may be in another unit
constexpr double kLatestTime_s = 1e10;  // of a clock that begins with the campaign or in 1970
constexpr double kColdest_degC = -60.0;
constexpr double kHottest_degC = 300.0;
constexpr double kShopColdest_degC = -20.0;  // some value of a channel lies between these two
constexpr double kShopHottest_degC = 60.0;

double si_factor(const std::string& column) { return unit_of_key(column).si_per_unit; }

class ReadingsReader {
 public:
  ReadingsReader(const CsvTable& table, const ColumnMapping& mapping, const ColumnChoice& choice,
                 const Machine& machine, const InstrumentSchema& instrument)
      : table_(table), mapping_(mapping), choice_(choice), machine_(machine), instrument_(instrument) {}

  Readings read() {
    readings_.column_set = choice_.column_set;
    readings_.value.resize(instrument_.column_sets[choice_.column_set].size());
    readings_.given.resize(instrument_.given_of(choice_.column_set).size());
    CsvColumns columns = table_.numbers(choice_.index);
    line_ = std::move(columns.source_line);
    for (std::size_t i = 0; i < choice_.name.size(); ++i) {
      scale(choice_.name[i], columns.values[i]);
      store(choice_.name[i], std::move(columns.values[i]));
    }
    in_constants_ = true;
    for (const auto& [column, value] : mapping_.constant) store(column, std::vector(line_.size(), value));
    readings_.source_line = std::move(line_);
    if (instrument_.column_sets[choice_.column_set].front().derived)
      readings_.value.front() = instrument_.derive_reading(readings_);
    return std::move(readings_);
  }

 private:
  void scale(const std::string& column, std::vector<double>& values) const {
    const auto factor = mapping_.scale.find(column);
    if (factor == mapping_.scale.end()) return;
    for (double& value : values) value *= factor->second;
  }

  void store(const std::string& column, std::vector<double> values) {
    if (const auto channel = temperature_channel(column); !channel.empty()) {
      check_temperatures(column, values);
      readings_.temperature[channel] = std::move(values);
    } else if (column == "line") {
      readings_.line = integers(column, values);
    } else if (column == "run") {
      readings_.run = integers(column, values);
    } else if (column == "time_s") {
      check_range(column, values, -kLatestTime_s, kLatestTime_s,
                  "seconds of the campaign's clock, or since 1970, are expected; if the file is in "
                  "milliseconds add scale = { time_s = 0.001 } to the setup");
      readings_.time = std::move(values);
    } else if (column == "feed_mm_min") {
      check_range(column, values, 0.0, 1e6, "a feed is not negative; 0 to 1000000 mm/min is believed");
      readings_.feed = in_si(column, std::move(values));
    } else if (column == sigma_column(instrument_)) {
      store_sigma(column, std::move(values));
    } else if (!store_axis(column, values)) {
      store_reading(column, std::move(values));
    }
  }

  bool store_axis(const std::string& column, std::vector<double>& values) {
    for (const AxisName axis : kAllAxes) {
      if (column == direction_column(axis)) {
        readings_.direction[index_of(axis)] = directions(column, values);
        return true;
      }
      if (column != axis_column(axis)) continue;
      if (!machine_.has_axis(axis)) {
        reject_movement(column, axis, values);
        return true;
      }
      values = in_si(column, std::move(values));
      check_travel(column, machine_.axis(axis), values);
      readings_.position[index_of(axis)] = std::move(values);
      return true;
    }
    return false;
  }

  void store_reading(const std::string& column, std::vector<double> values) {
    const auto& set = instrument_.column_sets[readings_.column_set];
    const auto& given = instrument_.given_of(readings_.column_set);
    const auto own = std::ranges::find(set, column, &ColumnSchema::column);
    const auto schema = own != set.end() ? own : std::ranges::find(given, column, &ColumnSchema::column);
    const double most = schema->plausible_max;
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (std::abs(values[row]) <= most) continue;
      const std::string_view unit = unit_of_key(column).suffix;
      std::string remedy = "at most " + number_text(most) + " " + std::string(unit) + " is believed";
      const bool thousand = std::ranges::all_of(values, [&](double v) { return std::abs(v) <= most * 1e3; });
      if (thousand) {
        remedy += "; if the file is in a unit 1000 times smaller add scale = { " + column +
                  " = 0.001 } to the setup";
      }
      fail(row, column + " = " + number_text(values[row]) + " is too large", remedy);
    }
    auto& store = own != set.end() ? readings_.value[static_cast<std::size_t>(own - set.begin())]
                                   : readings_.given[static_cast<std::size_t>(schema - given.begin())];
    store = in_si(column, std::move(values));
  }

  void store_sigma(const std::string& column, std::vector<double> values) {
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] > 0.0) continue;
      fail(row, column + " = " + number_text(values[row]) + " is not a standard deviation",
           "every sigma must be positive; remove the column to use the setup's noise table");
    }
    readings_.sigma = in_si(column, std::move(values));
  }

  static std::vector<double> in_si(const std::string& column, std::vector<double> values) {
    const double factor = si_factor(column);
    for (double& value : values) value *= factor;
    return values;
  }

  [[noreturn]] void fail(std::size_t row, const std::string& problem, const std::string& remedy) const {
    const SourcePlace in_file{table_.file(), static_cast<int>(line_[row])};
    throw InputError(in_constants_ ? mapping_.constant_place : in_file, problem, remedy);
  }

  void check_range(const std::string& column, const std::vector<double>& values, double min, double max,
                   const std::string& remedy) const {
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] < min || values[row] > max)
        fail(row, column + " = " + number_text(values[row]), remedy);
    }
  }

  /// A hot spindle leaves the range of a shop now and then, degF and K always.
  void check_temperatures(const std::string& column, const std::vector<double>& values) const {
    check_range(column, values, kColdest_degC, kHottest_degC, "a temperature of the shop is expected");
    const auto [coldest, hottest] = std::ranges::minmax(values);
    if (coldest <= kShopHottest_degC && hottest >= kShopColdest_degC) return;
    fail(0,
         column + " is " + number_text(coldest) + " to " + number_text(hottest) + ": no value lies within " +
             number_text(kShopColdest_degC) + " to " + number_text(kShopHottest_degC) + " degC",
         hottest > 200.0 ? "in K? write degC: subtract 273.15" : "in degF? write degC: (F - 32) / 1.8");
  }

  void check_travel(const std::string& column, const Axis& axis, const std::vector<double>& values) const {
    const double margin = kTravelMargin * axis.travel();
    const auto outside = [&](double q) {
      return q < axis.travel_min - margin || q > axis.travel_max + margin;
    };
    const auto first = std::ranges::find_if(values, outside);
    if (first == values.end()) return;
    const double factor = si_factor(column);
    const std::string unit(unit_of_key(column).suffix);
    std::string remedy = "check travel_" + unit + " of the machine and the unit and sign of the column";
    const double reach = std::max(std::abs(axis.travel_min), std::abs(axis.travel_max));
    for (const double scale : {1e-3, 1e3}) {
      if (scale < 1.0 && std::abs(*first) < kUnitSlip * reach) continue;
      const bool fits = std::ranges::none_of(values, [&](double q) { return outside(q * scale); });
      if (fits)
        remedy =
            "wrong unit by 1000? add scale = { " + column + " = " + number_text(scale) + " } to the setup";
    }
    fail(static_cast<std::size_t>(first - values.begin()),
         column + " = " + number_text(*first / factor) + " lies outside the travel of " +
             letter_of(axis.name) + ", " + number_text(axis.travel_min / factor) + " to " +
             number_text(axis.travel_max / factor) + " " + unit,
         remedy);
  }

  void reject_movement(const std::string& column, AxisName axis, const std::vector<double>& values) const {
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] == values.front()) continue;
      fail(row, column + " moves, but the machine has no axis " + std::string(1, letter_of(axis)),
           "add the axis to the machine or take the column out of the file");
    }
  }

  std::vector<std::int8_t> directions(const std::string& column, const std::vector<double>& values) const {
    std::vector<std::int8_t> read(values.size());
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] != -1.0 && values[row] != 0.0 && values[row] != 1.0) {
        fail(row, column + " = " + number_text(values[row]) + " is not a direction of approach",
             "use -1, 1, or 0 when unknown");
      }
      read[row] = static_cast<std::int8_t>(values[row]);
    }
    return read;
  }

  std::vector<std::int32_t> integers(const std::string& column, const std::vector<double>& values) const {
    std::vector<std::int32_t> read(values.size());
    for (std::size_t row = 0; row < values.size(); ++row) {
      const bool fits = values[row] == std::round(values[row]) &&
                        std::abs(values[row]) <= std::numeric_limits<std::int32_t>::max();
      if (!fits)
        fail(row, column + " = " + number_text(values[row]) + " is not a " + column + " number",
             "use integers");
      read[row] = static_cast<std::int32_t>(values[row]);
    }
    return read;
  }

  const CsvTable& table_;
  const ColumnMapping& mapping_;
  const ColumnChoice& choice_;
  const Machine& machine_;
  const InstrumentSchema& instrument_;
  std::vector<std::int64_t> line_;
  bool in_constants_ = false;
  Readings readings_;
};

}  // namespace

Readings read_readings(const CsvTable& table, const ColumnMapping& mapping, const ColumnChoice& choice,
                       const Machine& machine, const InstrumentSchema& instrument) {
  return ReadingsReader(table, mapping, choice, machine, instrument).read();
}

Readings read_readings(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                       const InstrumentSchema& instrument) {
  return read_readings(table, mapping, choose_columns(table, mapping, machine, instrument), machine,
                       instrument);
}

}  // namespace volcal
