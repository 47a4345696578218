// Whatever ran before it, a job gives the bytes that a fresh process without a cache gives: every
// method, each option that a solver reads and every guarantee, in random orders through one cache.
// UNWRAPD_ORDERS says how many orders, UNWRAPD_ORDER_SEED the first; `./dev fault` does the same on
// servers (tests/fault/any_order_test.mjs).
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <random>

#include "core/base/error.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/server/shared_jobs.hpp"

namespace unwrapd::server::work {
namespace {

constexpr std::array kMethods{Method::asap, Method::arap,   Method::hybrid,
                              Method::abf,  Method::linabf, Method::cp,
                              Method::bff,  Method::ic,     Method::slim};
constexpr std::array kGuarantees{Guarantee::none, Guarantee::flip_free, Guarantee::bijective};
constexpr std::array kStarts{InitialMap::automatic, InitialMap::mean_value, InitialMap::tutte,
                             InitialMap::lscm};

UnwrapOptions basic(Method method) {
  UnwrapOptions options{.method = method};
  options.stop.max_iterations = 12;
  return options;
}

/// Of the methods that can hold vertices: under constraints, and with their boundary in a shape.
void add_held(std::vector<UnwrapOptions>& jobs) {
  for (const Method method : {Method::asap, Method::arap, Method::hybrid}) {
    jobs.push_back(basic(method)), jobs.back().boundary = BoundaryShape::circle;
    jobs.push_back(basic(method)), jobs.back().boundary = BoundaryShape::square;
    for (const Index last : {20, 21})
      for (const double weight : {1.0, std::numeric_limits<double>::infinity()}) {
        jobs.push_back(basic(method));
        jobs.back().constraints = {
            {.surface = 0, .vertex = 3, .uv = Vec2(0.2, 0.2)},
            {.surface = 0, .vertex = last, .uv = Vec2(0.7, 0.6), .weight = weight}};
      }
  }
}

/// Jobs that differ from their neighbours in one option.
std::vector<UnwrapOptions> all_jobs() {
  std::vector<UnwrapOptions> jobs;
  for (const Method method : kMethods)
    for (const Guarantee guarantee : kGuarantees)
      jobs.push_back(basic(method)), jobs.back().guarantee = guarantee;
  for (const InitialMap initial : kStarts) {
    jobs.push_back(basic(Method::arap)), jobs.back().initial = initial;
    jobs.push_back(jobs.back()), jobs.back().stop.iterations = 3;
  }
  for (const double lambda : {0.0, 1e-6, 1e-3, 1.0})
    for (const LambdaUnits units : {LambdaUnits::dimensionless, LambdaUnits::paper}) {
      jobs.push_back(basic(Method::hybrid)), jobs.back().lambda = lambda;
      jobs.back().lambda_units = units;
    }
  jobs.push_back(basic(Method::hybrid)), jobs.back().lambda_curve = {1e-6, 1};
  jobs.push_back(basic(Method::asap)), jobs.back().pins = Pins::spectral;
  jobs.push_back(basic(Method::slim)), jobs.back().stop.tolerance = 1e-2;
  jobs.push_back(basic(Method::arap)), jobs.back().repair = RepairMethod::virtual_boundary;
  jobs.push_back(basic(Method::arap)), jobs.back().max_charts = 1;
  jobs.push_back(basic(Method::abf)), jobs.back().seams = SeamMode::keep;
  jobs.push_back(basic(Method::abf)), jobs.back().padding = 7;
  add_held(jobs);
  return jobs;
}

/// A disk, the same at other places and at another size, one with a hole, a folded one; the last is
/// a body.
std::vector<Surfaces> all_meshes() {
  const TriMesh disk = shapes::random_disk(5, 3);
  TriMesh larger = disk;
  for (Vec3& p : larger.positions) p *= 3;
  std::vector<Surfaces> meshes;
  for (const TriMesh& mesh : {disk, bent(disk, 0.4), larger, bent(shapes::annulus(12, 3), 0.6),
                              shapes::slivers(5, 2, 0.02), shapes::sphere(0)})
    meshes.push_back({shapes::surface_of(mesh)});
  return meshes;
}

/// What is refused is told by its code.
std::string outcome(const Surfaces& mesh, const UnwrapOptions& options, SolverCache* cache,
                    int threads = 1) {
  try {
    return answer(mesh, options, cache, threads);
  } catch (const Error& error) {
    return "error " + std::to_string(static_cast<int>(error.code()));
  }
}

struct Question {
  std::size_t mesh, job;
};

constexpr std::size_t kJobsOfABody = 2;  // taking one apart takes as long as many disks

std::vector<Question> all_questions(std::size_t meshes, std::size_t jobs) {
  std::vector<Question> questions;
  for (std::size_t m = 0; m < meshes; ++m)
    for (std::size_t k = 0; k < (m + 1 < meshes ? jobs : kJobsOfABody); ++k)
      questions.push_back({m, k});
  return questions;
}

void shuffle(std::vector<Question>& questions, unsigned seed) {
  std::mt19937 random(seed);
  for (std::size_t i = questions.size(); i > 1; --i)
    std::swap(questions[i - 1], questions[random() % i]);
}

unsigned number_from(const char* variable, unsigned otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? static_cast<unsigned>(std::atoi(text)) : otherwise;
}

TEST(JobsInAnyOrder, AnswerAsAFreshProcessDoes) {
  const std::vector<Surfaces> meshes = all_meshes();
  const std::vector<UnwrapOptions> jobs = all_jobs();
  std::vector<Question> questions = all_questions(meshes.size(), jobs.size());
  std::map<std::pair<std::size_t, std::size_t>, std::string> alone;
  for (const auto& [m, k] : questions) alone[{m, k}] = outcome(meshes[m], jobs[k], nullptr);
  const unsigned first = number_from("UNWRAPD_ORDER_SEED", 1);
  for (unsigned seed = first; seed < first + number_from("UNWRAPD_ORDERS", 2); ++seed) {
    const std::int64_t room = seed % 2 == 0 ? 100'000 : kRoomForAll.cache_bytes;
    SolverCache cache({.cache_bytes = room, .job_bytes = kRoomForAll.job_bytes}, 1);
    shuffle(questions, seed);
    for (const auto& [m, k] : questions) {
      const std::string again = outcome(meshes[m], jobs[k], &cache, 1 + static_cast<int>(seed % 2));
      const bool is_same = again == alone.at({m, k});
      EXPECT_TRUE(is_same) << "seed " << seed << ", mesh " << m << ", job " << k;
    }
  }
}

}  // namespace
}  // namespace unwrapd::server::work
