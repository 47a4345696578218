#pragma once
// Which file has the rows of jobs and meshes, and what is done where it is not there.

#include <filesystem>

#include "server/store/blob_store.hpp"

namespace unwrapd::server::store {

inline constexpr const char* kStoreFile = "jobs.sqlite";

/// The file in the data directory. Throws Error{storage_failed} when it has no tables although
/// there are files of jobs: nothing knows them then, and the sweep at the start would take them
/// all.
std::filesystem::path store_in(const std::filesystem::path& data, const BlobStore& blobs);

}  // namespace unwrapd::server::store
