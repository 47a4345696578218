#pragma once
// Who a client is: the address behind trusted proxies, and how many connections
// it has. The proxies' own word (X-Forwarded-For) counts as far as the chain of
// trusted ones reaches, and no farther: anybody can send the header.

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::http {

/// Addresses as ranges: "10.0.0.0/8", "::1", "192.168.1.7". Thread-safe.
class AddressSet {
 public:
  AddressSet() = default;
  /// Throws Error{invalid_option} for what is no such range.
  explicit AddressSet(const std::vector<std::string>& ranges);

  [[nodiscard]] bool contains(std::string_view address) const;

 private:
  struct Range {
    std::array<unsigned char, 16> bytes{};
    int bits = 0;
  };
  std::vector<Range> ranges_;
};

/// The last address of peer's chain that is not a trusted proxy. forwarded: the
/// values of X-Forwarded-For in their order, joined with commas.
std::string client_behind(const std::string& peer, std::string_view forwarded,
                          const AddressSet& trusted);

/// True for 127.0.0.0/8 and ::1.
bool is_loopback(std::string_view address);

/// The places of open connections. An IPv6 client counts by its /64, the least
/// that one customer of a provider has. Thread-safe; places may outlive it.
class Places {
 public:
  enum class Refusal { none, full, too_many_of_address };

  /// most_of_address: of one address, 0 for no limit.
  Places(int most, int most_of_address) : most_(most), most_of_address_(most_of_address) {}

  /// A place that is given back when its last owner is gone; nullptr and why
  /// when there is none.
  std::shared_ptr<void> take(const std::string& address, bool counted, Refusal& refusal);
  [[nodiscard]] int taken() const;

 private:
  struct Taken {
    mutable std::mutex mutex;
    int all = 0;
    std::map<std::string, int> of_address;
  };

  const int most_;
  const int most_of_address_;
  std::shared_ptr<Taken> taken_ = std::make_shared<Taken>();
};

}  // namespace unwrapd::server::http
