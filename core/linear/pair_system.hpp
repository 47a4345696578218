#pragma once
// A symmetric positive definite matrix with two unknowns a vertex and the pattern of a mesh. It is
// assembled from one 6-by-6 element a face, analysed once, and refilled and refactored for every
// new set of elements. Rejected: triplets and a new matrix each time, which is as slow as the
// factor.

#include <array>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/linear/engine.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {

/// Row and column 2i + c belong to unknown c of corner i. Only the lower triangle is read.
using PairElement = std::array<std::array<double, 6>, 6>;

/// The lower triangle of such a matrix, all zeros: row 2s + c for unknown c of slot s, in whole
/// blocks. Vertices may share a slot; those whose slot is kFixed are left out. Throws
/// Error{cancelled}.
SparseMatrix pair_pattern(std::span<const Triangle> faces, const FreeVertices& slots,
                          const std::stop_token& stop = {});

/// The index among the values of entry (a, b) or (b, a), which must be in the pattern.
Index entry_of(const SparseMatrix& lower, Index a, Index b);

class PairSystem {
 public:
  /// faces index slots: the unknowns of vertex v are rows 2 slot[v] and 2 slot[v] + 1; vertices may
  /// share a slot, and those whose slot is kFixed have none. slots must outlive the system;
  /// count > 0. Throws Error{cancelled}, as factor() does.
  PairSystem(std::span<const Triangle> faces, const FreeVertices& slots, std::stop_token stop = {});

  /// Bytes during factoring, pattern and targets included.
  [[nodiscard]] std::size_t bytes() const;

  void clear();

  /// Adds the element of face t. May throw Error{cancelled}.
  void add(std::size_t t, const PairElement& element);

  /// Factors the sum of the elements added since clear(). If it is not positive definite in double
  /// precision the diagonal is raised, by a hundredth of it at most. Returns false if that does not
  /// help.
  [[nodiscard]] bool factor();

  /// Replaces b, one pair a slot, by the solution. Throws Error{cancelled}.
  void solve(std::vector<Vec2>& b) const;

 private:
  /// The position of an element's entry in lower_'s values, or -1: not stored. An entry off the
  /// element's diagonal that is added to the matrix's diagonal counts twice, for both triangles.
  struct Target {
    Index at;
    bool is_twice;
  };
  using FaceTargets = std::array<Target, 21>;  ///< of a face's lower triangle, by rows

  [[nodiscard]] FaceTargets targets(const Triangle& face) const;
  void raise_diagonal(double share);

  const FreeVertices& slots_;
  std::stop_token stop_;
  SparseMatrix lower_;
  std::vector<FaceTargets> target_;
  std::optional<Factor> factor_;
};

}  // namespace unwrapd::linear
