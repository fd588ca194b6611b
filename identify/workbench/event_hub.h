#pragma once
/// Server-sent events to every page that is connected. For several threads at once.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace volcal::workbench {

class EventHub {
 public:
  using Clock = std::chrono::steady_clock;

  /// Messages that a page has not read yet.
  class Line {
   public:
    /// The next message; a comment where none comes within two seconds; nothing once the hub is closed.
    std::optional<std::string> next();

   private:
    friend class EventHub;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::string> waiting_;
    bool closed_ = false;
  };

  std::shared_ptr<Line> connect();
  void disconnect(const std::shared_ptr<Line>& line);
  /// `json`: of one line.
  void publish(const std::string& event, const std::string& json);
  void close();

  /// How long no page has been connected, once one was.
  std::optional<Clock::duration> lonely_for() const;

 private:
  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Line>> lines_;
  std::optional<Clock::time_point> last_seen_;
  bool closed_ = false;
};

}  // namespace volcal::workbench
