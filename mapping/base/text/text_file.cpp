#include "mapping/base/text/text_file.h"

#include "mapping/base/files.h"

namespace loci {

std::string read_text(const std::filesystem::path& path) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::string text = read_file(path);
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

}  // namespace loci
