#pragma once
/// The workbench on the loopback interface.

#include <functional>
#include <string>

#include "volcal/identify/workbench/workbench.h"

namespace volcal::workbench {

struct ServerOptions {
  int port = 0;       ///< 0: a free one
  bool keep = false;  ///< false: it ends when no page has been connected for a while
};

/// False when the program was built without the page.
bool page_available();

class Server {
 public:
  /// Listens. Throws InputError where the port is taken.
  Server(Workbench& workbench, ServerOptions options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// "http://127.0.0.1:PORT/#TOKEN"
  const std::string& address() const { return address_; }
  /// Until the user ends the program, all pages are closed, or `ends` is true.
  void serve(const std::function<bool()>& ends);

 private:
  struct Network;
  std::unique_ptr<Network> network_;
  Workbench& workbench_;
  ServerOptions options_;
  std::string address_;
};

}  // namespace volcal::workbench
