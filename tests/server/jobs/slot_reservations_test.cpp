#include "server/jobs/slot_reservations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <vector>

namespace unwrapd::server::jobs {
namespace {

using Clock = SlotReservations::Clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Clock::time_point kStart{seconds(1'000'000)};

TEST(SlotReservations, TellsEachOfManyAPlaceOfHisOwn) {
  SlotReservations door;
  const QueueForecast full{.places = 4, .waiting = 4, .first = 2.5, .interval = 3};
  EXPECT_EQ(door.ask(kStart, {.who = "a"}, full), 3);
  EXPECT_EQ(door.ask(kStart, {.who = "b"}, full), 6);
  EXPECT_EQ(door.ask(kStart, {.who = "c"}, full), 9);
}

TEST(SlotReservations, KeepsThePlaceFromNewcomers) {
  SlotReservations door;
  ASSERT_EQ(door.ask(kStart, {.who = "a"}, {.places = 2, .waiting = 2, .first = 3, .interval = 3}),
            3);
  const QueueForecast one_free{.places = 2, .waiting = 1, .first = 2.9, .interval = 3};
  const auto soon = kStart + milliseconds(3100);
  EXPECT_TRUE(door.ask(soon, {.who = "newcomer"}, one_free));
  EXPECT_FALSE(door.ask(soon, {.who = "a"}, one_free));
}

TEST(SlotReservations, LetsANewcomerInWhoIsInNobodysWay) {
  SlotReservations door;
  ASSERT_EQ(door.ask(kStart, {.who = "a"}, {.places = 3, .waiting = 3, .first = 30, .interval = 1}),
            30);
  const QueueForecast one_free{.places = 3, .waiting = 2, .first = 1, .interval = 1};
  EXPECT_FALSE(door.ask(kStart + seconds(10), {.who = "newcomer"}, one_free));
}

TEST(SlotReservations, KeepsAPlaceForWhoSendsUntilHeLeaves) {
  SlotReservations door;
  const QueueForecast one_free{.places = 4, .waiting = 3, .first = 9, .interval = 9};
  ASSERT_FALSE(door.ask(kStart, {.who = "sender"}, one_free));
  EXPECT_TRUE(door.ask(kStart, {.who = "newcomer"}, one_free));
  EXPECT_FALSE(door.ask(kStart + seconds(20), {.who = "sender"}, one_free))
      << "the same upload, complete";
  door.leave("sender");
  EXPECT_FALSE(door.ask(kStart, {.who = "another"}, one_free));
}

TEST(SlotReservations, TakesThePlaceBackFromWhoNeverEndsSending) {
  SlotReservations door;
  const QueueForecast one_free{.places = 4, .waiting = 3, .first = 9, .interval = 9};
  ASSERT_FALSE(door.ask(kStart, {.who = "slow"}, one_free));
  EXPECT_FALSE(door.ask(kStart + seconds(31), {.who = "another"}, one_free));
}

TEST(SlotReservations, LetOwnersTakeTurns) {
  SlotReservations door;
  const QueueForecast full{.places = 4, .waiting = 4, .first = 2.5, .interval = 3};
  std::vector<std::string> names;
  for (int k = 0; k < 60; ++k) {
    names.push_back("many" + std::to_string(k));
    EXPECT_EQ(door.ask(kStart, {.who = names.back(), .owner = "k_1"}, full), 3 * (k + 1));
  }
  EXPECT_EQ(door.ask(kStart, {.who = "one", .owner = "k_2"}, full), 6);
  EXPECT_EQ(door.ask(kStart, {.who = "two", .owner = "k_2"}, full), 9);
  const QueueForecast half_full{.places = 4, .waiting = 2, .first = 2.5, .interval = 3};
  const auto then = kStart + seconds(6);  // the first of k_1 did not come
  EXPECT_FALSE(door.ask(then, {.who = "one", .owner = "k_2"}, half_full));
  EXPECT_TRUE(door.ask(then, {.who = "another", .owner = "k_1"}, half_full));
  const QueueForecast nearly_empty{.places = 4, .waiting = 1, .first = 2.5, .interval = 3};
  EXPECT_FALSE(door.ask(then, {.who = "third", .owner = "k_3"}, nearly_empty))
      << "the promises of k_1 would fill the rest";
}

TEST(SlotReservations, GivesTheNextPlaceToWhoFoundNoneInTime) {
  SlotReservations door;
  const QueueForecast full{.places = 2, .waiting = 2, .first = 5, .interval = 5};
  ASSERT_EQ(door.ask(kStart, {.who = "a"}, full), 5);
  ASSERT_EQ(door.ask(kStart, {.who = "b"}, full), 10);
  EXPECT_EQ(door.ask(kStart + seconds(5), {.who = "a"}, full), 5)
      << "ahead of b, who comes in 5 s, too";
}

TEST(SlotReservations, ForgetsThoseWhoDoNotComeBack) {
  SlotReservations door;
  const QueueForecast full{.places = 2, .waiting = 2, .first = 1, .interval = 1};
  for (int k = 0; k < 10'000; ++k)
    EXPECT_LE(door.ask(kStart, {.who = std::to_string(k)}, full), 70)
        << "what is promised is bounded";
  const QueueForecast half_full{.places = 2, .waiting = 1, .first = 1, .interval = 1};
  EXPECT_TRUE(door.ask(kStart + seconds(10), {.who = "newcomer"}, half_full));
  EXPECT_FALSE(door.ask(kStart + seconds(100), {.who = "newcomer"}, half_full));
  const QueueForecast idle{.places = 2, .waiting = 0, .first = 0, .interval = 1};
  EXPECT_FALSE(door.ask(kStart + seconds(10), {.who = "another newcomer"}, idle))
      << "no worker is idle";
}

TEST(LineBefore, ReckonsWithJobsThatRunLongerThanOthersDid) {
  const Lengths two_seconds{.mean = 2, .spread = 1, .count = 9};
  const auto line = [&](int workers, const std::vector<double>& ran) {
    return forecast_queue(4, 3, workers, two_seconds, ran);
  };
  EXPECT_DOUBLE_EQ(line(1, {.5}).first, 1.5);
  EXPECT_DOUBLE_EQ(line(1, {.5}).interval, 2);
  EXPECT_DOUBLE_EQ(line(1, {10}).first, 5);
  EXPECT_DOUBLE_EQ(line(1, {10}).interval, 10);
  EXPECT_DOUBLE_EQ(line(2, {10}).first, 0) << "the other worker is free";
  EXPECT_DOUBLE_EQ(line(2, {10, 0}).first, 2);
  EXPECT_DOUBLE_EQ(line(2, {10, 0}).interval, 1 / (1 / 10. + 1 / 2.));
  EXPECT_DOUBLE_EQ(line(2, {0, 0}).spread, .5);
}

TEST(Lengths, AreOfTheJobsOfLate) {
  Lengths lengths;
  lengths.add(3);
  EXPECT_DOUBLE_EQ(lengths.mean, 3) << "not what was supposed before there was any job";
  lengths.add(1);
  EXPECT_DOUBLE_EQ(lengths.mean, 2);
  for (int k = 0; k < 500; ++k) lengths.add(8);
  EXPECT_NEAR(lengths.mean, 8, .01);
  EXPECT_NEAR(lengths.spread, 0, .01);
}

/// Clients who send jobs one after the other, and come back when they are told, to a queue and its
/// workers; in milliseconds.
class SlowClientPressure {
 public:
  struct Setting {
    int clients = 16, places = 4, workers = 1, jobs = 20;
  };

  template <typename Length>
  SlowClientPressure(const Setting& setting, const Length& length) : setting_(setting) {
    for (int c = 0; c < setting.clients; ++c) clients_.push_back({.name = std::to_string(c)});
    work_.resize(static_cast<std::size_t>(setting.workers));
    for (ms_ = 0; left() > 0; ++ms_) {
      for (Work& work : work_) serve(work, length);
      for (Client& client : clients_) come(client);
    }
  }

  [[nodiscard]] const std::vector<int>& tries() const { return tries_; }
  /// Of the workers' time.
  [[nodiscard]] double used() const {
    return static_cast<double>(worked_) / static_cast<double>(ms_ * setting_.workers);
  }

 private:
  struct Client {
    std::string name;
    std::int64_t comes = 0;
    int tries = 0, done = 0;
    bool inside = false;
  };

  struct Work {
    std::int64_t began = 0, free = 0;
  };

  [[nodiscard]] std::int64_t left() const {
    return std::ranges::count_if(clients_, [&](const Client& c) { return c.done < setting_.jobs; });
  }

  template <typename Length>
  void serve(Work& work, const Length& length) {
    if (work.free > ms_ || queue_.empty()) return;
    Client& client = clients_[queue_.front()];
    queue_.pop_front();
    const std::int64_t took = length();
    lengths_.add(static_cast<double>(took) / 1e3);
    worked_ += took;
    work = {.began = ms_, .free = ms_ + took};
    client.inside = false;
    client.comes = work.free + 1;  // with the next job
    ++client.done;
  }

  /// Of running jobs, in seconds.
  [[nodiscard]] std::vector<double> ran() const {
    std::vector<double> all;
    for (const auto& [began, free] : work_)
      if (free > ms_) all.push_back(static_cast<double>(ms_ - began) / 1e3);
    return all;
  }

  void come(Client& client) {
    if (client.inside || client.comes > ms_ || client.done == setting_.jobs) return;
    ++client.tries;
    const QueueForecast line =
        forecast_queue(setting_.places, std::ssize(queue_), setting_.workers, lengths_, ran());
    const auto now = kStart + milliseconds(ms_);
    if (const std::optional<int> later = door_.ask(now, {.who = client.name}, line)) {
      client.comes = ms_ + std::int64_t{1000} * *later;
      return;
    }
    door_.leave(client.name);
    client.inside = true;
    queue_.push_back(static_cast<std::size_t>(&client - clients_.data()));
    tries_.push_back(client.tries);
    client.tries = 0;
  }

  const Setting setting_;
  SlotReservations door_;
  std::vector<Client> clients_;
  std::deque<std::size_t> queue_;
  std::vector<Work> work_;
  std::vector<int> tries_;
  Lengths lengths_;
  std::int64_t ms_ = 0, worked_ = 0;
};

double share_within(const std::vector<int>& tries, int most) {
  const auto within = [&](int count) { return count <= most; };
  return static_cast<double>(std::ranges::count_if(tries, within)) /
         static_cast<double>(tries.size());
}

TEST(SlotReservations, HoldWhereJobsTakeEquallyLong) {
  for (const std::int64_t took : {70, 900, 4000}) {
    const SlowClientPressure pressure({.workers = 2}, [&] { return took; });
    EXPECT_GE(share_within(pressure.tries(), 2), .95) << "while it is learnt how long they take";
    EXPECT_GE(share_within(pressure.tries(), 3), .99) << took;
    EXPECT_GE(pressure.used(), .85) << took;
  }
}

TEST(SlotReservations, MostlyHoldWhereJobsDiffer) {
  std::mt19937 random(7);
  std::exponential_distribution<> length(1 / 2.);
  const SlowClientPressure pressure({.jobs = 50},
                                    [&] { return 1 + std::llround(1e3 * length(random)); });
  EXPECT_GE(share_within(pressure.tries(), 2), .9);
  EXPECT_GE(share_within(pressure.tries(), 3), .98);
  EXPECT_GE(pressure.used(), .98);
}

}  // namespace
}  // namespace unwrapd::server::jobs
