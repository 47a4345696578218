#pragma once
// Random names, which cannot be guessed, and digests of content.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;  // OpenSSL's EVP_MD_CTX

namespace unwrapd::server {

/// So many random bytes in lowercase hex.
std::string random_hex(std::size_t bytes);

/// A new job id: "j_" and 128 random bits in lowercase hex.
std::string random_job_id();

/// Whether random_job_id() can return it; any other text never reaches the store or a path.
bool is_job_id(std::string_view text);

/// A new name for the folder of a stored mesh: "m_" and as many.
std::string random_mesh_id();

bool is_mesh_id(std::string_view text);

/// True for 64 lowercase hex digits.
bool is_sha256(std::string_view text);

/// SHA-256 of bytes that are added in pieces.
class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  /// Lowercase hex, 64 characters; call once.
  std::string finish();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

std::string sha256(std::string_view bytes);

/// HMAC-SHA256: 32 bytes, as they are.
std::string hmac_sha256(std::string_view secret, std::string_view message);

/// Lowercase hex.
std::string to_hex(std::string_view bytes);

}  // namespace unwrapd::server
