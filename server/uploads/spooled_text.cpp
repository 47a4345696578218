#include "server/uploads/spooled_text.hpp"

namespace unwrapd::server::uploads {
namespace {

constexpr std::size_t kMostInMemory = std::size_t{64} * 1024;

}  // namespace

SpooledText::~SpooledText() {
  if (file_) remove_tree(path_);
  if (taken_ > 0) room_.put_back(taken_);
}

void SpooledText::append(std::string_view bytes) {
  unwritten_ += bytes;
  size_ += bytes.size();
  if (unwritten_.size() > kMostInMemory) spill();
}

void SpooledText::spill() {
  const auto bytes = static_cast<std::int64_t>(unwritten_.size());
  room_.take(bytes);
  taken_ += bytes;
  if (!file_) file_.emplace(File::create(path_));
  file_->append(unwritten_);
  unwritten_.clear();
}

std::string SpooledText::read() {
  if (!file_) return unwritten_;
  spill();
  return read_file(path_);
}

}  // namespace unwrapd::server::uploads
