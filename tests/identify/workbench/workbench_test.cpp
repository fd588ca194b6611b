// The workbench as its page speaks with it, against a session that does the same.

#include "volcal/identify/workbench/workbench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/workbench/session_json.h"

namespace volcal::workbench {
namespace {

using testing::ScratchFolder;
namespace fs = std::filesystem;

constexpr const char* kReversalOfX = "reversal:EXX:dir_x:step";

/// JSON and columns of an answer.
struct Framed {
  Json json;
  std::vector<std::vector<float>> columns;

  explicit Framed(const std::string& body) {
    std::uint32_t length = 0;
    std::memcpy(&length, body.data(), sizeof length);
    EXPECT_EQ(length % 4, 0U);
    json = Json::parse(body.substr(4, length));
    const std::size_t count = json["columns"].size(), bytes = body.size() - 4 - length;
    EXPECT_EQ(bytes % (4 * count), 0U);
    for (std::size_t k = 0; k < count; ++k) {
      columns.emplace_back(bytes / 4 / count);
      std::memcpy(columns.back().data(), body.data() + 4 + length + k * (bytes / count), bytes / count);
    }
  }
};

/// A model of few parameters, for tests that ask for no numbers: a fit takes a tenth of a second.
std::string quick_model(const ScratchFolder& folder) {
  const fs::path path = folder.path() / "quick-model.toml";
  std::ofstream(path) << "format = \"volcal-model-1\"\n[functions]\n"
                         "default = { basis = \"bspline\", degree = 3, knots = 3 }\n";
  return path.string();
}

/// A workbench on a copy of a campaign, and a page of it.
struct Page {
  ScratchFolder folder;
  std::string campaign;
  std::unique_ptr<Workbench> bench;

  explicit Page(bool confirm = true, bool read_only = false, bool quick = false) {
    fs::copy(fs::path(VOLCAL_SOURCE_DIR) / "datasets/hidden/21", folder.path() / "campaign");
    campaign = (folder.path() / "campaign/campaign.toml").string();
    WorkbenchOptions options;
    options.campaign = campaign;
    options.output = (folder.path() / "out").string();
    options.threads = 1;
    options.confirm_behind = confirm;
    options.read_only = read_only;
    if (quick) options.model = quick_model(folder);
    bench = std::make_unique<Workbench>(options);
    bench->wait_until_idle();
  }
  Answer ask(const std::string& request, const Json& body = Json::object(), const std::string& tab = "one") {
    return bench->answer(request, body.dump(), tab);
  }
  Json told(const std::string& request, const Json& body = Json::object()) {
    const Answer answer = ask(request, body);
    EXPECT_EQ(answer.status, 200) << request << ": " << answer.body;
    return Json::parse(answer.body);
  }
  Json state() { return told("state"); }
};

/// Opened once; tests leave it at its first model.
class WorkbenchOnACampaign : public ::testing::Test {
 protected:
  static Page& page() {
    static Page opened(false);
    return opened;
  }
  void TearDown() override { page().told("go", {{"model", 0}}); }
};

TEST_F(WorkbenchOnACampaign, TellsWhatItHolds) {
  const Json state = page().state();
  EXPECT_EQ(state["phase"], "ready");
  EXPECT_EQ(state["campaign"]["observations"], 1536);
  EXPECT_EQ(state["models"].size(), 1U);
  EXPECT_EQ(state["models"][0]["standing"], "fitted");
  EXPECT_GT(state["models"][0]["figures"]["rms_heldout_um"], 0.5);
  EXPECT_TRUE(state["busy"].is_null());
  EXPECT_FALSE(state["can_undo"]);
}

TEST_F(WorkbenchOnACampaign, SendsColumns) {
  const Framed framed(
      page().ask("columns", {{"names", {"x", "residual@0", "sigma@0", "heldout", "dir_x"}}}).body);
  ASSERT_EQ(framed.columns.size(), 5U);
  ASSERT_EQ(framed.columns[0].size(), 1536U);
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < 1536; ++i) {
    EXPECT_EQ(std::abs(framed.columns[4][i]), 1.0F);
    if (framed.columns[3][i] != 1.0F) continue;
    squares += framed.columns[1][i] * framed.columns[1][i];
    count += 1.0;
  }
  EXPECT_NEAR(count, 153.6, 20.0) << "a tenth is held out";
  EXPECT_NEAR(std::sqrt(squares / count),
              page().state()["models"][0]["figures"]["rms_heldout_um"].get<double>(), 1e-4);
  EXPECT_EQ(page().ask("columns", {{"names", {"residual@7"}}}).status, 422);
  EXPECT_EQ(page().ask("columns", {{"names", {"nothing"}}}).status, 422);
  EXPECT_EQ(page().ask("columns", {{"names", 3}}).status, 400);
}

TEST_F(WorkbenchOnACampaign, RanksSuspectsInPlainWords) {
  const Json ranking = page().told("rank");
  const Json& first = ranking["effects"][0];
  EXPECT_EQ(first["name"], kReversalOfX);
  EXPECT_THAT(first["words"].get<std::string>(), ::testing::HasSubstr("stops at two different places"));
  EXPECT_FALSE(first["causes"].get<std::string>().empty());
  EXPECT_GT(first["amplitudes"][0]["value"], 3.0 * first["amplitudes"][0]["u95"].get<double>());
  EXPECT_LT(first["fall"]["to_um"], first["fall"]["from_um"]);
  EXPECT_THAT(first["rivals"].dump(), ::testing::HasSubstr("pre-travel EXX"));
  EXPECT_GT(ranking["tests"], 100);
}

TEST_F(WorkbenchOnACampaign, APreviewIsWhatAddingGives) {
  const Framed preview(page().ask("preview", {{"effect", kReversalOfX}}).body);
  page().told("add", {{"effect", kReversalOfX}});
  const Json state = page().state();
  const std::string model = std::to_string(state["current"].get<int>());
  EXPECT_EQ(state["models"].back()["standing"], "preview");
  EXPECT_TRUE(state["can_undo"]);
  const Framed added(page().ask("columns", {{"names", {"residual@" + model}}}).body);
  for (std::size_t i = 0; i < 1536; ++i) EXPECT_NEAR(added.columns[0][i], preview.columns[0][i], 1e-3);
  EXPECT_EQ(page().ask("add", {{"effect", kReversalOfX}}).status, 422) << "it is in the model";
}

TEST_F(WorkbenchOnACampaign, DrawsWavesAndMeaning) {
  const Json waves = page().told("periodogram", {{"variable", "x"}});
  EXPECT_EQ(waves["period"].size(), waves["power"].size());
  EXPECT_TRUE(page().told("polar")["circles"].empty()) << "no bar was in use";
  EXPECT_TRUE(page().told("rotary")["rotary"].is_null()) << "the machine has no rotary axis";
  const Json meaning = page().told("meaning");
  double percent = 0.0;
  for (const Json& cause : meaning["share"]) percent += cause["percent"].get<double>();
  EXPECT_NEAR(percent, 100.0, 2.0);
}

TEST_F(WorkbenchOnACampaign, AFormulaNamesItsErrorAndItsPlace) {
  const Answer wrong = page().ask("formula", {{"text", "EXX += dir_q * x"}});
  EXPECT_EQ(wrong.status, 422);
  const Json error = Json::parse(wrong.body);
  EXPECT_EQ(error["column"], 8);
  EXPECT_FALSE(error["remedy"].get<std::string>().empty());
  const std::pair<const char*, int> refused[] = {
      {"EXX += dir_x * (T_colum - 20)", 17}, {"EXX += log(x)", 8}, {"EXU += x", 1}};
  for (const auto& [text, column] : refused) {
    const Answer answer = page().ask("formula", {{"text", text}});
    EXPECT_EQ(answer.status, 422) << text;
    EXPECT_EQ(Json::parse(answer.body)["column"], column) << answer.body;
    EXPECT_THAT(answer.body, ::testing::Not(::testing::HasSubstr("at character"))) << "counted elsewhere";
  }
  const int tried = page().state()["tried"];
  const Framed right(page().ask("formula", {{"text", "EXX += dir_x"}}).body);
  EXPECT_EQ(right.json["tried"], tried + 1);
  EXPECT_NEAR(right.json["rivals"][0]["cosine"].get<double>(), 1.0, 1e-6) << "it is the reversal";
  EXPECT_EQ(right.columns.size(), 2U);
  EXPECT_EQ(page().state()["commands"].back(), "formula EXX += dir_x");
  const Json words = page().told("complete", {{"text", "EXX += dir"}, {"at", 10}});
  EXPECT_EQ(words["from"], 7);
  EXPECT_EQ(words["words"][0]["word"], "dir_x");
}

TEST_F(WorkbenchOnACampaign, WhatTheReadingsDoNotShowHasNoNumberAndARemedy) {
  for (const char* formula : {"EXX += 0 * x", "EXX += x"}) {
    const Json effect = Framed(page().ask("formula", {{"text", formula}}).body).json["effect"];
    EXPECT_TRUE(effect["amplitudes"][0]["value"].is_null()) << formula;
    EXPECT_TRUE(effect["amplitudes"][0]["u95"].is_null()) << formula;
    EXPECT_FALSE(effect["can_be_added"]) << formula;
    EXPECT_THAT(effect["remedy"].get<std::string>(), ::testing::StartsWith("The readings do not show it: "));
    const Answer added = page().ask("add", {{"effect", effect["name"]}});
    EXPECT_EQ(added.status, 422) << formula;
    EXPECT_THAT(added.body, ::testing::HasSubstr("not visible"));
  }
  const Json hidden = page().told("rank")["not_visible"];
  ASSERT_GE(hidden.size(), 2U);
  for (const Json& effect : hidden)
    EXPECT_EQ(effect.contains("remedy"), effect["kind"] != "resolution") << effect["name"];
  EXPECT_EQ(page().ask("formula", {{"text", "EXX += dir_x * 1e300"}}).status, 422);
}

TEST_F(WorkbenchOnACampaign, APageThatReadsTriesNoFormula) {
  page().told("take");
  const Json before = page().state();
  EXPECT_EQ(page().ask("formula", {{"text", "EXX += 3 * dir_x"}}, "two").status, 409);
  EXPECT_EQ(page().state()["commands"], before["commands"]);
  EXPECT_EQ(page().state()["tried"], before["tried"]);
  EXPECT_EQ(page().ask("preview", {{"effect", kReversalOfX}}, "two").status, 200) << "it may look";
}

TEST_F(WorkbenchOnACampaign, OnePageWrites) {
  page().told("add", {{"effect", kReversalOfX}});
  EXPECT_EQ(page().ask("undo", {}, "two").status, 409);
  EXPECT_EQ(page().ask("take", {}, "two").status, 200);
  EXPECT_EQ(page().ask("undo").status, 409);
  EXPECT_EQ(page().ask("take").status, 200);
  EXPECT_EQ(page().ask("undo").status, 200);
}

TEST_F(WorkbenchOnACampaign, RequestsThatAreNoneAreRefused) {
  EXPECT_EQ(page().ask("jump").status, 404);
  EXPECT_EQ(page().bench->answer("rank", "{", "one").status, 400);
  EXPECT_EQ(page().bench->answer("add", "[]", "one").status, 400);
  EXPECT_EQ(page().ask("add", {{"effect", "nothing"}}).status, 422);
  EXPECT_EQ(page().ask("go", {{"model", 1000}}).status, 422);
  EXPECT_EQ(page().ask("leave-out", {{"observations", {1}}, {"reason", " "}}).status, 400);
  EXPECT_EQ(page().ask("leave-out", {{"observations", {9999999}}, {"reason", "why"}}).status, 422);
  EXPECT_EQ(page().ask("export", {{"what", "../../etc"}}).status, 422);
}

/// What was under way, as the page was told.
std::vector<std::string> told_of_work(Page& page, EventHub::Line& line) {
  page.bench->events().publish("end", "{}");
  std::vector<std::string> work;
  for (std::optional<std::string> event = line.next(); event && !event->starts_with("event: end");
       event = line.next()) {
    const std::size_t at = event->find("data: ");
    if (!event->starts_with("event: state") || at == std::string::npos) continue;
    const Json busy = Json::parse(event->substr(at + 6))["busy"];
    if (busy.is_object() && (work.empty() || work.back() != busy["what"])) work.push_back(busy["what"]);
  }
  return work;
}

TEST(WorkbenchDoors, PreparesWhatIsLikelyToBeAskedNext) {
  Page page;
  const auto line = page.bench->events().connect();
  page.told("go", {{"model", 0}});
  page.bench->wait_until_idle();
  EXPECT_THAT(told_of_work(page, *line), ::testing::ElementsAre("scan", "prepare"));
  page.told("go", {{"model", 0}});
  page.bench->wait_until_idle();
  EXPECT_THAT(told_of_work(page, *line), ::testing::IsEmpty()) << "it is there";
  page.told("add", {{"effect", kReversalOfX}});
  while (page.state()["models"][1]["standing"] == "preview")
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  page.told("undo");
  page.told("cancel");
  page.bench->wait_until_idle();
  EXPECT_TRUE(page.state()["busy"].is_null()) << "not begun again once it is cancelled";
}

/// The page, the library and the command line: the same numbers to the bit.
TEST(WorkbenchDoors, GiveTheSameNumbers) {
  Page page;
  page.told("add", {{"effect", kReversalOfX}});
  page.bench->wait_until_idle();
  ASSERT_EQ(page.ask("formula", {{"text", "EZX += x * z"}}).status, 200);
  const Json state = page.state();
  EXPECT_EQ(state["commands"][0], std::string("add ") + kReversalOfX);
  EXPECT_EQ(state["commands"][1], "refit 1");
  EXPECT_EQ(state["commands"][2], "confirm 1");
  const Json& confirmed = state["models"][1];
  EXPECT_TRUE(confirmed["standing"] == "fitted" || confirmed["standing"] == "contradicted");
  EXPECT_EQ(confirmed["standing"] == "contradicted", confirmed["contradiction"].is_string())
      << "where the preview did not hold it is said in words";
  EXPECT_LT(state["models"][1]["figures"]["systematic_um"], state["models"][0]["figures"]["systematic_um"]);
  page.told("export", {{"what", "commands"}});
  const fs::path script = page.folder.path() / "out/session.sh";
  ASSERT_TRUE(fs::exists(script));
  const fs::path printed = page.folder.path() / "printed.json";
  const std::string path = fs::path(VOLCAL_PROGRAM).parent_path().string();
  const std::string command =
      "PATH='" + path + "':\"$PATH\" " + script.string() + " --json --threads 2 > " + printed.string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(Json::parse(testing::content(printed))["models"], state["models"]);
}

TEST(WorkbenchDoors, LeaveOutAndCancelAndExport) {
  Page page(false);
  const Json begun = page.told("leave-out", {{"observations", {5, 6, 7}}, {"reason", "cable moved"}});
  EXPECT_EQ(begun["busy"]["what"], "leave-out");
  EXPECT_EQ(page.ask("undo").status, 409) << "one thing after another";
  page.bench->wait_until_idle();
  Json state = page.state();
  ASSERT_EQ(state["models"].size(), 2U);
  EXPECT_EQ(state["models"][1]["change"], "- 3 readings: cable moved");
  EXPECT_EQ(state["left_out"][0]["readings"], 3);
  EXPECT_EQ(state["commands"].back(), "leave-out 5-7 cable moved");
  const Framed left(page.ask("columns", {{"names", {"left_out"}}}).body);
  EXPECT_EQ(left.columns[0][6], 1.0F);
  page.told("climb");
  page.told("cancel");
  page.bench->wait_until_idle();
  EXPECT_EQ(page.state()["models"], state["models"]) << "a step that is stopped leaves the state before";
  page.told("export", {{"what", "model"}});
  EXPECT_TRUE(fs::exists(page.folder.path() / "out/model-1.toml"));
  page.told("export", {{"what", "model"}});
  EXPECT_TRUE(fs::exists(page.folder.path() / "out/model-1-1.toml")) << "nothing is overwritten";
}

/// A verdict or a model without some readings is not that of the whole campaign.
TEST(WorkbenchDoors, ExportsSayWhatWasLeftOut) {
  Page page(false);
  page.told("leave-out", {{"observations", {5, 6, 7}}, {"reason", "cable moved"}});
  page.bench->wait_until_idle();
  for (const char* what : {"model", "diagnosis", "result"}) {
    page.told("export", {{"what", what}});
    page.bench->wait_until_idle();
  }
  for (const char* file : {"model-1.toml", "diagnosis/diagnosis.txt", "diagnosis/diagnosis.json",
                           "diagnosis/extended.toml", "result/identified.toml", "result/result.json"})
    EXPECT_THAT(testing::content(page.folder.path() / "out" / file), ::testing::HasSubstr("cable moved"))
        << file;
  const Json result = Json::parse(testing::content(page.folder.path() / "out/result/result.json"));
  EXPECT_THAT(result["provenance"]["command"].get<std::string>(),
              ::testing::AllOf(::testing::StartsWith("volcal session "),
                               ::testing::HasSubstr(" --do 'leave-out 5-7 cable moved' --result ")));
}

TEST(WorkbenchDoors, TriesNoFormulaWhileTheUserWaitsForWork) {
  Page page(false, false, true);
  page.told("climb");
  EXPECT_EQ(page.ask("formula", {{"text", "EXX += 3 * dir_x"}}).status, 409);
  page.told("cancel");
  page.bench->wait_until_idle();
  EXPECT_EQ(page.state()["tried"], 0);
}

TEST(WorkbenchDoors, SaysOfConfirmedEffectsWhatTheyWereAddedBy) {
  Page page(false);
  const Json found = page.told("rank")["effects"][0];
  page.told("add", {{"effect", kReversalOfX}});
  page.told("confirm");
  page.bench->wait_until_idle();
  const Json effect = page.state()["models"][1]["effects"][0];
  for (const char* key : {"p", "log10_p", "gain", "visible"}) EXPECT_EQ(effect[key], found[key]) << key;
  const Json share = page.told("meaning")["share"];
  EXPECT_TRUE(std::ranges::any_of(
      share, [](const Json& cause) { return cause["label"] == "reversal EXX" && cause["found"]; }));
}

TEST(WorkbenchDoors, AReaderWritesNothing) {
  Page page(false, true, true);
  EXPECT_EQ(page.ask("export", {{"what", "model"}}).status, 403);
  EXPECT_EQ(page.ask("add", {{"effect", kReversalOfX}}).status, 200) << "it may look and try";
  EXPECT_FALSE(fs::exists(page.folder.path() / "out"));
}

/// A workbench on files that are changed, and the phase that it comes to.
struct Changing {
  ScratchFolder folder;
  std::unique_ptr<Workbench> bench;

  Changing() {
    fs::copy(fs::path(VOLCAL_SOURCE_DIR) / "datasets/hidden/21", folder.path(), fs::copy_options::recursive);
  }
  fs::path file(const std::string& name) const { return folder.path() / name; }
  void open() {
    WorkbenchOptions options;
    options.campaign = file("campaign.toml").string();
    options.model = quick_model(folder);
    options.threads = 1;
    bench = std::make_unique<Workbench>(options);
    bench->wait_until_idle();
  }
  Json state() const { return Json::parse(bench->answer("state", "{}", "one").body); }
  Json ready() const {
    for (int look = 0; look < 600 && state()["phase"] != "ready"; ++look)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return state();
  }
};

TEST(WorkbenchDoors, GoesOnWhenAnotherFileThanTheOneItNamesIsMended) {
  Changing files;
  const std::string readings = "P1_short.csv", machine = "machine.toml";
  fs::rename(files.file(readings), files.file("away"));
  files.open();
  EXPECT_EQ(files.state()["phase"], "bad-input");
  fs::rename(files.file("away"), files.file(readings));
  EXPECT_EQ(files.ready()["phase"], "ready");

  const std::string right = testing::content(files.file(machine));
  std::string wrong = right;
  wrong.replace(wrong.find("short"), 5, "shord");
  std::ofstream(files.file(machine)) << wrong;
  files.open();
  EXPECT_EQ(files.state()["phase"], "bad-input");
  std::ofstream(files.file(machine)) << right;
  EXPECT_EQ(files.ready()["phase"], "ready");
}

TEST(WorkbenchDoors, SaysThatFilesHaveChangedAndLoadsThemAgain) {
  Changing files;
  files.open();
  EXPECT_TRUE(files.state()["stale"].empty());
  ASSERT_EQ(files.bench->answer("formula", R"({"text": "EXX += 3 * dir_x"})", "one").status, 200);
  std::ofstream(files.file("P1_short.csv"), std::ios::app) << "\n";
  for (int look = 0; look < 100 && files.state()["stale"].empty(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_THAT(files.state()["stale"].dump(), ::testing::HasSubstr("P1_short.csv"));
  EXPECT_EQ(files.bench->answer("reload", "{}", "two").status, 409) << "by the page that writes";
  EXPECT_EQ(files.bench->answer("reload", "{}", "one").status, 200);
  files.bench->wait_until_idle();
  EXPECT_EQ(files.state()["phase"], "ready");
  EXPECT_TRUE(files.state()["stale"].empty());
  EXPECT_TRUE(files.state()["commands"].empty()) << "another session";
}

TEST(WorkbenchDoors, TakesChannelsWithLettersOutsideAscii) {
  Changing files;
  for (const auto& entry : fs::directory_iterator(files.folder.path())) {
    std::string text = testing::content(entry.path());
    const std::size_t at = text.find("T_air_degC");
    if (entry.path().extension() == ".csv" && at != std::string::npos)
      std::ofstream(entry.path()) << text.replace(at, 10, "T_Öl_degC");
  }
  files.open();
  ASSERT_EQ(files.state()["phase"], "ready") << files.state()["input_error"];
  EXPECT_THAT(files.bench->answer("complete", R"({"text": "EXX += T_Ö", "at": 11})", "one").body,
              ::testing::HasSubstr("\"T_Öl\""));
  const Answer answer = files.bench->answer("formula", R"({"text": "EXX += dir_x * T_Öl"})", "one");
  EXPECT_EQ(answer.status, 200) << answer.body.substr(0, 300);
}

TEST(WorkbenchDoors, GoesOnWhenAFileIsMended) {
  ScratchFolder folder;
  fs::copy(fs::path(VOLCAL_SOURCE_DIR) / "datasets/hidden/21", folder.path(), fs::copy_options::recursive);
  const fs::path campaign = folder.path() / "campaign.toml";
  const std::string right = testing::content(campaign);
  std::ofstream(campaign) << "format = \"volcal-campaign-1\"\nmachin = \"machine.toml\"\n";
  WorkbenchOptions options;
  options.campaign = campaign.string();
  options.model = quick_model(folder);
  options.threads = 1;
  Workbench bench(options);
  bench.wait_until_idle();
  const Json wrong = Json::parse(bench.answer("state", "{}", "one").body);
  EXPECT_EQ(wrong["phase"], "bad-input");
  EXPECT_EQ(wrong["input_error"]["file"], campaign.string());
  EXPECT_FALSE(wrong["input_error"]["remedy"].get<std::string>().empty());
  EXPECT_EQ(wrong["input_error"]["text"][1]["text"], "machin = \"machine.toml\"");
  for (const char* request : {"rank", "undo", "reload"}) {
    const Answer refused = bench.answer(request, "{}", "one");
    EXPECT_EQ(refused.status, 409) << request;
    EXPECT_THAT(refused.body, ::testing::AllOf(::testing::HasSubstr("campaign.toml:2: "),
                                               ::testing::HasSubstr("once the file is saved"),
                                               ::testing::Not(::testing::HasSubstr("wait until"))));
  }
  std::ofstream(campaign) << right;
  std::string phase = "bad-input";
  for (int look = 0; look < 600 && phase != "ready"; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    phase = Json::parse(bench.answer("state", "{}", "one").body)["phase"];
  }
  EXPECT_EQ(phase, "ready");
}

}  // namespace
}  // namespace volcal::workbench
