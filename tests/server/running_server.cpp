#include "running_server.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include "tests/server/test_database.hpp"

namespace unwrapd::server {
namespace {

struct Grid {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
};

Grid grid(int size) {
  Grid grid;
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(size);
      const float v = static_cast<float>(y) / static_cast<float>(size);
      for (const float value : {u, v, 0.3F * std::sin(5 * u) * std::cos(4 * v)})
        grid.positions.push_back(value);
    }
  }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (size + 1) + x); };
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      for (const std::uint32_t index :
           {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y), at(x + 1, y + 1), at(x, y + 1)})
        grid.indices.push_back(index);
    }
  }
  return grid;
}

template <class T>
std::string bytes_of(const std::vector<T>& items) {
  std::string bytes(items.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), items.data(), bytes.size());
  return bytes;
}

std::string word(std::size_t value) {
  return bytes_of<std::uint32_t>({static_cast<std::uint32_t>(value)});
}

api::Json document(int size, const api::Json& buffer) {
  const Grid g = grid(size);
  const std::size_t position_bytes = g.positions.size() * sizeof(float);
  const std::size_t index_bytes = g.indices.size() * sizeof(std::uint32_t);
  return {{"asset", {{"version", "2.0"}}},
          {"buffers", {buffer}},
          {"bufferViews",
           {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", position_bytes}},
            {{"buffer", 0}, {"byteOffset", position_bytes}, {"byteLength", index_bytes}}}},
          {"accessors",
           {{{"bufferView", 0},
             {"componentType", 5126},
             {"count", g.positions.size() / 3},
             {"type", "VEC3"},
             {"min", {0, 0, -0.3}},
             {"max", {1, 1, 0.3}}},
            {{"bufferView", 1},
             {"componentType", 5125},
             {"count", g.indices.size()},
             {"type", "SCALAR"}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}}};
}

}  // namespace

std::string grid_obj(int size) {
  const Grid g = grid(size);
  std::string text;
  for (std::size_t v = 0; v < g.positions.size(); v += 3) {
    text += "v";
    for (std::size_t k = 0; k < 3; ++k) text += " " + std::to_string(g.positions[v + k]);
    text += "\n";
  }
  for (std::size_t t = 0; t < g.indices.size(); t += 3) {
    text += "f";
    for (std::size_t k = 0; k < 3; ++k) text += " " + std::to_string(g.indices[t + k] + 1);
    text += "\n";
  }
  return text;
}

std::string grid_buffer(int size) {
  const Grid g = grid(size);
  return bytes_of(g.positions) + bytes_of(g.indices);
}

std::string grid_gltf(int size) {
  return document(size, {{"uri", "grid.bin"}, {"byteLength", grid_buffer(size).size()}}).dump();
}

std::string grid_glb(int size) {
  const std::string bin = grid_buffer(size);
  std::string json = document(size, {{"byteLength", bin.size()}}).dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  return "glTF" + word(2) + word(28 + json.size() + bin.size()) + word(json.size()) + "JSON" +
         json + word(bin.size()) + std::string("BIN\0", 4) + bin;
}

void await(const std::function<bool()>& condition) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > give_up) FAIL() << "awaited in vain";
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

RunningServer::RunningServer() {
  config_.listen.port = 0;
  config_.data = dir_.path();
  config_.database = postgres_of(dir_.path());
  config_.workers = 2;
  config_.threads = 2;
  config_.limits.max_streams = 8;
  config_.allowed_hosts = {"x"};  // what requests in raw bytes name
}

void RunningServer::start() { service_ = std::make_unique<Service>(config_, log_); }

void RunningServer::restart() {
  service_->drain();
  service_.reset();
  start();
}

httplib::Client RunningServer::client() const {
  httplib::Client client("127.0.0.1", service_->port());
  client.set_read_timeout(std::chrono::minutes(10));
  return client;
}

std::string RunningServer::submit(const std::string& query, int size) {
  const httplib::Headers bypass_cache = {
      {"Cache-Control", "no-cache"}};  // not answered from the store
  const bool has_preset = query.find("preset=") != std::string::npos;
  const std::string more = query.empty() ? "" : "&" + query.substr(1);
  const std::string path = "/v1/jobs" + (has_preset ? query : "?preset=chart" + more);
  const auto answer = client().Post(path, bypass_cache, grid_obj(size), "model/obj");
  if (!answer || answer->status != 202) {
    ADD_FAILURE() << "no job: " << (answer ? answer->body : "no answer");
    return "none";
  }
  return api::Json::parse(answer->body).at("id");
}

api::Json RunningServer::job(const std::string& id) {
  const auto answer = client().Get("/v1/jobs/" + id);
  if (!answer || answer->status != 200) return {{"state", "unknown"}};
  return api::Json::parse(answer->body);
}

void RunningServer::await_state(const std::string& id, const std::string& expected) {
  await([&] { return state(id) == expected; });
}

httplib::Result RunningServer::get(const std::string& id, const std::string& what,
                                   const httplib::Headers& headers) {
  return client().Get("/v1/jobs/" + id + "/" + what, headers);
}

void expect_problem(const httplib::Result& answer, int status, const std::string& code) {
  ASSERT_TRUE(answer) << httplib::to_string(answer.error());
  EXPECT_EQ(answer->status, status) << answer->body;
  EXPECT_EQ(answer->get_header_value("Content-Type"), "application/problem+json");
  const api::Json problem = api::Json::parse(answer->body, nullptr, false);
  ASSERT_TRUE(problem.is_object()) << answer->body;
  EXPECT_EQ(problem.value("code", ""), code);
  EXPECT_EQ(problem.value("status", 0), status);
}

}  // namespace unwrapd::server
