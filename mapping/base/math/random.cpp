#include "mapping/base/math/random.h"

#include <bit>
#include <cmath>

namespace loci {
namespace {

uint64_t splitmix(uint64_t& state) {
  uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

Random::Random(uint64_t seed) : state_{} {
  for (uint64_t& word : state_) word = splitmix(seed);
}

Random Random::fork(uint64_t stream) const {
  uint64_t mixed = state_[0] ^ std::rotl(state_[2], 17) ^ (stream + 1) * 0xd1342543de82ef95ULL;
  return Random(splitmix(mixed));
}

uint64_t Random::bits() {
  const uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
  const uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

uint64_t Random::index(uint64_t count) {
  const uint64_t limit =
      UINT64_MAX - UINT64_MAX % count;  // Reject the uneven rest, so that all are equally likely.
  uint64_t value = bits();
  while (value >= limit) value = bits();
  return value % count;
}

double Random::normal(double sigma) {
  if (has_spare_) {
    has_spare_ = false;
    return sigma * spare_;
  }
  double u = 0, v = 0, square = 0;
  do {
    u = uniform(-1, 1);
    v = uniform(-1, 1);
    square = u * u + v * v;
  } while (square >= 1 || square == 0);
  const double scale = std::sqrt(-2 * std::log(square) / square);
  spare_ = v * scale;
  has_spare_ = true;
  return sigma * u * scale;
}

}  // namespace loci
