#include "core/solve/methods.hpp"

#include "core/base/error.hpp"
#include "core/solve/methods/abf.hpp"
#include "core/solve/methods/bff.hpp"
#include "core/solve/methods/cp.hpp"
#include "core/solve/methods/ic.hpp"
#include "core/solve/methods/linabf.hpp"
#include "core/solve/methods/slim.hpp"

namespace unwrapd::solve {

Solution other_method(const Disk& disk, const SolveOptions& options, const SolveWatch& watch,
                      Executor& executor) {
  switch (options.method) {
    case Method::abf:
      return methods::abf(disk, watch, executor);
    case Method::linabf:
      return methods::linabf(disk, watch, executor);
    case Method::slim:
      return methods::slim(disk, options.stop, watch, executor);
    case Method::bff:
      return methods::bff(disk, watch);
    case Method::ic:
      return methods::ic(disk, watch);
    case Method::cp:
      return methods::cp(disk, watch);
    default:
      throw Error(ErrorCode::invalid_option, "there is no such method", "/method");
  }
}

}  // namespace unwrapd::solve
