#include "volcal/identify/text/atomic_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>
#include <thread>

#include "tests/support/broken_campaigns.h"
#include "tests/support/refusal.h"
#include "tests/support/scratch_folder.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::ScratchFolder;
using testing::slurp;
using testing::spill;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// One generation of a result: three files of which the last holds a hash of the others.
void write_generation(const std::string& target, std::size_t generation) {
  const std::string a(10000 + generation % 7, static_cast<char>('a' + generation % 26));
  const std::string b = std::to_string(generation);
  AtomicFolder folder(target);
  folder.write("a.txt", a);
  fs::create_directory(folder.path("inner"));
  folder.write("inner/b.txt", b);
  folder.write("hash.txt", std::to_string(std::hash<std::string>{}(a + b)));
  folder.commit();
}

bool is_complete(const fs::path& target) {
  const std::string content = slurp(target / "a.txt") + slurp(target / "inner/b.txt");
  return slurp(target / "hash.txt") == std::to_string(std::hash<std::string>{}(content));
}

TEST(AtomicFolder, AppearsOnlyWhenCommitted) {
  const ScratchFolder scratch;
  const fs::path target = scratch.path() / "result";
  {
    AtomicFolder folder(target.string());
    folder.write("a.txt", "new");
    EXPECT_FALSE(fs::exists(target));
    folder.commit();
  }
  EXPECT_EQ(slurp(target / "a.txt"), "new");
  EXPECT_EQ(entries(scratch.path()), 1U);
}

TEST(AtomicFolder, LeavesTheOldOneWhenNotCommitted) {
  const ScratchFolder scratch;
  const fs::path target = scratch.path() / "result";
  write_generation(target.string(), 1);
  {
    const AtomicFolder folder(target.string());
    folder.write("a.txt", "never seen");
  }
  EXPECT_TRUE(is_complete(target));
  EXPECT_EQ(entries(scratch.path()), 1U);
}

TEST(AtomicFolder, ReplacesWhatItWroteAndKeepsWhatTheUserPutThere) {
  const ScratchFolder scratch;
  const fs::path target = scratch.path() / "result";
  {
    AtomicFolder folder(target.string());
    folder.write("old.txt", "1");
    folder.commit();
  }
  spill(target / "notes.txt", "mine");
  write_generation(target.string(), 2);
  EXPECT_FALSE(fs::exists(target / "old.txt"));
  EXPECT_EQ(slurp(target / "notes.txt"), "mine");
  EXPECT_TRUE(is_complete(target));
  write_generation(target.string(), 3);
  EXPECT_EQ(slurp(target / "notes.txt"), "mine");
}

TEST(AtomicFolder, NeverReplacesAForeignFolder) {
  const ScratchFolder scratch;
  spill(scratch.path() / "thesis.txt", "years of work");
  const std::string message = testing::refusal([&] { const AtomicFolder folder(scratch.path().string()); });
  EXPECT_THAT(message, HasSubstr("holds files that volcal did not write"));
  EXPECT_THAT(message, HasSubstr("name another folder with -o"));
  EXPECT_EQ(slurp(scratch.path() / "thesis.txt"), "years of work");
  EXPECT_EQ(testing::refusal([&] { require_output_folder(scratch.path().string()); }), message);
  EXPECT_EQ(testing::refusal([&] { require_output_folder((scratch.path() / "new").string()); }), "");
  EXPECT_EQ(entries(scratch.path()), 1U);
}

TEST(AtomicFolder, NeverReplacesAFileOrTheCurrentFolder) {
  const ScratchFolder scratch;
  spill(scratch.path() / "file", "content");
  EXPECT_THAT(testing::refusal([&] { const AtomicFolder folder((scratch.path() / "file").string()); }),
              HasSubstr("a file of this name exists"));
  EXPECT_THAT(
      testing::refusal([&] { const AtomicFolder folder((scratch.path() / "file" / "result").string()); }),
      HasSubstr("check the path"));
  EXPECT_THAT(testing::refusal([] { const AtomicFolder folder("."); }), HasSubstr("current directory"));
  EXPECT_THAT(testing::refusal([] { const AtomicFolder folder("/"); }), HasSubstr("cannot be used"));
  EXPECT_THAT(testing::refusal([] { const AtomicFolder folder(""); }), HasSubstr("cannot be used"));
}

TEST(AtomicFolder, TakesAnEmptyFolderAndCreatesParents) {
  const ScratchFolder scratch;
  fs::create_directory(scratch.path() / "empty");
  write_generation((scratch.path() / "empty").string(), 4);
  write_generation((scratch.path() / "new/deep/result/").string(), 5);
  EXPECT_TRUE(is_complete(scratch.path() / "empty"));
  EXPECT_TRUE(is_complete(scratch.path() / "new/deep/result"));
}

TEST(AtomicFolder, TwoWritersDoNotDisturbEachOther) {
  const ScratchFolder scratch;
  const std::string target = (scratch.path() / "result").string();
  AtomicFolder first(target);
  first.write("a.txt", "first");
  write_generation(target, 6);
  first.commit();
  EXPECT_EQ(slurp(fs::path(target) / "a.txt"), "first");
  EXPECT_EQ(entries(scratch.path()), 1U);
}

/// Waits until a commit of the child is seen; reading meets whole folders only, never half ones.
bool sees_another_generation(const fs::path& target, const std::string& before) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < deadline) {
    const std::string now = slurp(target / "inner/b.txt");
    if (!now.empty() && now != before) return true;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  return false;
}

/// A killed writer leaves the old result or the new one, and the next run clears what it left behind.
TEST(AtomicFolder, SurvivesKill) {
  const ScratchFolder scratch;
  const fs::path target = scratch.path() / "result";
  write_generation(target.string(), 0);
  std::mt19937 random(20240229);
  constexpr std::size_t kKills = 60;
  for (std::size_t kill_count = 0; kill_count < kKills; ++kill_count) {
    const std::string before = slurp(target / "inner/b.txt");
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (std::size_t i = 1;; ++i) write_generation(target.string(), kill_count * 1000000 + i);
    }
    const bool committed = sees_another_generation(target, before);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 5000));
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the writer ended by itself";
    ASSERT_TRUE(committed) << "the writer wrote nothing in 30 s";
    ASSERT_TRUE(is_complete(target)) << "after kill " << kill_count;
  }
  write_generation(target.string(), 99);
  EXPECT_TRUE(is_complete(target));
  EXPECT_EQ(entries(scratch.path()), 1U) << "temporary folders of killed runs remain";
}

}  // namespace
}  // namespace volcal
