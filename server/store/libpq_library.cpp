#include "server/store/libpq_library.hpp"

#include <dlfcn.h>

#include <string>
#include <type_traits>

#include "server/base/errors.hpp"

namespace unwrapd::server::store {
namespace {

constexpr const char* kFile = "libpq.so.5";

[[noreturn]] void cannot_load(const std::string& reason) {
  throw InsideError(ErrorCode::internal, "The server's database cannot be used.",
                    "libpq cannot be loaded (Debian package libpq5): " + reason);
}

}  // namespace

LibpqLibrary::LibpqLibrary() {
  void* const library = ::dlopen(kFile, RTLD_NOW | RTLD_LOCAL);  // stays to the program's end
  if (library == nullptr) cannot_load(::dlerror());
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    if (function == nullptr) cannot_load(std::string("it has no ") + name);
  };
  find(connect, "PQconnectdbParams");
  find(parse, "PQconninfoParse");
  find(free_parsed, "PQconninfoFree");
  find(free_text, "PQfreemem");
  find(finish, "PQfinish");
  find(status, "PQstatus");
  find(error_message, "PQerrorMessage");
  find(parameter_status, "PQparameterStatus");
  find(exec, "PQexec");
  find(prepare, "PQprepare");
  find(exec_prepared, "PQexecPrepared");
  find(result_status, "PQresultStatus");
  find(result_error_field, "PQresultErrorField");
  find(cmd_tuples, "PQcmdTuples");
  find(row_count, "PQntuples");
  find(value, "PQgetvalue");
  find(length, "PQgetlength");
  find(clear, "PQclear");
}

const LibpqLibrary& LibpqLibrary::loaded() {
  static const LibpqLibrary library;
  return library;
}

}  // namespace unwrapd::server::store
