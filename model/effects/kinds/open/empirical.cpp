// What no name explains: a function of one to three recorded variables without a formula. Its coefficients
// are amplitudes that a prior ties together, so that it is as smooth as the readings say.
#include "volcal/model/effects/kinds/open/empirical.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/written_target.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {
namespace {

constexpr const char* kEmpirical = "empirical";
constexpr std::size_t kMostDrivers = 3;
constexpr double kMostPieces = 40;
constexpr int kMostCoefficients = 400;
constexpr std::array<int, kMostDrivers> kPieces = {24, 6, 3};  // by number of drivers
constexpr double kSameValue = 1.0 / 200.0;                     // of the range
const std::string kListedDrivers = "name one to three variables, as in drivers = \"y z\"";

/// The part of the campaign on which an effect acts, from the key `only`.
struct Owner {
  enum class Kind { All, Tool, Station, Setup } kind = Kind::All;
  std::string name;

  bool holds(const Campaign& campaign, const Setup& setup) const {
    switch (kind) {
      case Kind::Tool:
        return campaign.machine.tools[setup.tool].name == name;
      case Kind::Station:
        return station_of(setup) == name;
      case Kind::Setup:
        return setup.name == name;
      case Kind::All:
        break;
    }
    return true;
  }

  void check(const Campaign& campaign, const SourcePlace& place) const {
    if (kind == Kind::Tool) check_tool(campaign, name, place);
    if (kind == Kind::Station) check_station(campaign, name, place);
    if (kind == Kind::Setup) check_setup(campaign, name, place);
  }
};

Owner owner_of(const EffectTable& table) {
  const std::string text = table.spec.options.text("only").value_or("");
  if (text.empty()) return {};
  for (const auto& [word, kind] : {std::pair{"tool ", Owner::Kind::Tool},
                                   {"station ", Owner::Kind::Station},
                                   {"setup ", Owner::Kind::Setup}}) {
    if (text.starts_with(word)) return {kind, text.substr(std::string_view(word).size())};
  }
  table.fail("only = \"" + text + "\" is not a part of a campaign",
             "write \"tool NAME\", \"station NAME\" or \"setup NAME\"");
}

/// Its table, without the campaign.
struct Statement {
  explicit Statement(const EffectTable& table)
      : place(table.place), target(written_target(table)), owner(owner_of(table)) {
    drivers = stated_variables(table, "drivers", table.text("drivers", kListedDrivers));
    factors = stated_variables(table, "factor", table.spec.options.text("factor").value_or(""));
    if (drivers.empty() || drivers.size() > kMostDrivers)
      table.fail(std::to_string(drivers.size()) + " drivers", kListedDrivers);
    read_sides(table);
  }

  std::string name() const {
    std::string text = drivers.size() == 1 ? "curve " : "surface ";
    return text + target_name().name() + " by " + driver().name();
  }
  TargetName target_name() const {
    return owner.kind == Owner::Kind::All ? target.name() : target.name().within(owner.name);
  }
  EffectDriver driver() const {
    std::vector<Variable> all = factors;
    all.insert(all.end(), drivers.begin(), drivers.end());
    return EffectDriver::written(all);
  }

  bool acts_on(const Campaign& campaign, const Setup& setup) const {
    return target.acts_on(campaign, setup) && owner.holds(campaign, setup);
  }
  bool all_recorded(const Setup& setup) const {
    const auto is_recorded = [&](const Variable& variable) { return has_variable(setup, variable); };
    return std::ranges::all_of(drivers, is_recorded) && std::ranges::all_of(factors, is_recorded);
  }

  SourcePlace place;
  WrittenTarget target;
  Owner owner;
  std::vector<Variable> drivers;
  std::vector<Variable> factors;
  std::vector<TensorBasis::Side> sides;
  bool has_range = false;

 private:
  static std::vector<Variable> stated_variables(const EffectTable& table, const std::string& key,
                                                const std::string& list) {
    std::vector<Variable> variables;
    for (const std::string& word : words_in(list)) {
      const auto variable = Variable::parse_written(word);
      if (!variable)
        table.fail(key + ": \"" + word + "\" is not a variable", "variables are " + listed_variables());
      variables.push_back(*variable);
    }
    return variables;
  }

  /// One number per driver.
  std::optional<std::vector<double>> list(const EffectTable& table, const std::string& key) const {
    auto values = table.spec.options.numbers(key);
    if (values && values->size() != drivers.size()) {
      table.fail(fmt::format("{} holds {} numbers for {} drivers", key, values->size(), drivers.size()),
                 "write one number per driver");
    }
    return values;
  }

  void read_sides(const EffectTable& table) {
    const auto from = list(table, "from"), to = list(table, "to"), pieces = list(table, "pieces");
    if (from.has_value() != to.has_value())
      table.fail("from and to belong together", "write both, or neither and let the readings tell");
    has_range = from.has_value();
    int coefficients = 1;
    for (std::size_t i = 0; i < drivers.size(); ++i) {
      TensorBasis::Side side{0.0, 1.0, kPieces[drivers.size() - 1]};
      if (pieces) {
        const double count = (*pieces)[i];
        if (count != std::floor(count) || count < 1.0 || count > kMostPieces)
          table.fail(fmt::format("pieces: {:g} is not a number of pieces", count),
                     fmt::format("write whole numbers from 1 to {:g}", kMostPieces));
        side.pieces = static_cast<int>(count);
      }
      if (has_range) {
        side.from = (*from)[i];
        side.to = (*to)[i];
        if (!(side.from < side.to))
          table.fail(fmt::format("the range of {} is empty", drivers[i].written()),
                     "write from less than to");
      }
      coefficients *= side.pieces + 3;
      sides.push_back(side);
    }
    if (coefficients > kMostCoefficients) {
      table.fail(fmt::format("these pieces need {} coefficients", coefficients),
                 fmt::format("use fewer pieces: at most {} coefficients", kMostCoefficients));
    }
  }
};

class EmpiricalEffect final : public Effect {
 public:
  explicit EmpiricalEffect(const EffectTable& table) : stated_(table), basis_(stated_.sides) {
    name_ = {kEmpirical, stated_.target_name(), stated_.driver(),
             stated_.drivers.size() == 1 ? "curve" : "surface"};
    const std::vector<double> known =
        table.spec.options.numbers("coefficients").value_or(std::vector<double>{});
    const auto size = static_cast<std::size_t>(basis_.size());
    if (!known.empty() && known.size() != size) {
      table.fail(fmt::format("{} coefficients for {} functions", known.size(), size),
                 "leave them out to have them identified");
    }
    for (std::size_t k = 0; k < size; ++k) {
      const std::string number = std::to_string(k + 1);
      amplitudes_.push_back({.label = part_label(stated_.name(), number),
                             .target = stated_.target.target(),
                             .key = stated_.target.amplitude_key("coefficients"),
                             .guess = known.empty() ? 0.0 : known[k],
                             .element = static_cast<int>(k),
                             .of = stated_.name(),
                             .part = number});
    }
  }

  const TensorBasis* surface() const override { return &basis_; }

  void check(const Campaign& campaign, const SourcePlace& place) const override {
    const std::string what = "empirical effect \"" + stated_.name() + "\"";
    stated_.target.check(campaign, what, place);
    stated_.owner.check(campaign, place);
    const auto acts = [&](const Setup& setup) { return stated_.acts_on(campaign, setup); };
    for (const Variable& variable : stated_.drivers)
      check_variable(campaign, variable, acts, what, "it is driven by " + variable.written(), place);
    for (const Variable& variable : stated_.factors)
      check_variable(campaign, variable, acts, what, "it is multiplied with " + variable.written(), place);
  }

  Eigen::MatrixXd drivers(const SetupView& view, const Eigen::VectorXd& /*shape*/) const override {
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(view.rows()), basis_.size());
    if (const auto at = places_of(view)) {
      for (Eigen::Index row = 0; row < values.rows(); ++row)
        values.row(row) = at->factor[row] * basis_.row(at->place(row)).transpose();
    }
    return values;
  }

  Eigen::MatrixXd faded_drivers(const SetupView& view) const override {
    Eigen::MatrixXd lost;
    const auto at = places_of(view);
    if (!at) return lost;
    for (Eigen::Index row = 0; row < at->factor.size(); ++row) {
      if (!basis_.is_beyond(at->place(row))) continue;
      if (lost.size() == 0) lost = Eigen::MatrixXd::Zero(at->factor.size(), basis_.size());
      lost.row(row) =
          at->factor[row] * (basis_.held_row(at->place(row)) - basis_.row(at->place(row))).transpose();
    }
    return lost;
  }

  std::size_t unrecorded(const SetupView& view) const override {
    return stated_.acts_on(view.campaign, view.setup) && !stated_.all_recorded(view.setup) ? view.rows() : 0;
  }

 private:
  /// Where on the surface the readings of a setup lie, and what its value there is multiplied with.
  struct Places {
    Eigen::MatrixXd values;  ///< drivers x readings
    Eigen::VectorXd factor;

    std::span<const double> place(Eigen::Index reading) const {
      return {values.col(reading).data(), static_cast<std::size_t>(values.rows())};
    }
  };

  /// Nothing where it does not act or a variable was not recorded.
  std::optional<Places> places_of(const SetupView& view) const {
    if (!stated_.acts_on(view.campaign, view.setup) || !stated_.all_recorded(view.setup)) return std::nullopt;
    require_range();
    const auto rows = static_cast<Eigen::Index>(view.rows());
    Places places{Eigen::MatrixXd(static_cast<Eigen::Index>(stated_.drivers.size()), rows),
                  Eigen::VectorXd::Ones(rows)};
    for (const Variable& each : stated_.factors) {
      const auto own = recorded_variable(view, each);
      if (own->size() != rows) return std::nullopt;
      places.factor.array() *= own->array();
    }
    for (std::size_t i = 0; i < stated_.drivers.size(); ++i) {
      const auto own = recorded_variable(view, stated_.drivers[i]);
      if (own->size() != rows) return std::nullopt;
      places.values.row(static_cast<Eigen::Index>(i)) = own->transpose();
    }
    return places;
  }

  void require_range() const {
    if (stated_.has_range) return;
    throw InputError(stated_.place, stated_.name() + " has no range",
                     "write from = [...] and to = [...], one number per driver, or let volcal fit find them");
  }

  Statement stated_;
  TensorBasis basis_;
};

/// What readings of a driver say about its range.
class ValuesOfDriver {
 public:
  void add(const Eigen::VectorXd& values) { values_.insert(values_.end(), values.begin(), values.end()); }

  /// As many pieces as there are values that differ, less one, at most those asked for; nothing where all are
  /// the same.
  std::optional<TensorBasis::Side> side(int most_pieces) {
    if (values_.empty()) return std::nullopt;
    std::ranges::sort(values_);
    const double from = values_.front(), to = values_.back();
    if (!(to > from)) return std::nullopt;
    int different = 1;
    double last = from;
    for (const double value : values_) {
      if (value - last <= kSameValue * (to - from)) continue;
      ++different;
      last = value;
    }
    return TensorBasis::Side{from, to, std::clamp(different - 1, 1, most_pieces)};
  }

 private:
  std::vector<double> values_;
};

class EmpiricalKind final : public EffectKind {
 public:
  const EffectSchema& schema() const override {
    static const EffectSchema kSchema = {
        .kind = kEmpirical,
        .summary =
            "what has no name: a smooth function of one to three recorded variables, found by the "
            "readings alone and added to a target",
        .plain =
            "Something acts that no name of the catalogue explains: the readings alone draw it as a smooth "
            "function.",
        .usual_causes = "read them off the picture: what changes there, and nowhere else",
        .source =
            "tensor products of cubic B-splines under a Gaussian-process prior (de Boor 1978, ch. XVII; "
            "Rasmussen and Williams 2006, ch. 5)",
        .keys = {written_target_key(),
                 text_key(
                     "drivers",
                     "one to three of x y z (mm) a b c (deg) as commanded, t (s since the first reading), "
                     "T_<channel> (degC), length (mm to the station), feed (mm/min), tool_length tool_x "
                     "tool_y tool_z (mm)"),
                 text_key("factor", "what the function is multiplied with: dir_x ... dir_c", false),
                 text_key("only", "where it acts: \"tool NAME\", \"station NAME\" or \"setup NAME\"", false),
                 {.key = "from",
                  .type = KeyType::Numbers,
                  .help = "least value of each driver; absent = of the readings",
                  .plausible_max = 1e9},
                 {.key = "to",
                  .type = KeyType::Numbers,
                  .help = "largest value of each driver; absent = of the readings",
                  .plausible_max = 1e9},
                 {.key = "pieces",
                  .type = KeyType::Numbers,
                  .help =
                      "pieces of the splines of each driver; absent = as many as the readings resolve, at "
                      "most 24, 6 or 3 for one, two or three drivers",
                  .plausible_max = 1e3},
                 {.key = "coefficients_um",
                  .type = KeyType::Numbers,
                  .help = "identified values, those of the last driver next to each other",
                  .plausible_max = 1e9},
                 {.key = "coefficients_urad",
                  .type = KeyType::Numbers,
                  .help = "the same of a target that turns",
                  .plausible_max = 1e9}},
        .words = {
            {NamePart::Shape, "curve", "a smooth function of one variable that the readings alone decide"},
            {NamePart::Shape, "surface",
             "a smooth function of two or three variables that the readings alone decide"}}};
    return kSchema;
  }

  std::unique_ptr<Effect> make(const EffectSpec& spec, const std::string& model_file) const override {
    return std::make_unique<EmpiricalEffect>(EffectTable(spec, model_file));
  }

  bool is_open(const EffectSpec& spec) const override { return !spec.options.numbers("from").has_value(); }

  EffectSpec resolved(const EffectSpec& spec, const std::vector<SetupView>& views,
                      const std::string& model_file) const override {
    const Statement stated(EffectTable(spec, model_file));
    if (stated.has_range) return spec;
    std::vector<double> from, to, pieces;
    for (std::size_t i = 0; i < stated.drivers.size(); ++i) {
      const auto side = range_of(stated, views, stated.drivers[i]).side(stated.sides[i].pieces);
      if (!side) {
        throw InputError(stated.place,
                         stated.name() + ": " + stated.drivers[i].written() + " does not change",
                         "remove it from the drivers, or measure where it changes");
      }
      from.push_back(side->from);
      to.push_back(side->to);
      pieces.push_back(side->pieces);
    }
    EffectSpec resolved = spec;
    resolved.options.set("from", from);
    resolved.options.set("to", to);
    if (!spec.options.numbers("pieces")) resolved.options.set("pieces", pieces);
    return resolved;
  }

  /// Shown by what scans find (identify/criticism), not by trying.
  std::vector<EffectSpec> candidates(const Campaign& /*campaign*/) const override { return {}; }

  std::vector<EffectSpec> examples(const Campaign& campaign) const override {
    const std::vector<AxisName> axes = campaign.machine.linear_axes();
    const Axis &first = campaign.machine.axis(axes.front()), &last = campaign.machine.axis(axes.back());
    const auto driver = [](const Axis& axis) { return std::string(1, lower_letter_of(axis.name)); };
    const auto edge = [](double position) { return position / kMetrePerMillimetre; };
    const ErrorSymbol symbol{Component::A, first.name};
    const std::vector<double> from = {edge(first.travel_min), edge(last.travel_min)},
                              to = {edge(first.travel_max), edge(last.travel_max)};
    return {effect_spec(kEmpirical, {{"target", symbol.name()},
                                     {"drivers", driver(first) + " " + driver(last)},
                                     {"from", from},
                                     {"to", to},
                                     {"pieces", std::vector<double>{1, 1}}}),
            effect_spec(kEmpirical, {{"target", std::string("tool z")},
                                     {"drivers", driver(first)},
                                     {"factor", "dir_" + driver(first)},
                                     {"from", std::vector<double>{from.front()}},
                                     {"to", std::vector<double>{to.front()}},
                                     {"pieces", std::vector<double>{2}}})};
  }

 private:
  static ValuesOfDriver range_of(const Statement& stated, const std::vector<SetupView>& views,
                                 const Variable& driver) {
    ValuesOfDriver range;
    for (const SetupView& view : views) {
      if (!stated.acts_on(view.campaign, view.setup)) continue;
      if (const auto values = recorded_variable(view, driver)) range.add(*values);
    }
    return range;
  }
};

}  // namespace

bool is_surface(const EffectSpec& spec) { return spec.kind == kEmpirical; }

bool is_surface(const EffectName& name) { return name.kind == kEmpirical; }

EffectSpec surface_spec(const std::string& target, const std::string& drivers) {
  return effect_spec(kEmpirical, {{"target", target}, {"drivers", drivers}});
}

const EffectKind& empirical_effect() {
  static const EmpiricalKind kind;
  return kind;
}

}  // namespace volcal
