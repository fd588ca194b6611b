#include "volcal/identify/workbench/gate.h"

#include <random>

namespace volcal::workbench {
namespace {

/// In a time that does not depend on where they differ.
bool are_equal(const std::string& a, const std::string& b) {
  unsigned different = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    different |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return different == 0U;
}

bool is_loopback(const std::string& address) {
  return address == "127.0.0.1" || address == "::1" || address == "::ffff:127.0.0.1";
}

}  // namespace

std::string Gate::new_token() {
  constexpr int kDigits = 32;
  std::random_device random;
  std::uniform_int_distribution<int> digit(0, 15);
  std::string token;
  for (int i = 0; i < kDigits; ++i) token += "0123456789abcdef"[digit(random)];
  return token;
}

bool Gate::is_own_host(const std::string& host) const {
  const std::string port = ":" + std::to_string(port_);
  return host == "127.0.0.1" + port || host == "localhost" + port;
}

std::optional<std::string> Gate::refuses_page(const RequestHead& head) const {
  if (!is_loopback(head.remote_address)) return "requests from other machines are refused";
  if (!is_own_host(head.host)) return "the host is not that of this program";
  if (head.origin && !head.origin->starts_with("http://")) return "the origin is not this program's page";
  if (head.origin && !is_own_host(head.origin->substr(7))) return "the origin is not this program's page";
  return std::nullopt;
}

std::optional<std::string> Gate::refuses(const RequestHead& head) const {
  if (auto reason = refuses_page(head)) return reason;
  if (!are_equal(head.token, token_))
    return "the token is missing or wrong: open the address that was printed";
  return std::nullopt;
}

}  // namespace volcal::workbench
