// The options of where jobs and their files are kept.
#include <string_view>

#include "server/config/config_row.hpp"

namespace unwrapd::server::config {
namespace {

constexpr std::int64_t kMaxDiskBytes = std::int64_t{1} << 60;
constexpr std::string_view kDirectory = "dir:";  // before a path of --blobs

ConfigRow database_row() {
  return {
      .heading = {.name = "database",
                  .takes = "URL",
                  .what = "PostgreSQL database of the jobs, meshes, keys and webhooks, "
                          "postgres://user@host/name; their files stay in --data. Unset: SQLite "
                          "in --data",
                  .is_secret = true},
      .kind = ConfigKind::text,
      .set =
          [](Config& config, const std::string& text) {
            const bool is_url =
                text.starts_with("postgres://") || text.starts_with("postgresql://");
            if (!text.empty() && !is_url) expected("a URL like postgres://user@host/name");
            config.database.url = text;
          },
      .get = [](const Config& config) { return config.database.url; }};
}

ConfigRow blobs_row() {
  return {
      .heading = {"blobs", "PLACE",
                  "Where nodes that use the same --database keep their files: a shared directory "
                  "(dir:/srv/unwrapd) or a bucket (s3://bucket/prefix); --data is this node's own "
                  "then. Unset: files stay in --data, and no other server may use the database"},
      .kind = ConfigKind::text,
      .set =
          [](Config& config, const std::string& text) {
            const bool is_directory = text.starts_with(kDirectory) && text != kDirectory;
            const bool is_bucket = bucket::is_bucket_url(text);
            if (!text.empty() && !is_directory && !is_bucket)
              expected("dir: and the path of a directory, or a bucket like s3://name/prefix");
            config.shared_blobs = is_directory ? text.substr(kDirectory.size()) : "";
            config.bucket.url = is_bucket ? text : "";
          },
      .get =
          [](const Config& config) {
            const std::string path = config.shared_blobs.string();
            return path.empty() ? config.bucket.url : std::string(kDirectory) + path;
          }};
}

ConfigRow endpoint_row(const ConfigHeading& heading, std::string bucket::BucketConfig::*endpoint) {
  return {.heading = heading,
          .kind = ConfigKind::text,
          .set =
              [=](Config& config, const std::string& text) {
                if (!text.empty() && !bucket::is_endpoint(text))
                  expected("a URL like https://s3.example.com, without a path");
                config.bucket.*endpoint = text;
              },
          .get = [=](const Config& config) { return config.bucket.*endpoint; }};
}

ConfigRow lease_row() {
  constexpr Range kSeconds{3, 3600};
  return {
      .heading = {"lease-seconds", "N",
                  "Seconds after which a running job whose node shows no sign of life is run by "
                  "another node. Nodes show one three times as often"},
      .kind = ConfigKind::number,
      .set =
          [=](Config& config, const std::string& text) {
            config.lease = std::chrono::seconds(number_in(kSeconds, text));
          },
      .get = [](const Config& config) { return std::to_string(config.lease.count()); }};
}

}  // namespace

ConfigGroup storing() {
  return {.title = "Storage",
          .rows = {
              database_row(), blobs_row(),
              endpoint_row({"s3-endpoint", "URL",
                            "Server of the bucket, such as https://s3.example.com. Unset: Amazon's "
                            "of --s3-region"},
                           &bucket::BucketConfig::endpoint),
              text({"s3-region", "NAME", "Region of the bucket"}, &Config::bucket,
                   &bucket::BucketConfig::region),
              text({"s3-credentials", "PATH",
                    "File with the id of an access key and its secret, a line each. Unset: "
                    "AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY of the environment"},
                   &Config::bucket, &bucket::BucketConfig::credentials),
              number({"blob-cache-bytes", "N",
                      "Bytes in --data for copies of the bucket's files; those used longest ago go "
                      "first"},
                     {0, kMaxDiskBytes}, &Config::copied_bytes),
              on_off({"blob-redirect", "",
                      "GET of a result answers 307 with a link to the bucket, which is valid for "
                      "five minutes"},
                     &Config::bucket, &bucket::BucketConfig::redirects),
              endpoint_row({"blob-redirect-endpoint", "URL",
                            "Server of the bucket as clients reach it. Unset: --s3-endpoint"},
                           &bucket::BucketConfig::redirect_endpoint),
              lease_row(),
              number({"keep-seconds", "N", "Seconds that results are kept"}, {1, kMaxCount},
                     &Config::keep_seconds),
              number({"max-stored-jobs", "N",
                      "Most ended jobs that are stored; beyond it, expired jobs are deleted "
                      "first, then the oldest of the key with the most jobs. 0: no limit"},
                     {0, kMaxCount}, &Config::max_stored_jobs),
              number({"max-disk-bytes", "N",
                      "Bytes on disk for the files of all jobs; beyond it, the oldest results are "
                      "deleted early. 0: no limit"},
                     {0, kMaxDiskBytes}, &Config::disk, &blobs::DiskLimits::max_bytes),
              number({"min-free-bytes", "N",
                      "Bytes of the disk that uploads leave free; results leave half of it free"},
                     {0, kMaxDiskBytes}, &Config::disk, &blobs::DiskLimits::min_free_bytes)}};
}

}  // namespace unwrapd::server::config
