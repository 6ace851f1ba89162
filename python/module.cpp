#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <regex>
#include <set>
#include <string>
#include <utility>

#include "mapping/base/error.h"
#include "python/bindings.h"

namespace loci::python {

py::dtype dtype_of(int depth) {
  switch (depth) {
    case CV_8U:
      return py::dtype::of<uint8_t>();
    case CV_8S:
      return py::dtype::of<int8_t>();
    case CV_16U:
      return py::dtype::of<uint16_t>();
    case CV_16S:
      return py::dtype::of<int16_t>();
    case CV_32S:
      return py::dtype::of<int32_t>();
    case CV_32F:
      return py::dtype::of<float>();
    case CV_64F:
      return py::dtype::of<double>();
    default:
      throw Error("an image with numbers of this type has no array");
  }
}

std::optional<py::array> array_of(const cv::Mat& image) {
  if (image.empty()) return std::nullopt;
  auto* owner = new cv::Mat(image);
  const py::capsule keep(owner, [](void* mat) { delete static_cast<cv::Mat*>(mat); });
  std::vector<py::ssize_t> shape = {image.rows, image.cols};
  std::vector<py::ssize_t> strides = {static_cast<py::ssize_t>(image.step[0]),
                                      static_cast<py::ssize_t>(image.step[1])};
  if (image.channels() > 1) {
    shape.push_back(image.channels());
    strides.push_back(static_cast<py::ssize_t>(image.elemSize1()));
  }
  return py::array(dtype_of(image.depth()), shape, strides, image.data, keep);
}

std::optional<py::array> rgb_array_of(const cv::Mat& bgr) {
  if (bgr.empty()) return std::nullopt;
  cv::Mat rgb;
  if (bgr.channels() == 1)
    cv::cvtColor(bgr, rgb, cv::COLOR_GRAY2RGB);
  else
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return array_of(rgb);
}

cv::Mat image_of(const py::array& array, int type, const char* what) {
  const int channels = CV_MAT_CN(type);
  const bool fits = channels == 1 ? array.ndim() == 2 : array.ndim() == 3 && array.shape(2) == channels;
  if (!fits || !dtype_of(CV_MAT_DEPTH(type)).equal(array.dtype()))
    throw Error(std::string(what) + " is not an array of rows x columns" +
                (channels == 1 ? "" : " x " + std::to_string(channels)) + " of " +
                py::str(dtype_of(CV_MAT_DEPTH(type))).cast<std::string>());
  const py::array dense = py::array::ensure(array, py::array::c_style);
  return cv::Mat(static_cast<int>(dense.shape(0)), static_cast<int>(dense.shape(1)), type,
                 const_cast<void*>(dense.data()))
      .clone();
}

cv::Mat bgr_of(const py::array& array) {
  cv::Mat bgr;
  cv::cvtColor(image_of(array, CV_8UC3, "a colour image"), bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

py::array array_of(const Vector3d& vector) {
  return py::array_t<double>(3, vector.data());
}

py::array array_of(const Isometry3d& pose) {
  py::array_t<double> matrix({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix.mutable_at(row, column) = pose.matrix()(row, column);
  return matrix;
}

py::array array_of(const std::vector<Eigen::Vector3f>& points) {
  py::array_t<float> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  if (!points.empty()) std::copy_n(points[0].data(), 3 * points.size(), array.mutable_data());
  return array;
}

Isometry3d pose_of(const py::array_t<double>& matrix) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw Error("a pose is a matrix of 4 x 4");
  Eigen::Matrix4d values;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) values(row, column) = matrix.at(row, column);
  return pose_from_matrix(values);
}

DateTime datetime_of(TimeNs time) {
  const py::module_ datetime = py::module_::import("datetime");
  const py::object utc = datetime.attr("timezone").attr("utc");
  const int64_t microseconds = time / 1000 - (time % 1000 < 0 ? 1 : 0);
  const py::object epoch = datetime.attr("datetime")(1970, 1, 1, py::arg("tzinfo") = utc);
  return DateTime(epoch + datetime.attr("timedelta")(py::arg("microseconds") = microseconds));
}

TimeNs time_of(const TimeArgument& time) {
  if (py::isinstance<py::str>(time)) return parse_time(time.cast<std::string>());
  if (py::isinstance<py::int_>(time)) return time.cast<TimeNs>();
  const py::module_ datetime = py::module_::import("datetime");
  if (!py::isinstance(time, datetime.attr("datetime")))
    throw Error("a time is a datetime, ISO 8601 text, or nanoseconds since 1970");
  if (time.attr("tzinfo").is_none())
    throw Error("a time needs a zone", {}, "datetime(..., tzinfo=timezone.utc)");
  const py::object utc = datetime.attr("timezone").attr("utc");
  const py::object since = time - datetime.attr("datetime")(1970, 1, 1, py::arg("tzinfo") = utc);
  const py::object microsecond = datetime.attr("timedelta")(py::arg("microseconds") = 1);
  return 1000 * since.attr("__floordiv__")(microsecond).cast<TimeNs>();
}

std::optional<TimeNs> time_or_none(const TimeArgument& time) {
  return time.is_none() ? std::nullopt : std::optional(time_of(time));
}

bool PythonProgress::update(double fraction, std::string_view text) {
  const py::gil_scoped_acquire acquired;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (callable_.is_none()) return true;
    const py::object go_on = callable_(fraction, std::string(text));
    return go_on.is_none() || go_on.cast<bool>();
  } catch (py::error_already_set& error) {
    failure_ = error;
    return false;
  }
}

void PythonProgress::rethrow() {
  if (failure_) throw *failure_;
  throw Error("stopped: progress returned False");
}

void raise_warnings(const Warnings& warnings) {
  constexpr int kCallerOfPackage = 3;  // above loci.run and what shortens its errors
  for (const std::string& text : warnings.texts())
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), kCallerOfPackage) != 0) throw py::error_already_set();
}

namespace {

/// A message as users of Python need it: options of the command line are keywords here, except in the command
/// lines that it names.
std::string in_python(const std::string& message) {
  static const std::regex option("--([a-z][a-z-]*)");
  static const std::set<std::string> flags = {"fixed-camera", "force", "keep-people", "resume", "strict"};
  std::string text;
  auto rest = message.begin();
  for (std::sregex_iterator it(message.begin(), message.end(), option), end; it != end; ++it) {
    const std::smatch& match = *it;
    text.append(rest, match[0].first);
    rest = match[0].second;
    const size_t clause = text.find_last_of(";:(,");
    const bool in_command = text.find("loci-", clause == std::string::npos ? 0 : clause) != std::string::npos;
    std::string keyword = match[1].str();
    const std::string value = flags.contains(keyword) ? "=True" : "=...";
    std::ranges::replace(keyword, '-', '_');
    text += in_command ? match[0].str() : keyword + value;
  }
  return text.append(rest, message.end());
}

}  // namespace
}  // namespace loci::python

PYBIND11_MODULE(_loci, module) {
  using namespace loci::python;
  module.attr("__version__") = LOCI_VERSION;
  module.doc() = "What the package loci is made of; use that.";
  static py::exception<loci::Error> error(module, "Error");
  error.doc() = "What happened, where, and what to do about it, in one line.";
  py::register_exception_translator([](std::exception_ptr exception) {
    try {
      if (exception) std::rethrow_exception(std::move(exception));
    } catch (const loci::Error& failure) {
      error(in_python(failure.what()).c_str());
    }
  });
  add_memory(module);
  add_mapping(module);
  add_perception(module);
}
