// The workbench over the network: who is answered, and how it ends.

#include "volcal/identify/workbench/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "volcal/model/description/errors.h"

namespace volcal::workbench {
namespace {

/// A server on files that do not exist: it answers all the same.
class ServerOfTheWorkbench : public ::testing::Test {
 protected:
  ServerOfTheWorkbench() : bench_(options()), server_(bench_, {.port = 0, .keep = true}) {
    const std::string address = server_.address();
    const std::size_t colon = address.rfind(':'), slash = address.find('/', colon);
    port_ = std::stoi(address.substr(colon + 1, slash - colon - 1));
    token_ = address.substr(address.find('#') + 1);
    serving_ = std::thread([this] { server_.serve([this] { return ends_.load(); }); });
  }
  ~ServerOfTheWorkbench() override {
    ends_ = true;
    serving_.join();
  }
  static WorkbenchOptions options() {
    WorkbenchOptions options;
    options.campaign = "/nowhere/campaign.toml";
    return options;
  }
  httplib::Headers headers() const { return {{"X-Volcal-Token", token_}, {"X-Volcal-Tab", "one"}}; }
  int status_with(const httplib::Headers& headers, const std::string& body = "{}") const {
    httplib::Client client("127.0.0.1", port_);
    const auto result = client.Post("/api/state", headers, body, "application/json");
    return result ? result->status : -1;
  }

  Workbench bench_;
  Server server_;
  std::atomic<bool> ends_ = false;
  int port_ = 0;
  std::string token_;
  std::thread serving_;
};

TEST_F(ServerOfTheWorkbench, AnswersItsPage) {
  EXPECT_EQ(status_with(headers()), 200);
  httplib::Client client("127.0.0.1", port_);
  const auto page = client.Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_EQ(page->get_header_value("X-Frame-Options"), "DENY");
  EXPECT_EQ(page->get_header_value("Cache-Control"), "no-store");
  EXPECT_FALSE(page->has_header("Access-Control-Allow-Origin"));
  if (!page_available()) GTEST_SKIP() << "built without Node.js";
  EXPECT_THAT(page->body, ::testing::HasSubstr("Content-Security-Policy"));
}

TEST_F(ServerOfTheWorkbench, RefusesWhoIsNotItsPage) {
  EXPECT_EQ(status_with({}), 403);
  EXPECT_EQ(status_with({{"X-Volcal-Token", "0123456789abcdef0123456789abcdef"}}), 403);
  httplib::Headers other = headers();
  other.emplace("Host", "evil.example");
  EXPECT_EQ(status_with(other), 403);
  other = headers();
  other.emplace("Origin", "http://evil.example");
  EXPECT_EQ(status_with(other), 403);
  httplib::Client client("127.0.0.1", port_);
  EXPECT_EQ(client.Get("/api/events")->status, 403);
  EXPECT_EQ(client.Get("/../../etc/passwd")->status, 404);
  EXPECT_EQ(client.Get("/", {{"Host", "evil.example"}})->status, 403);
}

TEST_F(ServerOfTheWorkbench, RefusesABodyThatIsTooLarge) {
  EXPECT_EQ(status_with(headers(), std::string((1 << 20) + 1, ' ')), 413);
}

/// It is bound to the loopback interface alone.
TEST_F(ServerOfTheWorkbench, IsNotReachedByAnotherAddress) {
  httplib::Client client("127.0.0.2", port_);
  client.set_connection_timeout(1, 0);
  EXPECT_FALSE(client.Get("/"));
}

TEST_F(ServerOfTheWorkbench, SendsEvents) {
  std::string received;
  httplib::Client client("127.0.0.1", port_);
  std::thread taking([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    bench_.answer("take", "{}", "one");
  });
  client.Get("/api/events", headers(), [&](const char* data, std::size_t size) {
    received.append(data, size);
    return received.find("event: state") == std::string::npos;
  });
  taking.join();
  EXPECT_THAT(received, ::testing::HasSubstr("\"phase\""));
}

TEST_F(ServerOfTheWorkbench, EndsWhenThePageSaysSo) {
  EXPECT_EQ(bench_.answer("quit", "{}", "one").status, 200);
  EXPECT_TRUE(bench_.wants_to_end());
}

TEST_F(ServerOfTheWorkbench, RefusesAPortThatIsTaken) {
  EXPECT_THROW(Server(bench_, {.port = port_, .keep = true}), InputError);
}

}  // namespace
}  // namespace volcal::workbench
