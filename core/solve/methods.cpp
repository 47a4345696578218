#include "core/solve/methods.hpp"

#include "core/error.hpp"
#include "core/solve/abf.hpp"
#include "core/solve/bff.hpp"
#include "core/solve/cp.hpp"
#include "core/solve/ic.hpp"
#include "core/solve/linabf.hpp"
#include "core/solve/slim.hpp"

namespace unwrapd {

Solution other_method(const Disk& disk, const SolveOptions& options, const SolveWatch& watch,
                      Executor& executor) {
  switch (options.method) {
    case Method::abf:
      return abf(disk, watch, executor);
    case Method::linabf:
      return linabf(disk, watch, executor);
    case Method::slim:
      return slim(disk, options.stop, watch, executor);
    case Method::bff:
      return bff(disk, watch);
    case Method::ic:
      return ic(disk, watch);
    case Method::cp:
      return cp(disk, watch);
    default:
      throw Error(ErrorCode::invalid_option, "there is no such method", "/method");
  }
}

}  // namespace unwrapd
