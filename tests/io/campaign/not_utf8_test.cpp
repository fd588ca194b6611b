/// Names of files and columns are bytes; JSON and TOML are UTF-8. A name must not cost the result.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/schema_samples.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/text/json_text.h"

namespace volcal {
namespace {

const std::string kName = "Gr\xF6\xDF\x65";  // latin1
const std::string kReplaced = "Gr\uFFFD\uFFFDe";

TEST(NotUtf8, BecomesTheReplacementCharacterInJson) {
  const nlohmann::json document = {{"written", kName}};
  const auto read = nlohmann::json::parse(json_text(document, 2));
  EXPECT_EQ(read.at("written").get<std::string>(), kReplaced);
  EXPECT_EQ(utf8_text("plain \u00E4"), "plain \u00E4");
}

TEST(NotUtf8, LeavesATomlFileReadable) {
  const Machine machine = parse_machine(testing::sample_machine(), "machine.toml");
  const std::string text =
      model_toml(ModelSpec{}, "machine.toml", "Identified from " + kName + "\x1B[31m/campaign");
  EXPECT_NO_THROW(parse_model(text, "model.toml", machine)) << text;
  Machine named = machine;
  named.name = kName;
  EXPECT_EQ(parse_machine(machine_toml(named), "machine.toml").name, kReplaced);
}

}  // namespace
}  // namespace volcal
