#include "mapping/base/temporary_folder.h"

#include <cstdlib>
#include <system_error>

#include "mapping/base/error.h"
#include "mapping/base/files.h"

namespace loci {

TemporaryFolder::TemporaryFolder(const std::string& name, const std::filesystem::path& parent) {
  make_folder(parent);
  std::string path = (parent / (name + "-XXXXXX")).string();
  if (::mkdtemp(path.data()) == nullptr)
    throw Error("no folder can be made in it", {parent.string(), 0, {}}, "it has to be writable");
  path_ = path;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace loci
