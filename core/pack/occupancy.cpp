// A run of n cells hits a taken cell if either of two runs of 2^k <= n cells at its ends does. The
// page keeps one bitmap for each k, so that a run of any length costs two shifted ORs for 64 places
// at once.
#include "core/pack/occupancy.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

namespace unwrapd::pack {
namespace {

constexpr int kWordBits = 64;
constexpr std::size_t kWordsAtOnce = 4;
constexpr std::size_t kRowsRemembered = 4;  // of a wide page
constexpr std::size_t kRunWork = 4;         // cost of a run beside its words, in words

std::size_t words_for(int bits) {
  return static_cast<std::size_t>((bits + kWordBits - 1) / kWordBits);
}

}  // namespace

Occupancy::Occupancy(int width, int height, int margin, int longest_run)
    : width_(width), height_(height), margin_(margin), words_(words_for(width + 2 * margin) + 2) {
  const bool is_wide = words_ >= 2 * kWordsAtOnce;
  const std::vector<int> unknown(is_wide ? kRowsRemembered : 1, 0);
  refusing_rows_.assign(words_ / kWordsAtOnce + 1, unknown);
  while ((1 << levels_) <= std::min(longest_run, width + 2 * margin)) ++levels_;
  const std::size_t rows = static_cast<std::size_t>(height) + 2 * static_cast<std::size_t>(margin);
  bits_.assign(static_cast<std::size_t>(levels_) * rows * words_, 0);
}

Occupancy::Word* Occupancy::row(int level, int y) {
  const std::size_t rows =
      static_cast<std::size_t>(height_) + 2 * static_cast<std::size_t>(margin_);
  return bits_.data() +
         (static_cast<std::size_t>(level) * rows + static_cast<std::size_t>(y)) * words_;
}

const Occupancy::Word* Occupancy::row(int level, int y) const {
  return const_cast<Occupancy*>(this)->row(level, y);
}

/// Marks the places at which a row of the grown mask would hit a taken cell.
template <std::size_t Words>
void Occupancy::refuse(const Rows& grown, int mask_row, const Place& place,
                       std::span<Word> refused) {
  for (const Run& run : grown.row(mask_row)) {
    assert(run.begin < run.end);
    const int level =
        static_cast<int>(std::bit_width(static_cast<unsigned>(run.end - run.begin))) - 1;
    work_ += static_cast<std::int64_t>(2 * Words + kRunWork);
    for (const int shift : {run.begin, run.end - (1 << level)}) {
      const Word* taken = row(level, place.y + mask_row) + place.word + shift / kWordBits;
      const int bit = shift % kWordBits;
      for (std::size_t i = 0; i < Words; ++i)  // in two steps, since a shift by 64 is undefined
        refused[i] |= taken[i] >> bit | taken[i + 1] << 1 << (kWordBits - 1 - bit);
    }
  }
}

template <std::size_t Words>
std::optional<int> Occupancy::first_free_in(const Mask& mask, const Place& place,
                                            std::span<Word> refused) {
  const auto is_full = [](Word w) { return w == ~Word{0}; };
  const auto refuses_all = [&](int mask_row) {
    refuse<Words>(mask.grown, mask_row, place, refused);
    return std::all_of(refused.begin(), refused.end(), is_full);
  };
  std::vector<int>& refusing = refusing_rows_[place.word / kWordsAtOnce];
  const int height = mask.grown.height();
  for (auto row = refusing.begin(); row != refusing.end(); ++row) {
    const int j = *row - place.y;
    if (j < 0 || j >= height || !refuses_all(j)) continue;
    std::rotate(refusing.begin(), row, row + 1);
    return std::nullopt;
  }
  for (int k = 0; k < height;
       ++k) {  // from the middle outwards: the widest rows are refused soonest
    const int j = height / 2 + (k % 2 == 0 ? k / 2 : -(k + 1) / 2);
    if (std::ranges::find(refusing, place.y + j) != refusing.end() || !refuses_all(j)) continue;
    std::rotate(refusing.begin(), refusing.end() - 1, refusing.end());
    refusing.front() = place.y + j;
    return std::nullopt;
  }
  const auto free = std::find_if_not(refused.begin(), refused.end(), is_full);
  return static_cast<int>(place.word + static_cast<std::size_t>(free - refused.begin())) *
             kWordBits +
         std::countr_one(*free);
}

std::optional<int> Occupancy::first_free(const Mask& mask, int y, int from) {
  const int places = width_ - mask.width + 1;
  if (from >= places || y + mask.touched.height() > height_) return std::nullopt;
  const std::size_t end = words_for(places);
  for (auto word = static_cast<std::size_t>(from / kWordBits); word < end;) {
    const std::size_t count = std::min(end - word, kWordsAtOnce);
    std::array<Word, kWordsAtOnce> all{};
    const std::span<Word> refused = std::span(all).first(count);
    if (from > static_cast<int>(word) * kWordBits) refused[0] = ~(~Word{0} << (from % kWordBits));
    if (word + count == end && places % kWordBits != 0)
      refused.back() |= ~Word{0} << (places % kWordBits);
    const auto found = search(mask, {y, word}, refused);
    if (found) return found;
    word += count;
  }
  return std::nullopt;
}

bool Occupancy::is_taken(int x, int y) const {
  if (y >= height_) return false;
  if (x < 0 || x >= width_ || y < 0) return true;
  const int bit = x + margin_;
  return (row(0, y + margin_)[bit / kWordBits] >> (bit % kWordBits) & 1) != 0;
}

/// The number of words is a template argument, which is several times as fast.
std::optional<int> Occupancy::search(const Mask& mask, const Place& place,
                                     std::span<Word> refused) {
  switch (refused.size()) {
    case 1:
      return first_free_in<1>(mask, place, refused);
    case 2:
      return first_free_in<2>(mask, place, refused);
    case 3:
      return first_free_in<3>(mask, place, refused);
    default:
      return first_free_in<kWordsAtOnce>(mask, place, refused);
  }
}

/// Updates the bitmaps of longer runs after cells [begin, end) of a row have changed.
void Occupancy::spread(int y, int begin, int end) {
  const auto last = static_cast<std::size_t>((end - 1) / kWordBits);
  for (int level = 1; level < levels_; ++level) {
    const Word* below = row(level - 1, y);
    Word* own = row(level, y);
    const int shift = 1 << (level - 1);
    const auto word = static_cast<std::size_t>(shift / kWordBits);
    const int bit = shift % kWordBits;
    const auto first = static_cast<std::size_t>(std::max(0, begin - 2 * shift) / kWordBits);
    for (std::size_t i = first; i <= last; ++i) {
      own[i] = below[i];
      if (i + word < words_) own[i] |= below[i + word] >> bit;
      if (bit > 0 && i + word + 1 < words_) own[i] |= below[i + word + 1] << (kWordBits - bit);
    }
    work_ += static_cast<std::int64_t>(last + 1 - first);
  }
}

void Occupancy::stamp(const Mask& mask, int x, int y) {
  for (int j = 0; j < mask.touched.height(); ++j) {
    Word* cells = row(0, y + margin_ + j);
    const std::span<const Run> runs = mask.touched.row(j);
    for (const Run& run : runs)
      for (int c = x + margin_ + run.begin; c < x + margin_ + run.end; ++c)
        cells[c / kWordBits] |= Word{1} << (c % kWordBits);
    if (!runs.empty())
      spread(y + margin_ + j, x + margin_ + runs.front().begin, x + margin_ + runs.back().end);
  }
}

}  // namespace unwrapd::pack
