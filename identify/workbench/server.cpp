#include "volcal/identify/workbench/server.h"

#include <httplib.h>

#include <chrono>
#include <ctime>
#include <limits>
#include <thread>
#include <utility>

#include "volcal/identify/text/json_text.h"
#include "volcal/identify/workbench/gate.h"
#include "volcal/identify/workbench/page.h"

namespace volcal::workbench {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::size_t kLargestBody = 1 << 20;
constexpr std::size_t kThreads = 24;  // every page that is open holds one for its events
constexpr std::chrono::seconds kLonely{10};
constexpr std::time_t kIdle = 3;  // s, that a connection stays open without a request
constexpr std::chrono::milliseconds kLookAround{100};
constexpr std::chrono::milliseconds kStart{1};

RequestHead head_of(const httplib::Request& request) {
  RequestHead head;
  head.remote_address = request.remote_addr;
  head.host = request.get_header_value("Host");
  if (request.has_header("Origin")) head.origin = request.get_header_value("Origin");
  head.token = request.get_header_value("X-Volcal-Token");
  return head;
}

/// cpp-httplib would let another program listen on the same port.
void take_the_port_alone(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

void refuse(httplib::Response& response, int status, const std::string& reason) {
  response.status = status;
  response.set_content(
      json_text(Json{{"error", reason}, {"remedy", "open the address that the program printed"}}, -1),
      "application/json");
}

void send_events(Workbench& workbench, httplib::Response& response) {
  const auto line = workbench.events().connect();
  response.set_chunked_content_provider(
      "text/event-stream",
      [line](std::size_t /*offset*/, httplib::DataSink& sink) {
        const auto message = line->next();
        if (!message) {
          sink.done();
          return true;
        }
        return sink.is_writable() && sink.write(message->data(), message->size());
      },
      [&workbench, line](bool /*success*/) { workbench.events().disconnect(line); });
}

}  // namespace

struct Server::Network {
  httplib::Server http;
  std::thread thread;
};

bool page_available() { return !page().empty(); }

Server::Server(Workbench& workbench, ServerOptions options)
    : network_(std::make_unique<Network>()), workbench_(workbench), options_(options) {
  httplib::Server& http = network_->http;
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_payload_max_length(kLargestBody);
  http.set_tcp_nodelay(true);
  http.set_keep_alive_max_count(std::numeric_limits<std::size_t>::max());
  http.set_keep_alive_timeout(kIdle);
  http.set_socket_options(&take_the_port_alone);
  http.set_default_headers({{"Cache-Control", "no-store"},
                            {"X-Content-Type-Options", "nosniff"},
                            {"X-Frame-Options", "DENY"},
                            {"Referrer-Policy", "no-referrer"},
                            {"Cross-Origin-Resource-Policy", "same-origin"}});
  const int port = options_.port == 0                            ? http.bind_to_any_port(kLoopback)
                   : http.bind_to_port(kLoopback, options_.port) ? options_.port
                                                                 : -1;
  if (port < 0)
    throw InputError({}, "port " + std::to_string(options_.port) + " cannot be opened",
                     "another program may hold it: leave --port out, or name another");
  const std::string token = Gate::new_token();
  const auto gate = std::make_shared<const Gate>(port, token);
  address_ = "http://" + std::string(kLoopback) + ":" + std::to_string(port) + "/#" + token;
  http.Get("/", [gate](const httplib::Request& request, httplib::Response& response) {
    if (const auto reason = gate->refuses_page(head_of(request))) return refuse(response, 403, *reason);
    response.set_content(std::string(page()), "text/html; charset=utf-8");
  });
  http.Get("/api/events", [gate, &workbench](const httplib::Request& request, httplib::Response& response) {
    if (const auto reason = gate->refuses(head_of(request))) return refuse(response, 403, *reason);
    send_events(workbench, response);
  });
  http.Post(R"(/api/([a-z-]{1,20}))",
            [gate, &workbench](const httplib::Request& request, httplib::Response& response) {
              if (const auto reason = gate->refuses(head_of(request))) return refuse(response, 403, *reason);
              const Answer answer = workbench.answer(request.matches[1], request.body,
                                                     request.get_header_value("X-Volcal-Tab"));
              response.status = answer.status;
              response.set_content(answer.body, answer.type);
            });
}

Server::~Server() {
  network_->http.stop();
  if (network_->thread.joinable()) network_->thread.join();
}

void Server::serve(const std::function<bool()>& ends) {
  network_->thread = std::thread([this] { network_->http.listen_after_bind(); });
  while (!network_->http.is_running()) std::this_thread::sleep_for(kStart);
  const auto is_lonely = [this] {
    const auto lonely = workbench_.events().lonely_for();
    return !options_.keep && lonely && *lonely > kLonely;
  };
  while (!ends() && !workbench_.wants_to_end() && !is_lonely()) std::this_thread::sleep_for(kLookAround);
  workbench_.events().publish("bye", "{}");
  workbench_.events().close();
}

}  // namespace volcal::workbench
