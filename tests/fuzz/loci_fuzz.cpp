// libFuzzer over all targets: loci_fuzz --target=urdf CORPUS tests/data/fuzz/urdf -max_total_time=60
// Of the preset "fuzz" alone: `.ci/nightly fuzz` runs it.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "mapping/base/error.h"
#include "tests/fuzz/targets.h"

namespace {

const loci::fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--target=";
  for (int i = 1; i < *argc; ++i)
    if (const std::string_view word = (*argv)[i]; word.starts_with(kOption))
      chosen = loci::fuzz::find_target(word.substr(kOption.size()));
  if (chosen != nullptr) return 0;
  std::fputs("give one of these:", stderr);
  for (const loci::fuzz::Target& target : loci::fuzz::targets())
    std::fprintf(stderr, " --target=%s", target.name);
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    chosen->run({reinterpret_cast<const char*>(data), size});
  } catch (const loci::Error&) {  // Refused, as it should be.
  }
  return 0;
}
