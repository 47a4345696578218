#include "core/solve/methods.hpp"

#include "core/error.hpp"

namespace unwrapd {

Solution other_method(const Disk& disk, Method method, const SolveWatch& watch,
                      Executor& executor) {
  static_cast<void>(disk), static_cast<void>(watch), static_cast<void>(executor);
  switch (method) {
    default:
      throw Error(ErrorCode::invalid_option, "there is no such method", "/method");
  }
}

}  // namespace unwrapd
