#pragma once

#include <cstdint>
#include <list>
#include <string>
#include <utility>

namespace loci::mapping {

/// The chunks of a bag that were used last, unpacked, by their position in the file.
class ChunkCache {
 public:
  /// The chunk at a position, as `unpack()` returns it when it is not kept. Valid until the next call.
  template <typename Unpack>
  const std::string& at(uint64_t position, const Unpack& unpack) {
    for (auto each = chunks_.begin(); each != chunks_.end(); ++each)
      if (each->first == position) {
        chunks_.splice(chunks_.begin(), chunks_, each);
        return chunks_.front().second;
      }
    chunks_.emplace_front(position, unpack());
    if (chunks_.size() > kKept) chunks_.pop_back();
    return chunks_.front().second;
  }

 private:
  static constexpr size_t kKept = 4;
  std::list<std::pair<uint64_t, std::string>> chunks_;  ///< last used first
};

}  // namespace loci::mapping
