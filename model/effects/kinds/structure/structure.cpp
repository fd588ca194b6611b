// Behaviour that is not rigid: an error motion that depends on two other axes, or on the tool it carries.
#include <algorithm>
#include <cmath>
#include <set>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

std::unique_ptr<FormulaEffect> make_product_coupling(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const AxisName first = table.axis("axis");
  const AxisName second = table.axis("second_axis");
  if (first == second)
    table.fail("its two axes are the same", "use axis-coupling with shape = \"quadratic\"");
  const EffectDriver driver({position_of(std::min(first, second)), position_of(std::max(first, second))});
  const std::string label = symbol.name() + " by " + driver.name();
  return std::make_unique<FormulaEffect>(
      EffectName{"product-coupling", symbol, driver, "product"},
      std::vector{motion_amplitude(table, label, symbol, "per_m2")},
      [first, second](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return positions_from_home(view, first).cwiseProduct(positions_from_home(view, second));
      },
      [symbol, first, second, label](const Campaign& campaign, const SourcePlace& place) {
        for (const AxisName axis : {symbol.axis, first, second}) check_axis(campaign, axis, label, place);
      });
}

/// A displacement by the product of two positions is the same whichever axis it is said to belong to: it is
/// offered once, under the first of the two.
bool said_elsewhere(ErrorSymbol symbol, AxisName first) {
  return !is_rotation(symbol.component) && symbol.axis != first;
}

std::vector<EffectSpec> product_couplings(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  const auto axes = campaign.machine.linear_axes();
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    for (const AxisName first : axes) {
      for (const AxisName second : axes) {
        if (first >= second || said_elsewhere(symbol, first)) continue;
        specs.push_back(
            effect_spec("product-coupling", {{"symbol", symbol.name()},
                                             {"axis", std::string(1, letter_of(first))},
                                             {"second_axis", std::string(1, letter_of(second))}}));
      }
    }
  }
  return specs;
}

/// One cause for all tools: what carries them yields the more, the longer they are.
std::unique_ptr<FormulaEffect> make_load_by_length(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string label = symbol.name() + " by the tool's length";
  return std::make_unique<FormulaEffect>(
      EffectName{"tool-load", symbol, Variable{Variable::Kind::ToolLength}, "linear"},
      std::vector{motion_amplitude(table, label, symbol, "per_m")},
      [](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return constant(view, view.campaign.machine.tools[view.setup.tool].offset.norm());
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
}

std::unique_ptr<FormulaEffect> make_tool_load(const EffectTable& table) {
  if (!table.spec.options.has("tool")) return make_load_by_length(table);
  const ErrorSymbol symbol = table.symbol();
  const std::string tool = table.text("tool", "add tool = \"NAME\"");
  const std::string label = symbol.name() + " by tool " + tool;
  return std::make_unique<FormulaEffect>(
      EffectName{"tool-load", symbol, Variable{.kind = Variable::Kind::Tool, .subject = tool}, "step"},
      std::vector{motion_amplitude(table, label, symbol, "")},
      [tool](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const bool carried = view.campaign.machine.tools[view.setup.tool].name == tool;
        return constant(view, carried ? 1.0 : 0.0);
      },
      [symbol, tool, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        check_tool(campaign, tool, place);
      });
}

bool differ_in_length(const Campaign& campaign, const std::vector<std::string>& tools) {
  std::set<long long> lengths;
  for (const Tool& tool : campaign.machine.tools) {
    if (std::ranges::find(tools, tool.name) != tools.end())
      lengths.insert(std::llround(tool.offset.norm() / kMetrePerMillimetre));
  }
  return lengths.size() == tools.size();
}

/// Rotations only: what a tool's weight displaces is an error of its offset. Between two tools any load is
/// one by length; it is offered for three or more.
std::vector<EffectSpec> tool_loads(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  const auto tools = tools_in_use(campaign);
  if (tools.size() < 2) return specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    if (!is_rotation(symbol.component)) continue;
    for (const std::string& tool : tools) {
      specs.push_back(effect_spec("tool-load", {{"symbol", symbol.name()}, {"tool", tool}}));
    }
    if (tools.size() > 2 && differ_in_length(campaign, tools))
      specs.push_back(effect_spec("tool-load", {{"symbol", symbol.name()}}));
  }
  return specs;
}

/// And one by length, which candidates have for three tools alone.
std::vector<EffectSpec> tool_load_examples(const Campaign& campaign) {
  std::vector<EffectSpec> specs = tool_loads(campaign);
  const auto of_length = [](const EffectSpec& spec) { return !spec.options.has("tool"); };
  if (specs.empty() || std::ranges::any_of(specs, of_length)) return specs;
  const std::string symbol = specs.front().options.text("symbol").value();
  specs.push_back(effect_spec("tool-load", {{"symbol", symbol}}));
  return specs;
}

}  // namespace

const EffectKind& product_coupling_effect() {
  static const FormulaKind kind(
      {.kind = "product-coupling",
       .summary = "an error motion depends on the product of two axes' positions, counted from their homes",
       .plain = "An error motion changes with two other axes at once, as their product: the machine twists "
                "as it moves.",
       .usual_causes = "a ram that leans out of a column which moves itself; a table off its centre on a bed "
                       "that twists; levelling at one corner",
       .source = "ISO/TR 16907:2015, 7.4.2 (non-rigid behaviour)",
       .polynomial = true,
       .keys = joined(
           {{symbol_key("error motion that changes: EAX ..."), axis_key("axis", "first axis of the product"),
             axis_key("second_axis", "second axis of the product")},
            motion_amplitude_keys({"per_m2"}, "change per metre of each axis")})},
      make_product_coupling, product_couplings);
  return kind;
}

const EffectKind& tool_load_effect() {
  static const FormulaKind kind(
      {.kind = "tool-load",
       .summary =
           "the weight of a tool tilts what carries it: an error motion is larger by this with the tool, or "
           "with every tool in proportion to its length",
       .plain = "An error motion differs between tools: the machine gives way under a heavy or long one.",
       .usual_causes = "a heavy tool, head or reflector holder; a spindle or quill that sags when it is out; "
                       "weak clamping of the head",
       .source = "ISO/TR 16907:2015, 8.6 (workpiece and tool mass)",
       .polynomial = true,
       .keys = joined(
           {{symbol_key("error motion that changes: EAZ ..."),
             text_key("tool", "name of the tool; absent = all, by their length", false)},
            motion_amplitude_keys({"", "per_m"}, "change with the tool, or per metre of its length")})},
      make_tool_load, tool_loads, tool_load_examples);
  return kind;
}

}  // namespace volcal
