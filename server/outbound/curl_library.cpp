#include "server/outbound/curl_library.hpp"

#include "server/base/loaded_library.hpp"

namespace unwrapd::server::outbound {

CurlLibrary::CurlLibrary() {
  const LoadedLibrary library("libcurl.so.4",  // the one that uses OpenSSL
                              "libcurl4", "Other servers cannot be called; tell the operator.");
  decltype(&::curl_global_init) global_init = nullptr;
  library.find(global_init, "curl_global_init");
  library.find(easy_init, "curl_easy_init");
  library.find(easy_cleanup, "curl_easy_cleanup");
  library.find(easy_reset, "curl_easy_reset");
  library.find(easy_perform, "curl_easy_perform");
  library.find(easy_setopt, "curl_easy_setopt");
  library.find(easy_getinfo, "curl_easy_getinfo");
  library.find(easy_strerror, "curl_easy_strerror");
  library.find(multi_init, "curl_multi_init");
  library.find(multi_cleanup, "curl_multi_cleanup");
  library.find(multi_add_handle, "curl_multi_add_handle");
  library.find(multi_remove_handle, "curl_multi_remove_handle");
  library.find(multi_perform, "curl_multi_perform");
  library.find(multi_poll, "curl_multi_poll");
  library.find(multi_wakeup, "curl_multi_wakeup");
  library.find(multi_info_read, "curl_multi_info_read");
  library.find(slist_append, "curl_slist_append");
  library.find(slist_free_all, "curl_slist_free_all");
  library.find(url, "curl_url");
  library.find(url_cleanup, "curl_url_cleanup");
  library.find(url_set, "curl_url_set");
  library.find(url_get, "curl_url_get");
  library.find(free, "curl_free");
  if (global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) library.cannot_load("it cannot be initialised");
}

const CurlLibrary& CurlLibrary::loaded() {
  static const CurlLibrary library;
  return library;
}

}  // namespace unwrapd::server::outbound
