#include "volcal/identify/workbench/event_hub.h"

namespace volcal::workbench {
namespace {

constexpr std::chrono::seconds kPatience{2};
constexpr std::size_t kMostWaiting = 256;  // of a page that does not read: the oldest are lost

}  // namespace

std::optional<std::string> EventHub::Line::next() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [this] { return closed_ || !waiting_.empty(); });
  if (!waiting_.empty()) {
    std::string message = std::move(waiting_.front());
    waiting_.pop_front();
    return message;
  }
  if (closed_) return std::nullopt;
  return ":\n\n";
}

std::shared_ptr<EventHub::Line> EventHub::connect() {
  auto line = std::make_shared<Line>();
  const std::lock_guard lock(mutex_);
  line->closed_ = closed_;
  lines_.push_back(line);
  last_seen_ = Clock::now();
  return line;
}

void EventHub::disconnect(const std::shared_ptr<Line>& line) {
  const std::lock_guard lock(mutex_);
  lines_.remove(line);
  last_seen_ = Clock::now();
}

void EventHub::publish(const std::string& event, const std::string& json) {
  const std::string message = "event: " + event + "\ndata: " + json + "\n\n";
  const std::lock_guard lock(mutex_);
  for (const auto& line : lines_) {
    const std::lock_guard of_line(line->mutex_);
    if (line->waiting_.size() >= kMostWaiting) line->waiting_.pop_front();
    line->waiting_.push_back(message);
    line->changed_.notify_one();
  }
}

void EventHub::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (const auto& line : lines_) {
    const std::lock_guard of_line(line->mutex_);
    line->closed_ = true;
    line->changed_.notify_one();
  }
}

std::optional<EventHub::Clock::duration> EventHub::lonely_for() const {
  const std::lock_guard lock(mutex_);
  if (!lines_.empty() || !last_seen_) return std::nullopt;
  return Clock::now() - *last_seen_;
}

}  // namespace volcal::workbench
