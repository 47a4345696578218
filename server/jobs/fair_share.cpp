#include "server/jobs/fair_share.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace unwrapd::server::jobs {

double FairShare::service(const Account& account) const {
  return account.served_seconds + static_cast<double>(account.running) * lengths_.mean;
}

double FairShare::least_service() const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [owner, account] : accounts_) {
    if (!account.idle()) least = std::min(least, account.served_seconds);
  }
  return least;
}

std::int64_t FairShare::owners() const {
  return std::ranges::count_if(accounts_, [](const auto& entry) { return !entry.second.idle(); });
}

void FairShare::add(const std::string& owner) {
  const double level = least_service();
  Account& account = accounts_[owner];
  if (account.idle() && level < std::numeric_limits<double>::infinity())
    account.served_seconds = std::max(account.served_seconds, level);
  ++account.waiting;
  ++waiting_;
}

void FairShare::remove(const std::string& owner) {
  --accounts_[owner].waiting;
  --waiting_;
}

void FairShare::forget_waiting() {
  for (auto& [owner, account] : accounts_) account.waiting = 0;
  waiting_ = 0;
}

std::string FairShare::next() const {
  assert(waiting_ > 0);
  const std::string* chosen = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [owner, account] : accounts_) {
    if (account.waiting == 0 || service(account) >= least) continue;
    least = service(account);
    chosen = &owner;
  }
  return *chosen;
}

void FairShare::start(const std::string& owner) {
  remove(owner);
  ++accounts_[owner].running;
}

void FairShare::end(const std::string& owner, double seconds) {
  Account& account = accounts_[owner];
  --account.running;
  account.served_seconds += seconds;
  lengths_.add(seconds);
  const bool nobody_else =
      std::ranges::all_of(accounts_, [](const auto& entry) { return entry.second.idle(); });
  if (nobody_else) accounts_.clear();  // all start level again
}

}  // namespace unwrapd::server::jobs
