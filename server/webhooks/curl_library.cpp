#include "server/webhooks/curl_library.hpp"

#include <dlfcn.h>

#include "server/base/errors.hpp"

namespace unwrapd::server::webhooks {
namespace {

constexpr const char* kFile = "libcurl.so.4";  // the one that uses OpenSSL

[[noreturn]] void cannot_load(const std::string& reason) {
  throw InsideError(ErrorCode::internal, "Webhooks cannot be called; tell the operator.",
                    "libcurl cannot be loaded (Debian package libcurl4): " + reason);
}

}  // namespace

CurlLibrary::CurlLibrary() {
  void* const library = ::dlopen(kFile, RTLD_NOW | RTLD_LOCAL);  // stays to the program's end
  if (library == nullptr) cannot_load(::dlerror());
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    if (function == nullptr) cannot_load(std::string("it has no ") + name);
  };
  decltype(&::curl_global_init) global_init = nullptr;
  find(global_init, "curl_global_init");
  find(easy_init, "curl_easy_init");
  find(easy_cleanup, "curl_easy_cleanup");
  find(easy_setopt, "curl_easy_setopt");
  find(easy_getinfo, "curl_easy_getinfo");
  find(easy_strerror, "curl_easy_strerror");
  find(multi_init, "curl_multi_init");
  find(multi_cleanup, "curl_multi_cleanup");
  find(multi_add_handle, "curl_multi_add_handle");
  find(multi_remove_handle, "curl_multi_remove_handle");
  find(multi_perform, "curl_multi_perform");
  find(multi_poll, "curl_multi_poll");
  find(multi_wakeup, "curl_multi_wakeup");
  find(multi_info_read, "curl_multi_info_read");
  find(slist_append, "curl_slist_append");
  find(slist_free_all, "curl_slist_free_all");
  if (global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) cannot_load("it cannot be initialised");
}

const CurlLibrary& CurlLibrary::loaded() {
  static const CurlLibrary library;
  return library;
}

}  // namespace unwrapd::server::webhooks
