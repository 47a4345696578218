#include "server/keys_command.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>

#include "server/access/key_store.hpp"
#include "server/access/shared_secret.hpp"
#include "server/access/signed_link.hpp"
#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/config/config.hpp"
#include "server/webhooks/webhooks.hpp"

namespace unwrapd::server {
namespace {

struct Asked {
  std::string config;
  std::string data = "data";
  std::string database;
  access::ApiKey key;
  std::string scopes = "submit,read";
  std::string id;
};

[[noreturn]] void unknown_key(const std::string& id) {
  throw Error(ErrorCode::not_found, "There is no key " + id + "; see unwrapd keys list.");
}

using Tables = access::KeyStore::Tables;

access::KeyStore store_of(const Asked& asked, Tables tables) {
  return access::KeyStore(asked.data, {}, {.url = asked.database}, tables);
}

void add_key(const Asked& asked) {
  access::ApiKey key = asked.key;
  key.scopes = access::parse_scopes(asked.scopes);
  std::printf("%s\n", store_of(asked, Tables::made).add(key).c_str());
  std::fprintf(stderr, "This is the key. It is not stored and cannot be shown again.\n");
}

/// Opens the keys of an existing data directory or database: a misspelt one is not created.
access::KeyStore opened(const Asked& asked) {
  if (!asked.database.empty()) return store_of(asked, Tables::existing);
  const std::filesystem::path file = std::filesystem::path(asked.data) / access::kKeysFile;
  if (std::filesystem::exists(file)) return store_of(asked, Tables::existing);
  throw Error(ErrorCode::not_found,
              "There is no " + file.string() + "; give the --data directory of a server.");
}

void list_keys(const Asked& asked) {
  for (const access::ApiKey& key : opened(asked).all()) {
    std::printf(
        "%s  %s  scopes=%s  requests-per-minute=%lld  max-jobs=%lld  max-bytes=%lld  %s\n",
        key.id.c_str(), rfc3339(key.created_ms).c_str(), access::to_text(key.scopes).c_str(),
        static_cast<long long>(key.requests_per_minute), static_cast<long long>(key.quota.max_jobs),
        static_cast<long long>(key.quota.max_bytes), key.name.c_str());
  }
}

void remove_key(const Asked& asked) {
  if (!opened(asked).remove(asked.id)) unknown_key(asked.id);
}

void tell_webhook_secret(const Asked& asked) {
  access::KeyStore keys = opened(asked);
  const bool is_stored = !asked.id.empty() && asked.id != access::kGivenKeyId;
  if (is_stored && !keys.with_id(asked.id)) unknown_key(asked.id);
  const std::optional<std::string> shared = access::known_shared_secret({.url = asked.database});
  const std::string secret =
      shared ? *shared : access::secret_in(std::filesystem::path(asked.data) / access::kSecretFile);
  std::printf("%s\n", webhooks::webhook_secret(secret, asked.id).c_str());
}

/// Flags and variables override the file of the server's options.
void read_config(const CLI::App& given, Asked& asked) {
  if (asked.config.empty()) return;
  const config::Config file = config::config_of_file(asked.config);
  if (given.count("--data") == 0) asked.data = file.data.string();
  if (given.count("--database") == 0) asked.database = file.database.url;
}

/// action: of the command, once it is parsed.
CLI::App* command(CLI::App& app, const std::string& name, const std::string& what, Asked& asked,
                  void (*action)(const Asked&)) {
  CLI::App* found = app.add_subcommand(name, what);
  found
      ->add_option("--config", asked.config,
                   "File with the server's options; its data and database are used")
      ->envname("UNWRAPD_CONFIG");
  found->add_option("--data", asked.data, "Directory of jobs and results")
      ->envname("UNWRAPD_DATA")
      ->capture_default_str();
  found
      ->add_option("--database", asked.database,
                   "URL of the PostgreSQL database, where one is used")
      ->envname("UNWRAPD_DATABASE");
  found->callback([&asked, found, action] {
    read_config(*found, asked);
    action(asked);
  });
  return found;
}

void declare(CLI::App& app, Asked& asked) {
  CLI::App* add = command(app, "add", "Create a key and print it", asked, add_key);
  add->add_option("--name", asked.key.name, "Name of the key, for people")->required();
  add->add_option("--scopes", asked.scopes, "Scopes, separated by commas: submit, read, admin")
      ->capture_default_str();
  const auto limit = [&](const std::string& flag, std::int64_t& value, const std::string& what) {
    add->add_option(flag, value, what + "; 0: no limit")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
  };
  limit("--requests-per-minute", asked.key.requests_per_minute,
        "Most requests of the key in a minute");
  limit("--max-jobs", asked.key.quota.max_jobs, "Most jobs of the key that wait or run");
  limit("--max-bytes", asked.key.quota.max_bytes, "Most bytes of the files of all its jobs");
  command(app, "list", "List the keys", asked, list_keys);
  CLI::App* remove = command(app, "remove", "Revoke a key; its jobs remain", asked, remove_key);
  remove->add_option("ID", asked.id, "Id of the key, from unwrapd keys list")->required();
  CLI::App* secret =
      command(app, "webhook-secret", "Print the secret that signs the webhooks of a key", asked,
              tell_webhook_secret);
  secret->add_option("ID", asked.id,
                     "Id of the key; k_file for the key of --key-file; leave it out if the server "
                     "requires no keys");
}

}  // namespace

int run_keys_command(int argc, const char* const* argv) {
  CLI::App app("Manages the API keys of a data directory, also while a server runs on it.",
               "unwrapd keys");
  app.require_subcommand(1);
  Asked asked;
  declare(app, asked);
  try {
    app.parse(argc - 1, argv + 1);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const Error& error) {
    std::fprintf(stderr, "unwrapd keys: %s\n", reason_of(error).c_str());
    return 1;
  }
}

}  // namespace unwrapd::server
