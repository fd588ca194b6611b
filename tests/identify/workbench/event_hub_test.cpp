// Events to pages.

#include "volcal/identify/workbench/event_hub.h"

#include <gtest/gtest.h>

#include <thread>

namespace volcal::workbench {
namespace {

TEST(EventsOfTheWorkbench, ReachEveryPageInOrder) {
  EventHub hub;
  EXPECT_FALSE(hub.lonely_for()) << "no page was there yet";
  const auto first = hub.connect(), second = hub.connect();
  hub.publish("state", "{\"a\":1}");
  hub.publish("bye", "{}");
  for (const auto& line : {first, second}) {
    EXPECT_EQ(line->next(), "event: state\ndata: {\"a\":1}\n\n");
    EXPECT_EQ(line->next(), "event: bye\ndata: {}\n\n");
  }
  hub.disconnect(first);
  EXPECT_FALSE(hub.lonely_for());
  hub.disconnect(second);
  EXPECT_TRUE(hub.lonely_for());
}

TEST(EventsOfTheWorkbench, EndWithTheHub) {
  EventHub hub;
  const auto line = hub.connect();
  std::thread closing([&] { hub.close(); });
  EXPECT_FALSE(line->next());
  closing.join();
  EXPECT_FALSE(hub.connect()->next()) << "a page that comes too late";
}

}  // namespace
}  // namespace volcal::workbench
