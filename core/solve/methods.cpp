#include "core/solve/methods.hpp"

#include "core/error.hpp"
#include "core/solve/bff.hpp"
#include "core/solve/cp.hpp"

namespace unwrapd {

Solution other_method(const Disk& disk, Method method, const SolveWatch& watch,
                      Executor& executor) {
  static_cast<void>(executor);
  switch (method) {
    case Method::bff:
      return bff(disk, watch);
    case Method::cp:
      return cp(disk, watch);
    default:
      throw Error(ErrorCode::invalid_option, "there is no such method", "/method");
  }
}

}  // namespace unwrapd
