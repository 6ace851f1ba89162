// Files that are known and not read, with the command that converts them.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/formats/layouts.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

struct ForeignFormat {
  const char* what;
  std::string_view magic;            ///< how the file begins; empty = known by its ending alone
  std::vector<std::string> endings;  ///< lower case; empty = any
  const char* hint;                  ///< {0} is the file
};

/// The first that fits is meant.
const std::vector<ForeignFormat>& foreign_formats() {
  static const std::vector<ForeignFormat> all = {
      {"a recording of an Azure Kinect (Matroska) is not read as it is",
       "\x1a\x45\xdf\xa3",
       {},
       "convert it with Open3D: python azure_kinect_mkv_reader.py --input {0} --output FOLDER"},
      {"a recording of Record3D is not read as it is",
       "PK",
       {".r3d"},
       "export it from the app as 'EXR + RGB' and convert it with nerfstudio: ns-process-data record3d "
       "--data "
       "FOLDER --output-dir OUT"},
      {"a recording of a ZED camera is not read as it is",
       "",
       {".svo", ".svo2"},
       "export depth with the ZED SDK: python svo_export.py --mode 4 --input_svo_file {0} --output_path_dir "
       "FOLDER, and list the images in a frames.csv beside a recording.yaml; or record its ROS 2 topics"},
      {"a recording of OpenNI is not read as it is",
       "NI10",
       {},
       "convert it to clouds (package pcl-tools): pcl_oni2pcd {0}"},
      {"a log of Kintinuous or ElasticFusion is not read as it is",
       "",
       {".klg"},
       "write its frames as images with depth.txt and rgb.txt, as TUM RGB-D has them"},
      {"a recording of Kinect Studio is not read as it is",
       "",
       {".xef"},
       "export its depth and colour images (KinectXEFTools), and list them in a frames.csv beside a "
       "recording.yaml"},
      {"a database of RTAB-Map is not read as it is",
       "SQLite format 3",
       {".db"},
       "export it: rtabmap-export --images --poses_camera --poses_format 10 --output_dir FOLDER {0}, name "
       "the "
       "folders of images rgb and depth, and give the poses with --poses"},
      {"a cloud in PLY is not read as a recording",
       "ply",
       {},
       "convert it (package pcl-tools): pcl_ply2pcd {0} OUT.pcd; as a recording it has to be organised, "
       "loci-map interpret takes any"},
      {"a video alone has no depth",
       "",
       {".mp4", ".mov", ".avi", ".webm", ".h264", ".hevc"},
       "give the folder that its depth images are in"},
      {"a mesh or laser scan is not a recording",
       "",
       {".obj", ".glb", ".gltf", ".usdz", ".stl", ".dae", ".las", ".laz", ".e57", ".pts", ".xyz"},
       "a recording has depth images; loci-map interpret takes scans as PCD"},
      {"arrays of many images are not read",
       "",
       {".npz", ".h5", ".hdf5", ".mat", ".pkl"},
       "write each depth image with numpy.save(\"NAME.npy\", depth), and list them in a frames.csv beside a "
       "recording.yaml"},
      {"this file is compressed as a whole, which is not read",
       "\x28\xb5\x2f\xfd",
       {},
       "unpack it: zstd -d {0}"},
      {"this file is compressed", "\x1f\x8b", {".tgz"}, "unpack it: tar xzf {0}"},
      {"this file is compressed", "\x1f\x8b", {}, "unpack it: gunzip -k {0}, or tar xzf {0}"},
      {"this file is compressed", "BZh", {}, "unpack it: bunzip2 -k {0}, or tar xjf {0}"},
      {"this file is compressed",
       std::string_view("\xfd"
                        "7zXZ"),
       {},
       "unpack it: unxz -k {0}, or tar xJf {0}"},
      {"this file is compressed", "\x04\x22\x4d\x18", {}, "unpack it: lz4 -d {0}"},
      {"this is an archive", "PK", {}, "unpack it: unzip {0} -d FOLDER"},
      {"this is an archive", "7z\xbc\xaf", {}, "unpack it: 7z x {0}"},
      {"this is an archive", "Rar!", {}, "unpack it: unrar x {0}"},
      {"this is an archive", "", {".tar"}, "unpack it: tar xf {0}"}};
  return all;
}

}  // namespace

void refuse_foreign_format(const fs::path& file) {
  require_regular_file(file);
  std::ifstream stream(file, std::ios::binary);
  std::string head(16, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  const std::string ending = lower_case(file.extension().string());
  for (const ForeignFormat& format : foreign_formats())
    if (head.starts_with(format.magic) &&
        (format.endings.empty() || std::ranges::find(format.endings, ending) != format.endings.end()))
      throw Error(format.what, {file.string(), 0, {}}, fmt::format(fmt::runtime(format.hint), file.string()));
}

}  // namespace loci::mapping
