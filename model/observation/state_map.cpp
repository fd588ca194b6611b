#include "volcal/model/observation/state_map.h"

#include <algorithm>

#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {
namespace {

using Octet = StateMap::Octet;
constexpr int kVectors = StateMap::kVectors;
constexpr int kMostComponents = kStateSize + kMaxChannels;
constexpr int kAtOnce = 3;  // components of a pass
constexpr int kNumbersOfArm = 3;
constexpr int kFunctionsWithArm = 6;  // d, e

using Vectors [[gnu::vector_size(sizeof(Octet)), gnu::may_alias]] = double;

/// Numbers of a group's functions at the readings of a block.
template <class Numbers>
struct GroupTable {
  Numbers* numbers;
  const std::uint32_t* position;  ///< per reading
  int count;                      ///< functions
};

/// A block's readings. Slots: the functions of every group without arms, then the parameters besides.
template <class Numbers>
struct Sweep {
  std::vector<GroupTable<Numbers>> arms;
  std::vector<GroupTable<Numbers>> groups;
  std::vector<Numbers*> besides;
  const double* coefficients;  ///< readings x (arms, then slots x components)
  std::ptrdiff_t arm_numbers;  ///< of a reading
  int slots;
  int components;
  int size;
};

template <class Numbers>
[[gnu::always_inline]] inline const double* coefficients_of(const Sweep<Numbers>& sweep, int i) {
  return sweep.coefficients +
         i * (sweep.arm_numbers + static_cast<std::ptrdiff_t>(sweep.slots) * sweep.components);
}

/// Calls use(six numbers, arm) for the groups with arms; only where the point alone is seen.
template <class Numbers, class Use>
[[gnu::always_inline]] inline void for_each_arm(const Sweep<Numbers>& sweep, int i, const Use& use) {
  const double* arm = coefficients_of(sweep, i);
  for (const GroupTable<Numbers>& group : sweep.arms) {
    use(group.numbers + static_cast<std::ptrdiff_t>(group.position[i]) * kFunctionsWithArm, arm);
    arm += kNumbersOfArm;
  }
}

/// Calls use(number, coefficients) for the slots of reading `i`, coefficients of `first` and later
/// components.
template <class Numbers, class Use>
[[gnu::always_inline]] inline void for_each_slot(const Sweep<Numbers>& sweep, int i, int first,
                                                 const Use& use) {
  const double* coefficient = coefficients_of(sweep, i) + sweep.arm_numbers + first;
  for (const GroupTable<Numbers>& group : sweep.groups) {
    Numbers* number = group.numbers + static_cast<std::ptrdiff_t>(group.position[i]) * group.count;
    for (int slot = 0; slot < group.count; ++slot, coefficient += sweep.components)
      use(*number++, coefficient);
  }
  for (Numbers* number : sweep.besides) {
    use(*number, coefficient);
    coefficient += sweep.components;
  }
}

/// Lanes of components `first` to first + kCount: constant + coefficients times values.
template <int kCount>
[[gnu::always_inline]] inline void combine(const Sweep<const Octet>& sweep, int first, const Lanes* constant,
                                           Lanes* const* seen) {
  for (int i = 0; i < sweep.size; ++i) {
    Vectors sum[kCount];
    for (int k = 0; k < kCount; ++k) sum[k] = Vectors{} + constant[first + k].value[i];
    if constexpr (kCount == kNumbersOfArm) {
      for_each_arm(sweep, i, [&](const Octet* six, const double* arm) {
        const auto* d = reinterpret_cast<const Vectors*>(six);
        const auto* e = d + kNumbersOfArm;
        sum[0] += d[0] + (e[1] * arm[2] - e[2] * arm[1]);
        sum[1] += d[1] + (e[2] * arm[0] - e[0] * arm[2]);
        sum[2] += d[2] + (e[0] * arm[1] - e[1] * arm[0]);
      });
    }
    for_each_slot(sweep, i, first, [&](const Octet& number, const double* coefficient) {
      const auto& values = reinterpret_cast<const Vectors&>(number);
      for (int k = 0; k < kCount; ++k) sum[k] += values * coefficient[k];
    });
    for (int k = 0; k < kCount; ++k) {
      for (int v = 0; v < kVectors; ++v) seen[(first + k) * kVectors + v]->value[i] = sum[k][v];
    }
  }
}

VOLCAL_VECTOR_LOOPS void combine_all(const Sweep<const Octet>& sweep, const Lanes* constant,
                                     Lanes* const* seen) {
  for (int first = 0; first < sweep.components; first += kAtOnce) {
    switch (sweep.components - first) {
      case 1:
        combine<1>(sweep, first, constant, seen);
        break;
      case 2:
        combine<2>(sweep, first, constant, seen);
        break;
      default:
        combine<kAtOnce>(sweep, first, constant, seen);
    }
  }
}

/// numbers += coefficients times the loads on components `first` to first + kCount.
template <int kCount>
[[gnu::always_inline]] inline void spread(const Sweep<Octet>& sweep, int first, const Lanes* const* load) {
  for (int i = 0; i < sweep.size; ++i) {
    Octet own[kCount];
    for (int k = 0; k < kCount; ++k) {
      for (int v = 0; v < kVectors; ++v) own[k].value[v] = load[(first + k) * kVectors + v]->value[i];
    }
    Vectors loads[kCount];
    for (int k = 0; k < kCount; ++k) loads[k] = reinterpret_cast<const Vectors&>(own[k]);
    if constexpr (kCount == kNumbersOfArm) {
      for_each_arm(sweep, i, [&](Octet* six, const double* arm) {
        auto* d = reinterpret_cast<Vectors*>(six);
        auto* e = d + kNumbersOfArm;
        for (int k = 0; k < kNumbersOfArm; ++k) d[k] += loads[k];
        e[0] += loads[2] * arm[1] - loads[1] * arm[2];
        e[1] += loads[0] * arm[2] - loads[2] * arm[0];
        e[2] += loads[1] * arm[0] - loads[0] * arm[1];
      });
    }
    for_each_slot(sweep, i, first, [&](Octet& number, const double* coefficient) {
      auto sum = reinterpret_cast<Vectors&>(number);
      for (int k = 0; k < kCount; ++k) sum += loads[k] * coefficient[k];
      reinterpret_cast<Vectors&>(number) = sum;
    });
  }
}

VOLCAL_VECTOR_LOOPS void spread_all(const Sweep<Octet>& sweep, const Lanes* const* load) {
  for (int first = 0; first < sweep.components; first += kAtOnce) {
    switch (sweep.components - first) {
      case 1:
        spread<1>(sweep, first, load);
        break;
      case 2:
        spread<2>(sweep, first, load);
        break;
      default:
        spread<kAtOnce>(sweep, first, load);
    }
  }
}

/// Lanes of a component of what is seen; `components` of the tool come first.
template <class Seen>
auto* component(Seen& seen, int number, int of_tool) {
  return number < of_tool ? &state_component(seen.tool, number) : &seen.offset[number - of_tool];
}

int tool_components(const MeasurementModel& model, std::size_t setup) {
  return model.bound(setup).sees_rotation() ? kStateSize : 3;
}

/// Component by component, all vectors of one after another.
template <class Lane, class Seen>
void list_lanes(Seen* seen, int components, int of_tool, Lane** lanes) {
  for (int k = 0; k < components; ++k) {
    for (int v = 0; v < kVectors; ++v) *lanes++ = component(seen[v], k, of_tool);
  }
}

template <class Numbers, class Functions, class Parameters>
Sweep<Numbers> sweep_of(const MeasurementModel& model, const ReadingBlock& block,
                        const std::vector<char>& has_arm, Functions& functions, Parameters& parameters,
                        const std::vector<int>& besides) {
  Sweep<Numbers> sweep{};
  for (std::size_t g = 0; g < functions.size(); ++g) {
    const FunctionGroup& group = model.layout().groups[g];
    const GroupTable<Numbers> table{
        functions[g].data(),
        model.tables().entries(block.setup, index_of(group.axis)).data() + block.first_row, group.count()};
    if (has_arm[g] != 0) {
      sweep.arms.push_back(table);
      sweep.arm_numbers += kNumbersOfArm;
    } else {
      sweep.groups.push_back(table);
      sweep.slots += group.count();
    }
  }
  for (const int parameter : besides)
    sweep.besides.push_back(&parameters[static_cast<std::size_t>(parameter)]);
  sweep.slots += static_cast<int>(besides.size());
  sweep.size = block.size;
  return sweep;
}

/// Coefficients of three components to d and e, where point += d + e x arm; `at(component, function)`.
template <class At>
Eigen::Vector3d arm_of(const At& at) {
  return {at(1, 5), at(2, 3), at(0, 4)};
}

template <class At>
bool is_of_arm(const At& at) {
  const Eigen::Vector3d arm = arm_of(at);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(k), turned = unit.cross(arm);
    for (int component = 0; component < 3; ++component) {
      if (at(component, k) != unit[component] || at(component, 3 + k) != turned[component]) return false;
    }
  }
  return true;
}

/// `count` functions at a position, of coefficients that stand function by function from `from` on.
VOLCAL_VECTOR_LOOPS void evaluate_functions(const Octet* from, const double* basis, int support, int count,
                                            Octet* to) {
  for (int slot = 0; slot < count; ++slot) {
    Vectors sum{};
    for (int j = 0; j < support; ++j)
      sum += reinterpret_cast<const Vectors&>(from[j * count + slot]) * basis[j];
    reinterpret_cast<Vectors&>(to[slot]) = sum;
  }
}

/// The adjoint.
VOLCAL_VECTOR_LOOPS void gather_functions(const Octet* from, const double* basis, int support, int count,
                                          Octet* to) {
  for (int j = 0; j < support; ++j) {
    for (int slot = 0; slot < count; ++slot, ++to)
      reinterpret_cast<Vectors&>(*to) += reinterpret_cast<const Vectors&>(from[slot]) * basis[j];
  }
}

}  // namespace

bool StateMap::is_exact_for(const MeasurementModel& model) {
  const CampaignBinding& binding = model.binding();
  return !binding.effect_tilts_floor &&
         std::ranges::all_of(binding.effects, [](const auto& effect) { return effect.free_shape.empty(); });
}

StateMap::StateMap(const BlockModel& model) : model_(model) {
  const MeasurementModel& measured = model.model();
  for (const SetupBinding& setup : measured.binding().setups) {
    std::vector<int>& besides = besides_.emplace_back(model.shared_parameters());
    for (int k = 0; k < 3 && setup.tool_error >= 0; ++k) besides.push_back(setup.tool_error + k);
  }
  const TabulatedFunctions zero = measured.tabulate(Eigen::VectorXd::Zero(measured.layout().size));
  BlockLevers levers = model.make_levers();
  for (const ReadingBlock& block : model.blocks()) add_block(block, zero, levers);
}

void StateMap::add_block(const ReadingBlock& block, const TabulatedFunctions& zero, BlockLevers& levers) {
  const MeasurementModel& measured = model_.model();
  const int of_tool = tool_components(measured, block.setup);
  const int channels = measured.binding().effects.empty() ? 0 : measured.bound(block.setup).channels();
  BlockLinearization unused;
  model_.find_state(block, Eigen::VectorXd::Zero(measured.layout().size), zero, levers, unused);
  Place place{of_tool + channels, coefficients_.size(), constants_.size(), {}};
  Seen at_zero{levers.tool, {}};
  for (int k = 0; k < place.components; ++k) constants_.push_back(*component(at_zero, k, of_tool));
  Rows rows(static_cast<std::size_t>(place.components),
            std::vector<double>(static_cast<std::size_t>(model_.row_width() * block.size)));
  for (int k = 0; k < place.components; ++k) {
    model_.make_rows_of_state(block, k < of_tool ? k : kStateSize + k - of_tool, levers,
                              rows[static_cast<std::size_t>(k)].data());
  }
  for (std::size_t g = 0; g < model_.group_count(); ++g)
    place.has_arm.push_back(has_arm(block, g, rows) ? 1 : 0);
  places_.push_back(std::move(place));
  keep_rows(block, rows);
}

/// Whether the group's functions are the six motions of a joint, whose rows are those of an arm to the bit.
bool StateMap::has_arm(const ReadingBlock& block, std::size_t group, const Rows& rows) const {
  const int count = model_.model().layout().groups[group].count();
  if (rows.size() != kNumbersOfArm || count != kFunctionsWithArm) return false;
  const std::ptrdiff_t width = model_.row_width();
  for (int i = 0; i < block.size; ++i) {
    const std::ptrdiff_t first = i * width + model_.segment_begin(group);
    const auto at = [&](int component, int function) {
      return rows[static_cast<std::size_t>(component)][static_cast<std::size_t>(first + function)];
    };
    if (!is_of_arm(at)) return false;
  }
  return true;
}

void StateMap::keep_rows(const ReadingBlock& block, const Rows& rows) {
  const Place& place = places_.back();
  const std::size_t groups = model_.group_count();
  const int shared = model_.model().shared_tail_size();
  const int own = static_cast<int>(besides_[block.setup].size()) - shared;
  for (int i = 0; i < block.size; ++i) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(i) * model_.row_width();
    const auto number = [&](int component, std::ptrdiff_t at) {
      return rows[static_cast<std::size_t>(component)][static_cast<std::size_t>(row + at)];
    };
    const auto keep = [&](std::size_t segment, int count) {
      for (int slot = 0; slot < count; ++slot) {
        for (int k = 0; k < place.components; ++k)
          coefficients_.push_back(number(k, model_.segment_begin(segment) + slot));
      }
    };
    for (std::size_t g = 0; g < groups; ++g) {
      if (place.has_arm[g] == 0) continue;
      const Eigen::Vector3d arm =
          arm_of([&](int k, int function) { return number(k, model_.segment_begin(g) + function); });
      coefficients_.insert(coefficients_.end(), arm.begin(), arm.end());
    }
    for (std::size_t g = 0; g < groups; ++g) {
      if (place.has_arm[g] == 0) keep(g, model_.model().layout().groups[g].count());
    }
    keep(groups, shared);
    keep(groups + 1, own);
  }
}

StateMap::Numbers::Numbers(const StateMap& map) {
  const MeasurementModel& model = map.model_.model();
  for (std::size_t g = 0; g < model.layout().groups.size(); ++g) {
    const auto count = static_cast<std::size_t>(model.layout().groups[g].count());
    functions_.emplace_back(count * model.tables().positions(g));
  }
  parameters_.resize(static_cast<std::size_t>(model.layout().size));
}

void StateMap::Numbers::set_zero() {
  for (auto& functions : functions_) std::ranges::fill(functions, Octet{});
  std::ranges::fill(parameters_, Octet{});
}

void StateMap::set_parameters(const Eigen::MatrixXd& parameters, Numbers& values) const {
  std::ranges::fill(values.parameters_, Octet{});
  for (Eigen::Index v = 0; v < parameters.cols(); ++v) {
    for (Eigen::Index i = 0; i < parameters.rows(); ++i)
      values.parameters_[static_cast<std::size_t>(i)].value[v] = parameters(i, v);
  }
  const MeasurementModel& model = model_.model();
  for (std::size_t g = 0; g < values.functions_.size(); ++g) {
    const FunctionGroup& group = model.layout().groups[g];
    const int support = group.basis->support(), count = group.count();
    Octet* to = values.functions_[g].data();
    for (std::size_t position = 0; position < model.tables().positions(g); ++position, to += count) {
      const double* const basis = model.tables().values(g, support, position);
      evaluate_functions(&values.of_parameter(group.index(model.tables().start(g, position), 0)), basis,
                         support, count, to);
    }
  }
}

void StateMap::find(std::size_t block, const Numbers& values, Seen* seen) const {
  const ReadingBlock& readings = model_.blocks()[block];
  const Place& place = places_[block];
  auto sweep = sweep_of<const Octet>(model_.model(), readings, place.has_arm, values.functions_,
                                     values.parameters_, besides_[readings.setup]);
  sweep.coefficients = coefficients_.data() + place.coefficients;
  sweep.components = place.components;
  Lanes* lanes[kMostComponents * kVectors];
  list_lanes(seen, place.components, tool_components(model_.model(), readings.setup), lanes);
  const Lanes* const constant = constants_.data() + place.constants;
  combine_all(sweep, constant, lanes);
  for (int k = 0; k < place.components; ++k) {
    for (int v = 0; v < kVectors; ++v)
      std::fill(lanes[k * kVectors + v]->value + readings.size, lanes[k * kVectors + v]->value + kLanes,
                constant[k].value[readings.size - 1]);
  }
}

void StateMap::add_work(std::size_t block, const Seen* load, Numbers& sums) const {
  const ReadingBlock& readings = model_.blocks()[block];
  const Place& place = places_[block];
  auto sweep = sweep_of<Octet>(model_.model(), readings, place.has_arm, sums.functions_, sums.parameters_,
                               besides_[readings.setup]);
  sweep.coefficients = coefficients_.data() + place.coefficients;
  sweep.components = place.components;
  const Lanes* lanes[kMostComponents * kVectors];
  list_lanes(load, place.components, tool_components(model_.model(), readings.setup), lanes);
  spread_all(sweep, lanes);
}

Eigen::MatrixXd StateMap::gradients(const Numbers& sums) const {
  const MeasurementModel& model = model_.model();
  std::vector<Octet> gradient = sums.parameters_;
  for (std::size_t g = 0; g < sums.functions_.size(); ++g) {
    const FunctionGroup& group = model.layout().groups[g];
    const int support = group.basis->support(), count = group.count();
    const Octet* from = sums.functions_[g].data();
    for (std::size_t position = 0; position < model.tables().positions(g); ++position, from += count) {
      const double* const basis = model.tables().values(g, support, position);
      gather_functions(
          from, basis, support, count,
          &gradient[static_cast<std::size_t>(group.index(model.tables().start(g, position), 0))]);
    }
  }
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(gradient.size()), kVectors);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    for (int v = 0; v < kVectors; ++v) columns(i, v) = gradient[static_cast<std::size_t>(i)].value[v];
  }
  return columns;
}

}  // namespace volcal
