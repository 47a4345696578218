#pragma once
// Constraints as a job may bring them, at random.

#include <random>

#include "api/json.hpp"

namespace unwrapd::api {

inline double random_share(std::mt19937& rng) {
  return std::uniform_real_distribution<>(0, 1)(rng);
}

inline Json random_constraints(std::mt19937& rng) {
  Json list = Json::array();
  while (random_share(rng) < 0.7) {
    Json one = Json::object();
    if (random_share(rng) < 0.5) {
      one["vertex"] = rng() % 1000;
    } else {
      one["at"] = {random_share(rng), -random_share(rng), 1e6 * random_share(rng)};
    }
    one["uv"] = {random_share(rng), 2 * random_share(rng)};
    one["weight"] = random_share(rng) < 0.5 ? Json() : Json(1e-3 + random_share(rng));
    one["mesh"] = rng() % 3;
    list.push_back(one);
  }
  return list;
}

}  // namespace unwrapd::api
