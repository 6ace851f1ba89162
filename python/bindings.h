#pragma once

// What the parts of the Python module share. Python sees images as arrays of numpy: colour as RGB, depth in
// metres with NaN where nothing was measured; poses as 4 x 4 matrices; times as datetime in UTC.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/base/config.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/time.h"

namespace loci::python {

namespace py = pybind11;

/// Runs without Python's global lock: other threads of Python go on. Nothing of Python may be touched.
template <class Function>
auto unlocked(Function&& function) {
  const py::gil_scoped_release released;
  return function();
}

/// How numpy calls the numbers of an image (CV_8U, CV_32F, …).
py::dtype dtype_of(int depth);
/// An array on the memory of an image, which it keeps alive; unset for an empty image. At most four channels.
std::optional<py::array> array_of(const cv::Mat& image);
/// The same for a colour image, BGR inside and RGB outside.
std::optional<py::array> rgb_array_of(const cv::Mat& bgr);
/// A copy of an array of rows x columns (x channels). Error when it is of another shape or type than `type`.
cv::Mat image_of(const py::array& array, int type, const char* what);
cv::Mat bgr_of(const py::array& array);

py::array array_of(const Vector3d& vector);
py::array array_of(const Isometry3d& pose);
/// N x 3, float.
py::array array_of(const std::vector<Eigen::Vector3f>& points);
/// Error when it is not a pose.
Isometry3d pose_of(const py::array_t<double>& matrix);
template <class T>
std::optional<py::array> array_or_none(const std::optional<T>& value) {
  return value ? std::optional(array_of(*value)) : std::nullopt;
}

inline bool is_anything(PyObject*) {
  return true;
}
/// Objects whose types the signatures in docstrings and stubs name.
class DateTime : public py::object {
  PYBIND11_OBJECT_DEFAULT(DateTime, object, is_anything)
};
class TimeArgument : public py::object {
  PYBIND11_OBJECT_DEFAULT(TimeArgument, object, is_anything)
};
class ProgressCallable : public py::object {
  PYBIND11_OBJECT_DEFAULT(ProgressCallable, object, is_anything)
};

class FrameIterator : public py::object {
  PYBIND11_OBJECT_DEFAULT(FrameIterator, object, is_anything)
};
class SceneIterator : public py::object {
  PYBIND11_OBJECT_DEFAULT(SceneIterator, object, is_anything)
};

/// In UTC, microseconds rounded down.
DateTime datetime_of(TimeNs time);
/// Of a datetime with zone, ISO 8601 text or nanoseconds. Error otherwise.
TimeNs time_of(const TimeArgument& time);
std::optional<TimeNs> time_or_none(const TimeArgument& time);

/// Asks a callable `progress(fraction, text)`, if there is one, and stops at Ctrl-C, or when it returns
/// False.
class PythonProgress : public Progress {
 public:
  explicit PythonProgress(ProgressCallable callable) : callable_(std::move(callable)) {}
  bool update(double fraction, std::string_view text) override;
  /// After Interrupted: the exception that stopped it, or Error where the callable returned False.
  [[noreturn]] void rethrow();

 private:
  ProgressCallable callable_;
  std::optional<py::error_already_set> failure_;
};

/// Runs a stage unlocked; Interrupted becomes the exception of Python that caused it, or an Error.
template <class Stage>
auto run_stage(const ProgressCallable& callable, Stage&& stage) {
  PythonProgress progress(callable);
  try {
    return unlocked([&] { return stage(static_cast<Progress&>(progress)); });
  } catch (const Interrupted&) {
    progress.rethrow();
  }
}

/// Warnings of loci become warnings of Python.
void raise_warnings(const Warnings& warnings);

/// Sets options of a stage by keyword arguments, as strictly as from YAML; `what` is for messages.
template <class Options>
void read_keywords(Options& options, const py::kwargs& keywords, const char* what) {
  const auto json = py::module_::import("loci._json").attr("dumps")(keywords, what).cast<std::string>();
  table_of(options).read_all(Config::parse(json, what));
}

void add_memory(py::module_& module);
void add_mapping(py::module_& module);
void add_perception(py::module_& module);

}  // namespace loci::python

template <>
struct pybind11::detail::handle_type_name<loci::python::DateTime> {
  static constexpr auto name = const_name("datetime.datetime");
};
template <>
struct pybind11::detail::handle_type_name<loci::python::TimeArgument> {
  static constexpr auto name = const_name("Union[datetime.datetime, str, int, None]");
};
template <>
struct pybind11::detail::handle_type_name<loci::python::ProgressCallable> {
  static constexpr auto name = const_name("Optional[Callable[[float, str], Optional[bool]]]");
};
template <>
struct pybind11::detail::handle_type_name<loci::python::SceneIterator> {
  static constexpr auto name = const_name("Iterator[Scene]");
};
template <>
struct pybind11::detail::handle_type_name<loci::python::FrameIterator> {
  static constexpr auto name = const_name("Iterator[Frame]");
};
