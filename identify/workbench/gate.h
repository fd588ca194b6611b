#pragma once
/// Who may speak with the workbench. It listens on loopback alone, but every page that the browser shows can
/// send requests to loopback, and a name of the attacker's can be made to lead there (DNS rebinding): so the
/// host must be the one that the program gave out, the origin too, and every request carries a secret that
/// stands in no address that is sent (the fragment of the page's).

#include <optional>
#include <string>

namespace volcal::workbench {

struct RequestHead {
  std::string remote_address;
  std::string host;                   ///< header Host
  std::optional<std::string> origin;  ///< header Origin
  std::string token;                  ///< header X-Volcal-Token
};

class Gate {
 public:
  Gate(int port, std::string token) : port_(port), token_(std::move(token)) {}

  /// 128 bits of the system's random numbers, hexadecimal.
  static std::string new_token();

  /// Why a request for the page itself is refused; nothing: it may be answered.
  std::optional<std::string> refuses_page(const RequestHead& head) const;
  /// The same of any other request.
  std::optional<std::string> refuses(const RequestHead& head) const;

 private:
  bool is_own_host(const std::string& host) const;

  int port_;
  std::string token_;
};

}  // namespace volcal::workbench
