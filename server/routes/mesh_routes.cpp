#include "server/routes/mesh_routes.hpp"

#include "server/base/clock.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr std::string_view kPath = "/v1/meshes/{sha256}";

api::Json mesh_json(const uploads::Meshes& meshes, const store::MeshRecord& mesh,
                    std::chrono::seconds kept) {
  const std::int64_t kept_ms = std::chrono::milliseconds(kept).count() + meshes.now().set_by_ms;
  return api::to_json(api::Mesh{.sha256 = mesh.sha256,
                                .bytes = mesh.bytes,
                                .media_type = mesh.media_type,
                                .created = rfc3339(mesh.created_ms),
                                .expires = rfc3339(mesh.kept_since_ms + kept_ms)});
}

http::Response put_mesh(uploads::Meshes& meshes, const http::Request& request,
                        std::chrono::seconds kept) {
  const uploads::SentMesh sent = meshes.receive(request, request.sha256);
  http::Response response = http::uncached_json_response(sent.is_new ? 201 : 200,
                                                         mesh_json(meshes, sent.mesh, kept).dump());
  response.headers.emplace_back("Location", api::mesh_path(request.sha256));
  return response;
}

http::Response get_mesh(uploads::Meshes& meshes, const http::Request& request,
                        std::chrono::seconds kept) {
  const store::MeshRecord mesh = meshes.find(request.caller.owner, request.sha256);
  api::Json json = mesh_json(meshes, mesh, kept);
  json.update(meshes.analysis(mesh, request.has_left));
  return http::uncached_json_response(200, json.dump());
}

}  // namespace

void add_mesh_routes(std::vector<http::Route>& routes, uploads::Meshes& meshes,
                     std::chrono::seconds kept) {
  routes.push_back({"PUT", kPath, [&meshes, kept](const http::Request& request) {
                      return put_mesh(meshes, request, kept);
                    }});
  routes.push_back({"GET", kPath, [&meshes, kept](const http::Request& request) {
                      return get_mesh(meshes, request, kept);
                    }});
}

}  // namespace unwrapd::server::routes
