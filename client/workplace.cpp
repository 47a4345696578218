#include "client/workplace.hpp"

#include "client/failure.hpp"
#include "client/files.hpp"
#include "client/http.hpp"
#include "core/base/error.hpp"
#include "server/private_server.hpp"

namespace unwrapd::client {
namespace {

constexpr int kJobsHere = 4;  // of several meshes, unless the command says how many

bool answers(const ServerUrl& server, const std::stop_token& stop) {
  try {
    static_cast<void>(Http(server, stop).get("/healthz"));
    return true;
  } catch (const Failure& failure) {
    if (failure.code() == ExitCode::unreachable) return false;
    throw;
  }
}

std::unique_ptr<server::PrivateServer> server_of_its_own(int jobs) {
  try {
    return std::make_unique<server::PrivateServer>(jobs);
  } catch (const Error& error) {
    throw Failure(ExitCode::file, std::string("The job cannot run here: ") + error.what());
  }
}

}  // namespace

Workplace::Workplace(const Arguments& arguments, const std::stop_token& stop)
    : servers_(arguments.servers) {
  const bool is_elsewhere =
      arguments.place == Place::server ||
      (arguments.place == Place::any && answers(arguments.servers.front(), stop));
  if (is_elsewhere) return;
  if (is_address(arguments.file))
    throw Failure(ExitCode::usage,
                  "An address is read by a server; name one by --server, or download the mesh.");
  const int jobs = arguments.jobs > 0 ? arguments.jobs : kJobsHere;
  own_ = server_of_its_own(arguments.inputs.empty() ? 1 : jobs);
  ServerUrl here = parse_server_url(own_->url());
  here.key = own_->key();
  servers_ = here;
}

Workplace::~Workplace() = default;

}  // namespace unwrapd::client
