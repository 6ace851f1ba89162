# Outside libraries, found once. Versions are those of Debian 12.

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc features2d calib3d dnn ml objdetect videoio)
find_package(TBB REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(TIFF 4.5 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(BZip2 REQUIRED)
find_package(urdfdom REQUIRED)
find_package(assimp REQUIRED)
find_package(SQLiteCpp REQUIRED)
find_package(embree 3 REQUIRED)
find_package(octomap REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(Protobuf REQUIRED)
find_package(PostgreSQL REQUIRED)
find_package(ZXing 1.4 REQUIRED)
find_package(date REQUIRED)
find_package(Boost 1.74 REQUIRED)

find_package(PkgConfig REQUIRED)
pkg_check_modules(tinyxml2 REQUIRED IMPORTED_TARGET tinyxml2)
pkg_check_modules(gumbo REQUIRED IMPORTED_TARGET gumbo)
pkg_check_modules(zbar REQUIRED IMPORTED_TARGET zbar)
pkg_check_modules(tesseract REQUIRED IMPORTED_TARGET tesseract)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(openexr REQUIRED IMPORTED_TARGET OpenEXR>=3.1)
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(httplib REQUIRED IMPORTED_TARGET cpp-httplib)

# Tests write ROS 1 bags with it. The library's own CMake and pkg-config files ask for all of catkin; these libraries are what it takes.
add_library(rosbag_storage INTERFACE)
foreach(library rosbag_storage roscpp_serialization rostime cpp_common console_bridge)
  find_library(LOCI_LIB_${library} ${library} REQUIRED)
  target_link_libraries(rosbag_storage INTERFACE ${LOCI_LIB_${library}})
endforeach()
foreach(header rosbag/bag.h pluginlib/class_loader.hpp class_loader/class_loader.hpp
    rcpputils/shared_library.hpp rcutils/shared_library.h ament_index_cpp/get_package_prefix.hpp console_bridge/console.h)
  get_filename_component(package ${header} DIRECTORY)
  find_path(LOCI_INCLUDE_${package} ${header} PATH_SUFFIXES ${package} REQUIRED)
  target_include_directories(rosbag_storage SYSTEM INTERFACE ${LOCI_INCLUDE_${package}})
endforeach()

# PCL's io and 2d components would bring 38 VTK libraries and Qt into programs that draw nothing.
foreach(package VTK OpenNI OpenNI2 libusb Pcap)
  set(CMAKE_DISABLE_FIND_PACKAGE_${package} ON)
endforeach()
find_package(PCL 1.13 QUIET REQUIRED COMPONENTS common kdtree search features filters keypoints segmentation sample_consensus registration)
set(CMAKE_DISABLE_FIND_PACKAGE_VTK OFF)

if(LOCI_GUI)
  enable_language(C)  # VTK's targets refer to MPI, which is looked for with C
  find_package(Qt5 5.15 REQUIRED COMPONENTS Widgets Test)
  find_package(VTK 9.1 REQUIRED COMPONENTS
    CommonCore CommonDataModel CommonExecutionModel FiltersSources FiltersGeneral InteractionStyle
    InteractionWidgets RenderingCore RenderingOpenGL2 RenderingFreeType RenderingAnnotation IOImage GUISupportQt)
endif()

if(LOCI_TESTS)
  find_package(GTest REQUIRED)
  # Whether maps run elsewhere: Gazebo's reader and two physics engines.
  find_package(sdformat12 REQUIRED)
  pkg_check_modules(bullet REQUIRED IMPORTED_TARGET bullet)
  find_package(mujoco REQUIRED)
  include(GoogleTest)
endif()
