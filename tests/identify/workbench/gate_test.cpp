// Who may speak with the workbench.

#include "volcal/identify/workbench/gate.h"

#include <gtest/gtest.h>

namespace volcal::workbench {
namespace {

class GateOfTheWorkbench : public ::testing::Test {
 protected:
  static RequestHead own() { return {"127.0.0.1", "127.0.0.1:8137", std::nullopt, "secret"}; }
  const Gate gate_{8137, "secret"};
};

TEST_F(GateOfTheWorkbench, LetsItsOwnPageIn) {
  EXPECT_FALSE(gate_.refuses(own()));
  RequestHead head = own();
  head.host = "localhost:8137";
  head.origin = "http://localhost:8137";
  EXPECT_FALSE(gate_.refuses(head));
}

TEST_F(GateOfTheWorkbench, RefusesTheTokenOfNobody) {
  for (const char* token : {"", "secre", "secret1", "Secret"}) {
    RequestHead head = own();
    head.token = token;
    EXPECT_TRUE(gate_.refuses(head)) << token;
    EXPECT_FALSE(gate_.refuses_page(head)) << "the page itself holds no secret";
  }
}

/// A name of the attacker's that leads to this machine, another program's port, no host at all.
TEST_F(GateOfTheWorkbench, RefusesAnotherHost) {
  for (const char* host : {"", "evil.example:8137", "127.0.0.1:8138", "127.0.0.1", "127.0.0.1:81370"}) {
    RequestHead head = own();
    head.host = host;
    EXPECT_TRUE(gate_.refuses(head)) << host;
    EXPECT_TRUE(gate_.refuses_page(head)) << host;
  }
}

TEST_F(GateOfTheWorkbench, RefusesAnotherOrigin) {
  for (const char* origin :
       {"http://evil.example", "http://localhost:9000", "https://127.0.0.1:8137", "null", ""}) {
    RequestHead head = own();
    head.origin = origin;
    EXPECT_TRUE(gate_.refuses(head)) << origin;
  }
}

TEST_F(GateOfTheWorkbench, RefusesAnotherMachine) {
  RequestHead head = own();
  head.remote_address = "192.168.1.7";
  EXPECT_TRUE(gate_.refuses(head));
  EXPECT_TRUE(gate_.refuses_page(head));
}

TEST_F(GateOfTheWorkbench, EveryTokenIsNew) {
  const std::string token = Gate::new_token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_NE(token, Gate::new_token());
}

}  // namespace
}  // namespace volcal::workbench
