#pragma once
// What reading a file passed over: rules of its format that it breaks, without a doubt of what is
// meant. The file is read as everybody else reads it, and the report tells.

#include <cstdint>

namespace unwrapd {

enum class FileRepairKind {
  line_ends_replaced,     ///< OBJ: lines that end in CR alone; the answer has LF
  empty_indices_ignored,  ///< OBJ: corners like 1//, without the index that a slash announces
  normals_replaced,       ///< OBJ: vn that are infinite or undefined; the text keeps them
  chunks_padded,          ///< GLB: chunks whose length is no multiple of 4
  shared_nodes_kept,      ///< glTF: nodes that are children of several nodes, or several times
};

struct FileRepair {
  FileRepairKind kind = FileRepairKind::line_ends_replaced;
  std::int64_t count = 0;  ///< lines, corners, normals, chunks or nodes, as the kind says
};

}  // namespace unwrapd
