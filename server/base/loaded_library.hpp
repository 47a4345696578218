#pragma once
// A shared library that is loaded when it is first needed, not with the program.

#include <dlfcn.h>

#include <string>
#include <type_traits>
#include <utility>

#include "server/base/errors.hpp"

namespace unwrapd::server {

/// It stays loaded to the program's end.
class LoadedLibrary {
 public:
  /// package: of Debian, told to the operator where it cannot be loaded. told: what clients read
  /// then. Throws InsideError{internal} then, as find() does.
  LoadedLibrary(std::string file, std::string package, std::string told)
      : file_(std::move(file)),
        package_(std::move(package)),
        told_(std::move(told)),
        library_(::dlopen(file_.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (library_ == nullptr) cannot_load(::dlerror());
  }

  /// Sets function to the one of this name.
  template <class Function>
  void find(Function& function, const char* name) const {
    function = reinterpret_cast<std::remove_reference_t<Function>>(::dlsym(library_, name));
    if (function == nullptr) cannot_load(std::string("it has no ") + name);
  }

  [[noreturn]] void cannot_load(const std::string& reason) const {
    throw InsideError(ErrorCode::internal, told_,
                      file_ + " cannot be loaded (Debian package " + package_ + "): " + reason);
  }

 private:
  std::string file_;
  std::string package_;
  std::string told_;
  void* library_;
};

}  // namespace unwrapd::server
