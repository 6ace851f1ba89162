// Writes typed C++ proxies, or a page of documentation, from type systems in UIMA's XML. Run by the build.

#include <cstdio>

#include "mapping/base/error.h"
#include "perception/types/generator/docs.h"
#include "perception/types/generator/proxies.h"

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try {
    if (arguments.size() >= 5 && arguments[0] == "proxies") {
      const bool paths = arguments[4] == "--path" && arguments.size() >= 7;
      std::vector<std::filesystem::path> path_dirs;
      if (paths) path_dirs.emplace_back(arguments[5]);
      loci::perception::generator::write_proxies({arguments[1], arguments[2], arguments[3]},
                                                 {arguments.begin() + (paths ? 6 : 4), arguments.end()},
                                                 path_dirs);
      return 0;
    }
    if (arguments.size() >= 3 && arguments[0] == "docs") {
      loci::perception::generator::write_docs(arguments[1], {arguments.begin() + 2, arguments.end()});
      return 0;
    }
  } catch (const loci::Error& error) {
    std::fprintf(stderr, "loci_generate_types: %s\n", error.what());
    return 1;
  }
  std::fprintf(
      stderr,
      "usage: loci_generate_types proxies NAMESPACE INCLUDE_FOLDER OUTPUT_FOLDER [--path DIR] FILE.xml...\n"
      "       loci_generate_types docs OUTPUT.md FILE.xml...\n");
  return 2;
}
