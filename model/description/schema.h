#pragma once
/// Schemas: what a plug-in (instrument, effect, basis, table format) declares about itself as data.
/// Reading, help, documentation and fuzzing follow from them; nothing else lists keys or columns.

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace volcal {

enum class KeyType { Number, Text, Boolean, Vector3, Numbers };

/// One key of a TOML table. The unit is the suffix of the key; `plausible_*` bounds |value| in that unit.
struct KeySchema {
  std::string key;  ///< with unit, as the user writes it: "station_mm"
  KeyType type = KeyType::Number;
  bool required = false;
  std::string help;
  std::vector<std::string> choices = {};  ///< for Text: allowed values; empty = any
  double plausible_min = 0.0;             ///< smallest |value| other than 0 that is believed
  double plausible_max = 1e300;           ///< largest |value| (of each component or entry) that is believed
};

/// One reading column. Several columns of one instrument are read together (ex, ey, ez).
struct ColumnSchema {
  std::string column;  ///< with unit: "length_mm"
  std::string help;
  double plausible_max = 1e300;  ///< largest |value| in the column's unit
  bool derived = false;          ///< not in the file: follows from the given columns of its set
};

struct Readings;

/// Values of a table's keys after reading: SI, under the key's stem ("station", not "station_mm"). Values of
/// different type under one stem stand beside each other: `station = "P1"` and `station_mm = [...]`.
using OptionValue = std::variant<double, std::string, bool, Eigen::Vector3d, std::vector<double>>;
class Options {
 public:
  using Key = std::pair<std::string, std::size_t>;  ///< stem and index of the value's type

  void set(const std::string& stem, OptionValue value) { values_[{stem, value.index()}] = std::move(value); }
  bool has(const std::string& stem) const {
    const auto found = values_.lower_bound({stem, 0});
    return found != values_.end() && found->first.first == stem;
  }
  std::optional<double> number(const std::string& stem) const { return get<double>(stem); }
  std::optional<std::string> text(const std::string& stem) const { return get<std::string>(stem); }
  std::optional<bool> boolean(const std::string& stem) const { return get<bool>(stem); }
  std::optional<Eigen::Vector3d> vector(const std::string& stem) const { return get<Eigen::Vector3d>(stem); }
  /// A list of any length.
  std::optional<std::vector<double>> numbers(const std::string& stem) const {
    return get<std::vector<double>>(stem);
  }
  const std::map<Key, OptionValue>& all() const { return values_; }

 private:
  template <class T>
  std::optional<T> get(const std::string& stem) const {
    for (auto found = values_.lower_bound({stem, 0}); found != values_.end() && found->first.first == stem;
         ++found) {
      if (const T* value = std::get_if<T>(&found->second)) return *value;
    }
    return std::nullopt;
  }

  std::map<Key, OptionValue> values_;
};

/// What of an instrument's lengths is in proportion to the wavelength of its laser.
enum class LaserLength {
  None,         ///< it has no laser
  Distance,     ///< the distance from its station (key `station_mm`)
  Displacement  ///< the displacement along its beam (key `direction`) from the first reading
};

/// What an instrument reads along a line of one axis.
enum class LineReading {
  None,
  Along,    ///< displacement along the beam (key `direction`)
  Across,   ///< deviation across the line, along the key `direction`
  Rotation  ///< rotation about the key `axis`
};

/// What an instrument reads of a sphere on the table (key `sphere`).
enum class SphereReading {
  None,
  Displacement,  ///< of the tool point, which stays on the sphere while axes move
  Place          ///< where the axes find it: its centre, or contacts
};

/// An angle encoder that reads a channel.
struct AngleEncoder {
  std::string name;  ///< "azimuth"
  int channel = 0;
};

/// What effects, criticism, planning, figures of standards and reports ask of an instrument: none of them
/// names one.
struct InstrumentTraits {
  LaserLength laser_length = LaserLength::None;
  LineReading line_reading = LineReading::None;
  SphereReading sphere_reading = SphereReading::None;
  /// Its first column is a length that counts from a zero, which a run may lose.
  bool length_from_zero = false;
  /// It reads the length of a bar between a ball on the table (key `centre_mm`) and one at the tool; the
  /// bar's length may be calibrated (key `length_sigma_um`).
  bool has_bar = false;
  /// It reads while the axes move; others read at rest.
  bool reads_in_motion = false;
  /// It reads components of the error vector at points (columns ex_um, ey_um, ez_um).
  bool reads_error_vectors = false;
  std::vector<AngleEncoder> encoders = {};
  /// Whether a setup with these options refers to the floor or to gravity, so that it sees machine and
  /// workpiece turn together.
  bool (*stands_on_floor)(const Options& options) = [](const Options&) { return false; };
};

/// What an instrument declares: keys of its `[[setups]]` table beyond the common ones, its reading columns,
/// keys of its `noise` table, its traits.
struct InstrumentSchema {
  std::string name;      ///< "laser-tracer"
  std::string summary;   ///< one sentence for the user
  std::string equation;  ///< observation equation as printed in help
  std::string source;
  std::vector<KeySchema> keys;
  /// Alternative sets of columns, preferred first. One set must be present in the file; of two that contain
  /// each other the larger counts, of others both are an error.
  std::vector<std::vector<ColumnSchema>> column_sets;
  std::vector<KeySchema> noise_keys;
  InstrumentTraits traits = {};
  /// Per column set: columns that its readings rest on and that are taken as known, as the direction of a
  /// contact. Empty = none.
  std::vector<std::vector<ColumnSchema>> given_columns = {};
  /// The reading of a set whose column is derived, from Readings::given; SI.
  std::vector<double> (*derive_reading)(const Readings& readings) = nullptr;
  bool simulated = true;  ///< sim/measurement has it; the tests hold the two against each other

  const std::vector<ColumnSchema>& given_of(std::size_t set) const {
    static const std::vector<ColumnSchema> none;
    return set < given_columns.size() ? given_columns[set] : none;
  }
  /// Columns of a set that a file must have: readings, and what they rest on.
  std::vector<ColumnSchema> file_columns(std::size_t set) const {
    std::vector<ColumnSchema> columns;
    for (const ColumnSchema& column : column_sets[set]) {
      if (!column.derived) columns.push_back(column);
    }
    columns.insert(columns.end(), given_of(set).begin(), given_of(set).end());
    return columns;
  }
};

/// A part of an effect's name, kind:target:driver:shape.
enum class NamePart { Target, Driver, Shape };

/// A word of names of effects that one kind alone has, and what it means. In capitals stands what the user's
/// files name: SYMBOL, AXIS, TOOL ... (identify/criticism/data/effect_words.h).
struct NameWord {
  NamePart part = NamePart::Target;
  std::string pattern;  ///< "EXPRESSION"
  std::string meaning;
};

/// What an effect declares: what is said of it, and keys of its `[[effects]]` table besides `kind`.
struct EffectSchema {
  std::string kind;
  std::string summary;
  std::string plain = {};         ///< one sentence for who knows machines and no models
  std::string usual_causes = {};  ///< "backlash of the screw; loose couplings": to follow "usual causes:"
  std::string source;
  /// Its drivers are, for given directions of approach and conditions, polynomials in the positions of linear
  /// axes, at most cubic in each.
  bool polynomial = false;
  /// With its temperature the scales of the axes whose positioning errors it acts on expand, counted from the
  /// reference temperature: at that it does nothing.
  bool expands_scales = false;
  std::vector<KeySchema> keys;
  std::vector<NameWord> words = {};  ///< of its names, beyond those that all kinds have
  bool simulated = true;             ///< sim/known has it; the tests hold the two against each other
};

}  // namespace volcal
