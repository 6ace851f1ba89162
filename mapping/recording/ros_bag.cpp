#include "mapping/recording/ros_bag.h"

#include <dlfcn.h>

#include <fstream>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

constexpr const char* kMagic = "#ROSBAG V";
constexpr const char* kModule = "loci_rosbag.so";  ///< found through the program's RUNPATH

using OpenBag = BagReader* (*)(const std::filesystem::path& path);

OpenBag load_module() {
  void* module = dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
  void* symbol = module != nullptr ? dlsym(module, "loci_open_bag") : nullptr;
  if (symbol == nullptr)
    throw Error(std::string("ROS bags cannot be read: ") + dlerror(), {},
                "install loci_rosbag.so and librosbag-storage");
  return reinterpret_cast<OpenBag>(symbol);
}

}  // namespace

bool is_ros_bag(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(9, '\0');
  return file.read(head.data(), 9) && head == kMagic;
}

RosBag::RosBag(const std::filesystem::path& path) : path_(path) {
  if (!is_ros_bag(path))
    throw Error("this file is not a ROS 1 bag", {path.string(), 0, {}}, "a bag begins with '#ROSBAG V2.0'");
  static const OpenBag open_bag = load_module();
  reader_.reset(open_bag(path));
}

const BagTopic* RosBag::find(const std::string& topic) const {
  for (const BagTopic& each : topics())
    if (each.name == topic) return &each;
  return nullptr;
}

}  // namespace loci::mapping
