// A job has the name that its sender gives it, in whatever form the request comes.
#include <gmock/gmock.h>

#include "server/base/identity.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::uploads {
namespace {

const std::string kChair = "Stuhl \u201eM\u00fcller\u201c \u2116 7 \U0001FA91";

/// Every byte by its number, as a query may have it.
std::string encoded(const std::string& text) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string all;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    all += {'%', digits[byte / 16], digits[byte % 16]};
  }
  return all;
}

class JobNames : public RunningServer {
 protected:
  JobNames() { config_.workers = 1; }

  static api::Json job_in(const httplib::Result& answer) {
    EXPECT_TRUE(answer->status == 200 || answer->status == 202) << answer->body;
    return api::Json::parse(answer->body);
  }
  static std::string name_in(const httplib::Result& answer) {
    return job_in(answer).value("name", "none");
  }
  httplib::Result post(const std::string& query) {
    return client().Post("/v1/jobs" + query, grid_obj(2), "model/obj");
  }
  httplib::Result post_form(const std::vector<std::pair<std::string, std::string>>& fields,
                            const std::string& query = "") {
    httplib::MultipartFormDataItems items;
    for (const auto& [name, text] : fields) items.push_back({name, text, "", ""});
    items.push_back({"file", grid_obj(2), "grid.obj", "model/obj"});
    return client().Post("/v1/jobs" + query, items);
  }
  std::vector<std::string> listed(const std::string& query) {
    std::vector<std::string> ids;
    const api::Json page = api::Json::parse(client().Get("/v1/jobs" + query)->body);
    for (const api::Json& job : page.at("jobs")) ids.push_back(job.at("id"));
    return ids;
  }
};

TEST_F(JobNames, ComeInAQueryAFormOrJson) {
  start();
  EXPECT_EQ(name_in(post("")), "none");
  EXPECT_EQ(name_in(post("?name=")), "none") << "as an empty field of a form";
  EXPECT_EQ(name_in(post("?method=asap&name=" + encoded(kChair))), kChair);
  EXPECT_EQ(name_in(post_form({{"name", kChair}, {"method", "asap"}})), kChair);
  EXPECT_EQ(name_in(post_form({{"name", kChair}, {"options", R"({"method":"asap"})"}})), kChair);
  EXPECT_EQ(name_in(post_form({{"method", "asap"}}, "?name=" + encoded(kChair))), kChair);
  const std::string mesh = grid_glb(2);
  ASSERT_EQ(client().Put("/v1/meshes/" + sha256(mesh), mesh, "model/gltf-binary")->status, 201);
  const api::Json named = {{"mesh", sha256(mesh)}, {"name", kChair}};
  EXPECT_EQ(name_in(client().Post("/v1/jobs", named.dump(), "application/json")), kChair);
  EXPECT_EQ(name_in(client().Post("/v1/meshes/" + sha256(mesh) + "/jobs?name=a", "{}",
                                  "application/json")),
            "a");
  const std::string id = "j_0123456789abcdef0123456789abcdef";
  EXPECT_EQ(name_in(client().Put("/v1/jobs/" + id + "?name=b", grid_obj(2), "model/obj")), "b");
}

TEST_F(JobNames, AreShownWhereverTheJobIs) {
  start();
  const std::string id = job_in(post("?name=" + encoded(kChair))).at("id");
  await_state(id, "succeeded");
  EXPECT_EQ(job(id).at("name"), kChair);
  EXPECT_THAT(get(id, "events")->body, testing::HasSubstr(kChair));
  restart();
  EXPECT_EQ(job(id).at("name"), kChair);
  const api::Json page = api::Json::parse(client().Get("/v1/jobs")->body);
  EXPECT_EQ(page.at("jobs").at(0).at("name"), kChair);
}

TEST_F(JobNames, FilterTheList) {
  start();
  const std::string first = job_in(post("?name=a")).at("id");
  job_in(post("?name=A"));
  job_in(post(""));
  const std::string last = job_in(post("?name=a&resolution=512")).at("id");
  EXPECT_EQ(listed("?name=a"), (std::vector{last, first}));
  EXPECT_EQ(listed("?name=b"), std::vector<std::string>());
  await_state(first, "succeeded");
  await_state(last, "succeeded");
  EXPECT_EQ(listed("?name=a&state=succeeded&limit=1"), std::vector{last});
  EXPECT_EQ(listed("?name=a&state=queued"), std::vector<std::string>());
}

TEST_F(JobNames, AreNoPartOfTheQuestion) {
  start();
  const std::string first = job_in(post("?name=a")).at("id");
  await_state(first, "succeeded");
  const api::Json again = job_in(post("?name=b"));
  EXPECT_NE(again.at("id"), first);
  EXPECT_EQ(job(again.at("id")).at("attempt"), 0) << "answered from the store";
  const auto send = [&](const std::string& name) {
    return job_in(client().Post("/v1/jobs?name=" + name, {{"Idempotency-Key", "one"}}, grid_obj(2),
                                "model/obj"));
  };
  const api::Json once = send("c"), twice = send("d");
  EXPECT_EQ(once.at("id"), twice.at("id"));
  EXPECT_EQ(twice.at("name"), "c") << "that of the job that was made";
}

TEST_F(JobNames, AreBoundedAndPlain) {
  start();
  std::string longest;
  for (int k = 0; k < 200; ++k) longest += "\u00e4";
  EXPECT_EQ(name_in(post("?name=" + encoded(longest))), longest);
  for (const std::string& name :
       {longest + "a", std::string("a\nb"), std::string("a\x7f"), std::string("\u0085"),
        std::string("\u202egnp.exe"), std::string("a\0b", 3)}) {
    const auto answer = post("?name=" + encoded(name));
    expect_problem(answer, 422, "invalid_option");
    EXPECT_EQ(api::Json::parse(answer->body).at("pointer"), "/name");
  }
  expect_problem(post("?name=a&name=b"), 422, "invalid_option");
  expect_problem(post_form({{"name", "a"}, {"name", "b"}}), 422, "invalid_option");
  expect_problem(post_form({{"name", "a"}}, "?name=b"), 422, "invalid_option");
  expect_problem(post("?name=%FF"), 400, "malformed_request");
  expect_problem(post_form({{"name", "\xff"}}), 422, "invalid_option");
  expect_problem(client().Get("/v1/jobs?name=a%0Ab"), 422, "invalid_option");
  const api::Json number = {{"mesh", sha256("")}, {"name", 7}};
  expect_problem(client().Post("/v1/jobs", number.dump(), "application/json"), 422,
                 "invalid_option");
}

}  // namespace
}  // namespace unwrapd::server::uploads
